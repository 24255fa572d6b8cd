#include "hemi/core/row_memory.hpp"

#include "core/parallel_for.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

using namespace hemi;

TEST_CASE("row memory: arrays lie in a file once a folder is named, those of before stay", "[core]") {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("hemi-row-memory-" + std::to_string(getpid()));
    CHECK_THROWS_AS(keep_rows_in(folder / "missing"), InputError);
    CHECK_FALSE(rows_are_in_file());
    RowArray<std::uint32_t> before(1000, 7);

    std::filesystem::create_directory(folder);
    keep_rows_in(folder);
    REQUIRE(rows_are_in_file());
    CHECK(std::filesystem::is_empty(folder)); // the file has no name
    std::vector<RowArray<std::uint32_t>> arrays;
    for (std::uint32_t k = 0; k < 300; ++k) {
        RowArray<std::uint32_t>& array = arrays.emplace_back(k * k);
        std::iota(array.begin(), array.end(), k);
    }
    for (std::uint32_t k = 0; k < 300; k += 2) { // rooms of other sizes become free and are used again
        RowArray<std::uint32_t> larger(std::size_t{2} * k * k);
        std::iota(larger.begin(), larger.end(), k);
        arrays[k] = std::move(larger);
    }
    bool all = true;
    for (std::uint32_t k = 0; k < 300; ++k) {
        for (std::size_t at = 0; at < arrays[k].size(); ++at) {
            all = all && arrays[k][at] == k + at;
        }
    }
    CHECK(all);

    // A process may have some ten thousand mappings: those of many arrays, made by threads that end, are one.
    const auto mappings = [&] {
        std::ifstream maps("/proc/self/maps");
        std::size_t count = 0;
        for (std::string line; std::getline(maps, line);) {
            count += line.find(folder.string()) != std::string::npos ? 1 : 0;
        }
        return count;
    };
    CHECK(mappings() >= 1);
    std::vector<RowArray<std::uint32_t>> rows(10'000);
    std::vector<std::uint8_t> right(rows.size(), 0);
    const auto for_rows = [&](const auto& change) {
        for (std::size_t first = 0; first < rows.size(); first += 1000) {
            parallel_for(1000, 100, [&](std::size_t begin, std::size_t end) {
                for (std::size_t k = first + begin; k < first + end; ++k) {
                    change(k);
                }
            });
        }
    };
    for_rows([&](std::size_t k) { rows[k].assign(1200 + k % 100, static_cast<std::uint32_t>(k)); });
    for_rows([&](std::size_t k) { // what is given back becomes room for others
        if (k % 2 == 0) {
            rows[k] = RowArray<std::uint32_t>(700 + k % 300, static_cast<std::uint32_t>(k));
        }
    });
    for_rows([&](std::size_t k) {
        right[k] =
            rows[k].size() == (k % 2 == 0 ? 700 + k % 300 : 1200 + k % 100) &&
            std::all_of(rows[k].begin(), rows[k].end(), [k](std::uint32_t value) { return value == k; });
    });
    CHECK(std::count(right.begin(), right.end(), 1) == 10'000);
    CHECK(mappings() < 10);

    const RowArray<std::uint32_t> copy = before;
    CHECK(copy.get_allocator().memory() != before.get_allocator().memory());
    before = std::move(arrays[200]);
    CHECK(before.size() == 80000);
    std::filesystem::remove(folder);
}
