#include "matrix/pairs.hpp"

#include "support/dice.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <map>
#include <utility>

using namespace hemi;

TEST_CASE("visit_pairs: in sparse rows every pair comes once, with the entries of both directions",
          "[matrix]") {
    constexpr std::uint32_t size = 1500;
    test::Dice dice(1);
    const auto step = [&dice] { return static_cast<std::uint32_t>(dice.pick(700)); };
    FormFactorMatrix matrix(size);
    std::vector<RowBlock> blocks = matrix.take_blocks();
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<std::uint64_t, 2>> expected;
    const auto known = [](std::uint32_t i) { return i % 17 != 3; };
    for (RowBlock& block : blocks) {
        for (std::uint32_t local = 0; local < block.rows(); ++local) {
            const std::uint32_t i = block.first_row + local;
            block.known[local] = known(i) ? 1 : 0;
            // Many rows have few entries, and those are far from the diagonal.
            for (std::uint32_t j = step(); known(i) && j < size; j += 1 + step()) {
                if (j != i && known(j)) {
                    auto& entries =
                        expected
                            .try_emplace({std::min(i, j), std::max(i, j)}, std::array{not_stored, not_stored})
                            .first->second;
                    entries[i < j ? 0 : 1] = block.columns.size();
                }
                block.columns.push_back(j);
                block.values.push_back(0.1F);
            }
            block.begin[local + 1] = block.columns.size();
        }
    }
    for (const std::uint32_t middle : {0u, 640u}) { // rows in one slice, and in two
        auto left = expected;
        for (const auto& [first, last] : {std::pair(0u, middle), std::pair(middle, size)}) {
            visit_pairs(std::span<const RowBlock>(blocks), first, last,
                        [&](std::uint32_t i, std::uint64_t there, std::uint32_t j, std::uint64_t back) {
                            const auto found = left.find({i, j});
                            REQUIRE(found != left.end());
                            REQUIRE(found->second == std::array{there, back});
                            left.erase(found);
                        });
        }
        CHECK(left.empty());
    }
}
