#include "hemi/engine/reference_rows.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>

using namespace hemi;

TEST_CASE("reference_patches: spread over all patches, each once", "[engine]") {
    std::vector<std::uint32_t> patches(100);
    std::iota(patches.begin(), patches.end(), 5u);
    for (const std::uint32_t count : {0u, 1u, 7u, 99u, 100u, 1000u}) {
        const auto chosen = reference_patches(patches, count);
        CHECK(chosen.size() == std::min(count, 100u));
        CHECK(std::is_sorted(chosen.begin(), chosen.end()));
        CHECK(std::adjacent_find(chosen.begin(), chosen.end()) == chosen.end());
        CHECK((chosen.empty() || (chosen.front() >= 5 && chosen.back() < 105)));
    }
    CHECK(reference_patches(patches, 1000) == patches);
    const HemicubeSettings hemicubes;
    CHECK(reference_count(hemicubes, 5, 0.1) == 5);
    CHECK(reference_count(hemicubes, 100'000, 0.1) == 32);
    CHECK(reference_count(hemicubes, 100'000, 0.1, 128) == 128);
    CHECK(reference_count(hemicubes, 500, 0.1, 128) == reference_count(hemicubes, 500, 0.1));
}
