#include "hemi/matrix/packed_entries.hpp"

#include "hemi/core/error.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/matrix/source_clusters.hpp"
#include "matrix/matrix_fixtures.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

using namespace hemi;

namespace {

struct Entries {
    std::vector<std::uint32_t> columns;
    std::vector<float> values;
    std::vector<std::uint8_t> visibility;

    [[nodiscard]] PackedEntries packed() const { return {columns, values, visibility}; }
};

Entries unpacked(const PackedEntries& packed) {
    Entries entries{std::vector<std::uint32_t>(packed.size()), std::vector<float>(packed.size()),
                    std::vector<std::uint8_t>(packed.has_visibility() ? packed.size() : 0)};
    packed.unpack(entries.columns.data(), entries.values.data(), entries.visibility.data());
    return entries;
}

/// Steps of every number of bytes, factors of every size.
Entries random_entries(std::mt19937& random, bool with_visibility) {
    Entries entries;
    std::uint64_t column = random() % 3;
    while (column < 4'000'000'000u && entries.columns.size() < 2'000) {
        entries.columns.push_back(static_cast<std::uint32_t>(column));
        column += 1 + random() % (1u << random() % 28);
        entries.values.push_back(
            static_cast<float>(std::exp2(-0.04 * static_cast<double>(random() % 1'000))));
        if (with_visibility) {
            entries.visibility.push_back(static_cast<std::uint8_t>(random()));
        }
    }
    return entries;
}

/// Every node is a patch and all that follow it.
std::shared_ptr<const SourceClusters> clusters_of(std::uint32_t patches) {
    std::vector<std::uint32_t> order;
    std::vector<SourceClusters::Node> nodes{{0, patches, 1}};
    for (std::uint32_t patch = 0; patch < patches; ++patch) {
        order.push_back(patch);
        if (patch + 1 < patches) {
            const auto next = static_cast<std::uint32_t>(nodes.size()) + 2;
            nodes.push_back({patch, patch + 1, 0});
            nodes.push_back({patch + 1, patches, patch + 2 < patches ? next : 0});
        }
    }
    return std::make_shared<const SourceClusters>(order, nodes, std::vector<double>(patches, 1.0));
}

} // namespace

TEST_CASE("PackedEntries: columns and visibility are kept, factors within 2e-6 of themselves", "[matrix]") {
    std::mt19937 random(1);
    for (int round = 0; round < 20; ++round) {
        const Entries entries = random_entries(random, round % 2 == 0);
        const PackedEntries packed = entries.packed();
        const Entries read = unpacked(packed);
        REQUIRE(packed.size() == entries.columns.size());
        REQUIRE(packed.has_visibility() == (round % 2 == 0));
        CHECK(read.columns == entries.columns);
        CHECK(read.visibility == entries.visibility);
        double sum = 0.0;
        for (std::size_t k = 0; k < entries.values.size(); ++k) {
            REQUIRE(std::abs(read.values[k] / entries.values[k] - 1.0F) <= 2e-6F);
            sum += static_cast<double>(read.values[k]);
        }
        CHECK(packed.sum() == sum);
        std::size_t at = 0;
        packed.visit([&](std::uint32_t column, float value, std::uint8_t visibility) {
            REQUIRE(column == read.columns[at]);
            REQUIRE(value == read.values[at]);
            REQUIRE(visibility == (read.visibility.empty() ? 0 : read.visibility[at]));
            ++at;
        });
        CHECK(at == entries.columns.size());
    }
}

TEST_CASE("PackedEntries: what was packed is packed to the same again", "[matrix]") {
    std::mt19937 random(2);
    const Entries once = unpacked(random_entries(random, true).packed());
    const Entries twice = unpacked(once.packed());
    CHECK(twice.columns == once.columns);
    CHECK(twice.values == once.values);
    CHECK(twice.visibility == once.visibility);
}

TEST_CASE("PackedEntries: the largest and the smallest factors", "[matrix]") {
    const auto packed = [](float value) {
        const std::uint32_t column = 7;
        return unpacked(PackedEntries({&column, 1}, {&value, 1}, {})).values[0];
    };
    CHECK(packed(0.0F) == 0.0F);
    CHECK(packed(-0.0F) == 0.0F);
    CHECK(packed(1.0F) == 1.0F);
    CHECK(packed(std::nextafter(2.0F, 0.0F)) < 2.0F);
    CHECK(packed(std::nextafter(2.0F, 0.0F)) > 1.99999F);
    CHECK(packed(std::nextafter(1.0F, 0.0F)) == 1.0F);
    CHECK(packed(std::ldexp(1.0F, -63)) == std::ldexp(1.0F, -63));
    CHECK(packed(1e-20F) == 0.0F);
    CHECK(packed(1e-44F) == 0.0F);
    CHECK(PackedEntries().sum() == 0.0);
}

TEST_CASE("PackedEntries: factors are changed in their place", "[matrix]") {
    PackedEntries entries(std::vector<std::uint32_t>{3, 500}, std::vector<float>{0.5F, 0.125F},
                          std::vector<std::uint8_t>{255, 16});
    entries.change_values(
        [](float value, std::uint8_t visibility) { return visibility == 255 ? value : 2.0F * value; });
    const Entries read = unpacked(entries);
    CHECK(read.columns == std::vector<std::uint32_t>{3, 500});
    CHECK(read.values == std::vector<float>{0.5F, 0.25F});
    CHECK(read.visibility == std::vector<std::uint8_t>{255, 16});
}

TEST_CASE("FormFactorMatrix: entries of clusters take 5 bytes, and rows are whole", "[matrix]") {
    // Rows 64 to 127 see two patches and the cluster of all.
    constexpr std::uint32_t size = 200;
    const auto clusters = clusters_of(size);
    FormFactorMatrix matrix(size, clusters);
    std::vector<RowBlock> blocks = matrix.take_blocks();
    RowBlock block = blocks[1];
    for (std::uint32_t local = 0; local < block.rows(); ++local) {
        block.known[local] = 1;
        block.environment[local] = 0.25;
        block.columns.insert(block.columns.end(), {local, 100, size});
        block.values.insert(block.values.end(), {0.25F, 1.0F / 3.0F, 0.125F});
        block.visibility.insert(block.visibility.end(), {255, 0, 77});
        block.begin[local + 1] = block.columns.size();
    }
    const RowBlock given = block;
    matrix.set_block(std::move(block));
    CHECK(matrix.entries() == 3 * 64);
    CHECK(matrix.entries(1) == 3 * 64);
    CHECK(matrix.entries(0) == 0);
    CHECK(matrix.has_visibility());
    CHECK(matrix.blocks()[1].columns.size() == 2 * 64);
    const RowView row = matrix.row(64 + 9);
    const RowView copy = row; // lives on without the matrix's help
    CHECK(std::vector(copy.columns.begin(), copy.columns.end()) == std::vector<std::uint32_t>{9, 100, size});
    CHECK(std::vector(copy.values.begin(), copy.values.end()) ==
          std::vector<float>{0.25F, 1.0F / 3.0F, 0.125F}); // of patches to the last bit
    CHECK(std::vector(copy.visibility.begin(), copy.visibility.end()) ==
          std::vector<std::uint8_t>{255, 0, 77});
    CHECK(copy.environment == 0.25);
    CHECK(matrix.environment(64 + 9) == 0.25);
    CHECK(matrix.blocked(64 + 9) == 0.0);
    const RowBlock read = matrix.block(1);
    CHECK(read.first_row == 64);
    CHECK(read.begin == given.begin);
    CHECK(read.columns == given.columns);
    CHECK(read.values == given.values);
    CHECK(read.visibility == given.visibility);
    const std::vector<RowBlock> taken = matrix.take_blocks();
    CHECK(taken[1].columns == given.columns);
    CHECK(matrix.entries() == 0);
    CHECK(matrix.row(64 + 9).columns.empty());

    RowBlock wrong = given;
    wrong.values[2] = 2.0F;
    CHECK_THROWS_WITH(matrix.set_block(wrong),
                      Catch::Contains("row 64: 2 for a cluster; it must be below 2"));
}

TEST_CASE("FormFactorMatrix: packed entries of clusters are taken as they are, or refused", "[matrix]") {
    constexpr std::uint32_t size = 3;
    FormFactorMatrix matrix(size, clusters_of(size)); // columns 3 to 7 are clusters
    RowBlock near = matrix.take_blocks()[0];
    near.known = {1, 0, 1};
    near.begin = {0, 1, 1, 1};
    near.columns = {2};
    near.values = {0.25F};
    near.visibility = {255};
    const auto packed = [](std::vector<std::uint32_t> columns) {
        return PackedEntries(columns, std::vector<float>(columns.size(), 0.5F),
                             std::vector<std::uint8_t>(columns.size(), 9));
    };
    matrix.set_block(near, {packed({3, 7}), PackedEntries(), packed({4})});
    CHECK(matrix.entries() == 4);
    const RowView row = matrix.row(0);
    CHECK(std::vector(row.columns.begin(), row.columns.end()) == std::vector<std::uint32_t>{2, 3, 7});
    CHECK(std::vector(row.visibility.begin(), row.visibility.end()) == std::vector<std::uint8_t>{255, 9, 9});
    const RowView other = matrix.row(2);
    CHECK(std::vector(other.columns.begin(), other.columns.end()) == std::vector<std::uint32_t>{4});

    const auto refused = [&](std::vector<PackedEntries> clusters, const char* why) {
        CHECK_THROWS_WITH(matrix.set_block(near, std::move(clusters)), Catch::Contains(why));
    };
    refused({packed({3})}, "1 rows with and 3 without clusters; it must be as many");
    refused({packed({2}), PackedEntries(), PackedEntries()},
            "row 0: clusters must ascend from 3 and be below 8");
    refused({packed({8}), PackedEntries(), PackedEntries()},
            "row 0: clusters must ascend from 3 and be below 8");
    refused({packed({4, 4}), PackedEntries(), PackedEntries()},
            "row 0: clusters must ascend from 3 and be below 8");
    refused({PackedEntries(), packed({3}), PackedEntries()}, "row 1 is unknown and has 1 entries");
    CHECK_THROWS_WITH(FormFactorMatrix(size).set_block(near, {{}, {}, {}}), Catch::Contains("0 rows with"));
}
