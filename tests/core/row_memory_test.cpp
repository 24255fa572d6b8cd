#include "hemi/core/row_memory.hpp"

#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

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
    std::ifstream maps("/proc/self/maps");
    bool mapped = false;
    for (std::string line; std::getline(maps, line);) {
        mapped = mapped || line.find(folder.string()) != std::string::npos;
    }
    CHECK(mapped);

    const RowArray<std::uint32_t> copy = before;
    CHECK(copy.get_allocator().memory() != before.get_allocator().memory());
    before = std::move(arrays[200]);
    CHECK(before.size() == 80000);
    std::filesystem::remove(folder);
}
