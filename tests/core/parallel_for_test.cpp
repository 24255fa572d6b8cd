#include "core/parallel_for.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <stdexcept>
#include <vector>

using namespace hemi;

TEST_CASE("parallel_for: visits every index once", "[core]") {
    for (const std::size_t count : {0u, 1u, 7u, 1000u}) {
        std::vector<int> visits(count, 0);
        parallel_for(count, 3, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                ++visits[k];
            }
        });
        CHECK(std::all_of(visits.begin(), visits.end(), [](int n) { return n == 1; }));
    }
}

TEST_CASE("parallel_for: an exception of a body is passed on", "[core]") {
    CHECK_THROWS_AS(parallel_for(100, 1,
                                 [](std::size_t begin, std::size_t) {
                                     if (begin == 50) {
                                         throw std::runtime_error("fifty");
                                     }
                                 }),
                    std::runtime_error);
}
