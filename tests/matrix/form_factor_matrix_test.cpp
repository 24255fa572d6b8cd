#include "hemi/matrix/form_factor_matrix.hpp"

#include "hemi/core/error.hpp"
#include "matrix/matrix_fixtures.hpp"

#include <catch2/catch.hpp>

#include <limits>

using namespace hemi;
using namespace hemi::test;

namespace {

RowBlock good_block() {
    return dense_block({{0.0, 0.25, 0.75}, {0.5, 0.0, 0.5}, {0.0, 0.0, 0.0}}, 0);
}

} // namespace

TEST_CASE("FormFactorMatrix: all rows of a new matrix are unknown and empty", "[matrix]") {
    const FormFactorMatrix matrix(130);
    CHECK(matrix.size() == 130);
    CHECK(matrix.blocks().size() == 3);
    CHECK(matrix.blocks()[2].first_row == 128);
    CHECK(matrix.blocks()[2].rows() == 2);
    CHECK(matrix.entries() == 0);
    CHECK_FALSE(matrix.all_known());
    for (std::uint32_t i = 0; i < matrix.size(); ++i) {
        CHECK_FALSE(matrix.known(i));
        CHECK(matrix.row(i).columns.empty());
        CHECK(matrix.row(i).sum() == 0.0);
    }
}

TEST_CASE("FormFactorMatrix: a matrix without rows has no blocks and knows them all", "[matrix]") {
    const FormFactorMatrix matrix(0);
    CHECK(matrix.blocks().empty());
    CHECK(matrix.all_known());
    CHECK(matrix.entries() == 0);
}

TEST_CASE("FormFactorMatrix: rows come back as they were set", "[matrix]") {
    const DenseRows rows = random_rows(150, 0.9, 7);
    std::vector<double> environment(150);
    std::vector<double> blocked(150);
    for (std::size_t i = 0; i < 150; ++i) {
        environment[i] = 0.001 * static_cast<double>(i);
        blocked[i] = 0.1 - environment[i] / 2.0;
    }
    const FormFactorMatrix matrix = dense_matrix(rows, environment, blocked);
    CHECK(matrix.all_known());

    std::uint64_t entries = 0;
    for (std::uint32_t i = 0; i < 150; ++i) {
        const RowView row = matrix.row(i);
        CHECK(row.environment == environment[i]);
        CHECK(row.blocked == blocked[i]);
        CHECK(row.sum() == Approx(0.9).epsilon(1e-6));
        std::size_t k = 0;
        for (std::uint32_t j = 0; j < 150; ++j) {
            if (rows[i][j] != 0.0) {
                REQUIRE(k < row.columns.size());
                CHECK(row.columns[k] == j);
                CHECK(row.values[k] == static_cast<float>(rows[i][j]));
                ++k;
            }
        }
        CHECK(k == row.columns.size());
        entries += k;
    }
    CHECK(matrix.entries() == entries);
}

TEST_CASE("FormFactorMatrix: memory is 8 bytes an entry and about 25 a row", "[matrix]") {
    const FormFactorMatrix empty(64 * 100);
    CHECK(empty.memory_bytes() < 64 * 100 * 30);
    const FormFactorMatrix matrix = dense_matrix(random_rows(256, 1.0, 3));
    CHECK(matrix.memory_bytes() >= 8 * matrix.entries() + 25 * 256);
    CHECK(matrix.memory_bytes() < 16 * matrix.entries() + 40 * 256);
}

TEST_CASE("FormFactorMatrix: set_block refuses malformed blocks", "[matrix]") {
    FormFactorMatrix matrix(3);
    RowBlock block = good_block();

    SECTION("first row beyond the matrix") {
        block.first_row = 64;
    }
    SECTION("first row inside a block") {
        block.first_row = 1;
    }
    SECTION("too few rows") {
        block = dense_block({{0.0, 1.0}, {1.0, 0.0}}, 0);
    }
    SECTION("too few environment shares") {
        block.environment.pop_back();
    }
    SECTION("too few blocked shares") {
        block.blocked.pop_back();
    }
    SECTION("too few offsets") {
        block.begin.pop_back();
    }
    SECTION("no offsets") {
        block.begin.clear();
    }
    SECTION("offsets that do not begin at 0") {
        block.begin[0] = 1;
    }
    SECTION("offsets that descend") {
        block.begin[1] = 3, block.begin[2] = 2;
    }
    SECTION("offsets past the entries") {
        block.begin[1] = 99;
    }
    SECTION("offsets that end early") {
        block.begin[2] = block.begin[3] = 3;
    }
    SECTION("more columns than values") {
        block.columns.push_back(2);
    }
    SECTION("more values than columns") {
        block.values.push_back(0.5F);
    }
    SECTION("column out of range") {
        block.columns[1] = 3;
    }
    SECTION("columns that descend") {
        std::swap(block.columns[0], block.columns[1]);
    }
    SECTION("column twice") {
        block.columns[1] = block.columns[0];
    }
    SECTION("negative value") {
        block.values[0] = -0.1F;
    }
    SECTION("infinite value") {
        block.values[0] = std::numeric_limits<float>::infinity();
    }
    SECTION("value that is not a number") {
        block.values[0] = std::numeric_limits<float>::quiet_NaN();
    }
    SECTION("negative environment share") {
        block.environment[0] = -0.1;
    }
    SECTION("blocked share that is not a number") {
        block.blocked[0] = std::numeric_limits<double>::quiet_NaN();
    }
    SECTION("unknown row with entries") {
        block.known[0] = 0;
    }

    CHECK_THROWS_AS(matrix.set_block(block), InvalidArgument);
    CHECK(matrix.entries() == 0);
    CHECK_NOTHROW(matrix.set_block(good_block()));
}

TEST_CASE("FormFactorMatrix: set_block says which row and value it refuses", "[matrix]") {
    FormFactorMatrix matrix(3);
    RowBlock block = good_block();
    block.values[2] = -0.5F;
    CHECK_THROWS_WITH(matrix.set_block(block), Catch::Contains("F(1, 0) = -0.5"));
}

TEST_CASE("FormFactorMatrix: columns may begin anew in the next row", "[matrix]") {
    FormFactorMatrix matrix(2);
    CHECK_NOTHROW(matrix.set_block(dense_block({{0.0, 1.0}, {1.0, 0.0}}, 0)));
    CHECK(matrix.row(0).columns[0] == 1);
    CHECK(matrix.row(1).columns[0] == 0);
}
