#include "hemi/matrix/balance.hpp"

#include "hemi/core/error.hpp"
#include "matrix/matrix_fixtures.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hemi;
using namespace hemi::test;

TEST_CASE("row_sums: tells minimum, maximum, mean and the balance apart", "[matrix]") {
    // sums 0.75, 1, 0.25 and 0; environment 0.25, 0, 0, 0; blocked 0, 0, 0.25, 1; row 2 lacks 0.5
    const FormFactorMatrix matrix = dense_matrix(
        {{0.0, 0.5, 0.25, 0.0}, {0.5, 0.0, 0.0, 0.5}, {0.0, 0.25, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}},
        {0.25, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.25, 1.0});
    const RowSums sums = row_sums(matrix);
    CHECK(sums.min == 0.0);
    CHECK(sums.max == 1.0);
    CHECK(sums.mean == 0.5);
    CHECK(sums.environment_max == 0.25);
    CHECK(sums.blocked_max == 1.0);
    CHECK(sums.balance_error_max == 0.5);
    CHECK(sums.known == 4);
    CHECK(sums.leaking == 1);
    CHECK(sums.covered == 1);
    CHECK(sums.partly_blocked == 1);
}

TEST_CASE("row_sums: unknown rows do not count", "[matrix]") {
    const FormFactorMatrix matrix = forget_rows(dense_matrix({{0.5, 0.5}, {0.25, 0.25}}, {0.0, 0.5}), {1});
    const RowSums sums = row_sums(matrix);
    CHECK(sums.known == 1);
    CHECK(sums.min == 1.0);
    CHECK(sums.max == 1.0);
    CHECK(sums.mean == 1.0);
    CHECK(sums.leaking == 0);

    const RowSums none = row_sums(FormFactorMatrix(5));
    CHECK(none.known == 0);
    CHECK(none.min == 0.0);
    CHECK(none.max == 0.0);
    CHECK(none.mean == 0.0);
}

TEST_CASE("reciprocity: a symmetric exchange matrix is reciprocal to the rounding of floats", "[matrix]") {
    const ReciprocalScene scene = reciprocal_scene(200, 11);
    const Reciprocity result = reciprocity(dense_matrix(scene.rows), scene.areas);
    std::uint64_t pairs = 0;
    for (std::size_t i = 0; i < 200; ++i) {
        for (std::size_t j = i + 1; j < 200; ++j) {
            pairs += scene.rows[i][j] != 0.0 ? 1 : 0;
        }
    }
    CHECK(result.pairs == pairs);
    CHECK(result.rms < 1e-8);
    CHECK(result.max < 1e-8);
    CHECK(result.relative_rms < 6e-8);
    CHECK(result.relative_rms > 0.0);
}

TEST_CASE("reciprocity: finds the pair that differs most", "[matrix]") {
    ReciprocalScene scene = reciprocal_scene(100, 12);
    scene.areas.assign(100, 2.0);
    for (std::size_t i = 0; i < 100; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            scene.rows[i][j] = scene.rows[j][i];
        }
    }
    scene.rows[70][20] = 0.125;
    scene.rows[20][70] = 0.5;
    const Reciprocity result = reciprocity(dense_matrix(scene.rows), scene.areas);
    CHECK(result.max == 0.375);
    CHECK(std::min(result.worst_i, result.worst_j) == 20);
    CHECK(std::max(result.worst_i, result.worst_j) == 70);
    CHECK(result.rms == Approx(0.375 / std::sqrt(static_cast<double>(result.pairs))));
}

TEST_CASE("reciprocity: agrees with a plain sum over all pairs", "[matrix]") {
    const std::uint32_t size = 90;
    DenseRows rows = random_rows(size, 0.8, 5); // not reciprocal, many pairs stored one way only
    std::vector<double> areas;
    Random random(6);
    for (std::uint32_t i = 0; i < size; ++i) {
        areas.push_back(0.25 + random());
    }
    const std::vector<std::uint32_t> unknown{3, 17, 64, 89};
    const FormFactorMatrix matrix = forget_rows(dense_matrix(rows), unknown);
    const auto known = [&](std::uint32_t i) { return matrix.known(i); };

    double squares = 0.0;
    double relative_squares = 0.0;
    double max = 0.0;
    std::uint64_t pairs = 0;
    std::uint64_t relevant = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
        for (std::uint32_t j = i + 1; j < size; ++j) {
            const double f_ij = static_cast<double>(static_cast<float>(rows[i][j]));
            const double f_ji = static_cast<double>(static_cast<float>(rows[j][i]));
            if (!known(i) || !known(j) || (f_ij == 0.0 && f_ji == 0.0)) {
                continue;
            }
            const double one = std::abs(f_ij - f_ji * areas[j] / areas[i]);
            const double other = std::abs(f_ji - f_ij * areas[i] / areas[j]);
            squares += (one * one + other * other) / 2.0;
            max = std::max({max, one, other});
            ++pairs;
            if (f_ij > 1e-4 || f_ji > 1e-4) {
                const double relative =
                    std::abs(areas[i] * f_ij - areas[j] * f_ji) / std::max(areas[i] * f_ij, areas[j] * f_ji);
                relative_squares += relative * relative;
                ++relevant;
            }
        }
    }
    const Reciprocity result = reciprocity(matrix, areas);
    CHECK(result.pairs == pairs);
    CHECK(result.rms == Approx(std::sqrt(squares / static_cast<double>(pairs))).epsilon(1e-12));
    CHECK(result.max == Approx(max).epsilon(1e-12));
    CHECK(result.relative_rms ==
          Approx(std::sqrt(relative_squares / static_cast<double>(relevant))).epsilon(1e-12));
}

TEST_CASE("reciprocity: a pair of which only one direction is stored counts in full", "[matrix]") {
    for (const bool upper : {true, false}) {
        DenseRows rows{{0.0, 0.0}, {0.0, 0.0}};
        (upper ? rows[0][1] : rows[1][0]) = 0.25;
        const Reciprocity result = reciprocity(dense_matrix(rows), std::vector<double>{1.0, 1.0});
        CHECK(result.pairs == 1);
        CHECK(result.max == 0.25);
        CHECK(result.rms == 0.25);
        CHECK(result.relative_rms == 1.0);
    }
}

TEST_CASE("reciprocity: the diagonal is no pair", "[matrix]") {
    const Reciprocity result =
        reciprocity(dense_matrix({{0.5, 0.0}, {0.0, 0.25}}), std::vector<double>{1.0, 2.0});
    CHECK(result.pairs == 0);
    CHECK(result.rms == 0.0);
    CHECK(result.relative_rms == 0.0);
}

TEST_CASE("reciprocity: does not depend on the order of the patches", "[matrix]") {
    const std::uint32_t size = 40;
    const DenseRows rows = random_rows(size, 1.0, 21);
    DenseRows reversed(size, std::vector<double>(size));
    std::vector<double> areas(size);
    std::vector<double> reversed_areas(size);
    for (std::uint32_t i = 0; i < size; ++i) {
        areas[i] = 1.0 + i;
        reversed_areas[size - 1 - i] = areas[i];
        for (std::uint32_t j = 0; j < size; ++j) {
            reversed[size - 1 - i][size - 1 - j] = rows[i][j];
        }
    }
    const Reciprocity one = reciprocity(dense_matrix(rows), areas);
    const Reciprocity other = reciprocity(dense_matrix(reversed), reversed_areas);
    CHECK(one.pairs == other.pairs);
    CHECK(one.rms == Approx(other.rms).epsilon(1e-12));
    CHECK(one.max == other.max);
    CHECK(one.worst_i == size - 1 - other.worst_i);
    CHECK(one.worst_j == size - 1 - other.worst_j);
    CHECK(one.relative_rms == Approx(other.relative_rms).epsilon(1e-12));
}

TEST_CASE("reciprocity: refuses areas that do not fit", "[matrix]") {
    const FormFactorMatrix matrix = dense_matrix({{0.0, 1.0}, {1.0, 0.0}});
    CHECK_THROWS_AS(reciprocity(matrix, std::vector<double>{1.0}), InvalidArgument);
    CHECK_THROWS_AS(reciprocity(matrix, std::vector<double>{1.0, 0.0}), InvalidArgument);
}

TEST_CASE("group_factors: add up over targets and average over sources by area", "[matrix]") {
    const FormFactorMatrix matrix = dense_matrix({{0.0, 0.25, 0.5}, {0.5, 0.0, 0.25}, {0.75, 0.125, 0.0}},
                                                 {0.25, 0.0, 0.125}, {0.0, 0.25, 0.0});
    const std::vector<double> areas{1.0, 3.0, 2.0};
    const GroupFactors result = group_factors(matrix, areas, std::vector<std::uint32_t>{0, 0, 1}, 2);
    CHECK(result.groups == 2);
    CHECK(result.areas == std::vector<double>{4.0, 2.0});
    // F(0, 0) = (1·0.25 + 3·0.5) / 4, F(0, 1) = (1·0.5 + 3·0.25) / 4, F(1, 0) = 0.75 + 0.125
    CHECK(result.factors == std::vector<double>{0.4375, 0.3125, 0.875, 0.0});
    CHECK(result.environment == std::vector<double>{0.0625, 0.125});
    CHECK(result.blocked == std::vector<double>{0.1875, 0.0});
}

TEST_CASE("group_factors: a finer grouping sums to a coarser one, and groups keep reciprocity", "[matrix]") {
    const ReciprocalScene scene = reciprocal_scene(120, 31);
    const FormFactorMatrix matrix = dense_matrix(scene.rows);
    std::vector<std::uint32_t> fine(120);
    std::vector<std::uint32_t> coarse(120);
    for (std::uint32_t i = 0; i < 120; ++i) {
        fine[i] = i % 6;
        coarse[i] = fine[i] / 2;
    }
    const GroupFactors six = group_factors(matrix, scene.areas, fine, 6);
    const GroupFactors three = group_factors(matrix, scene.areas, coarse, 3);
    for (std::uint32_t g = 0; g < 3; ++g) {
        for (std::uint32_t h = 0; h < 3; ++h) {
            double exchange = 0.0;
            for (std::uint32_t a : {2 * g, 2 * g + 1}) {
                exchange += six.areas[a] * (six.factors[a * 6 + 2 * h] + six.factors[a * 6 + 2 * h + 1]);
            }
            CHECK(three.areas[g] * three.factors[g * 3 + h] == Approx(exchange).epsilon(1e-12));
            CHECK(three.areas[g] * three.factors[g * 3 + h] ==
                  Approx(three.areas[h] * three.factors[h * 3 + g]).epsilon(1e-7));
        }
    }
}

TEST_CASE("group_factors: a group of which nothing is left is blocked", "[matrix]") {
    const GroupFactors result =
        group_factors(dense_matrix({{0.0, 1.0}, {1.0, 0.0}}), std::vector<double>{1.0, 1.0},
                      std::vector<std::uint32_t>{0, 2}, 3);
    CHECK(result.areas == std::vector<double>{1.0, 0.0, 1.0});
    CHECK(result.factors == std::vector<double>{0, 0, 1, 0, 0, 0, 1, 0, 0});
    CHECK(result.environment[1] == 0.0);
    CHECK(result.blocked == std::vector<double>{0.0, 1.0, 0.0});
}

TEST_CASE("group_factors: refuses unknown rows, missing groups and sizes that differ", "[matrix]") {
    const FormFactorMatrix matrix = dense_matrix({{0.0, 1.0}, {1.0, 0.0}});
    const std::vector<double> areas{1.0, 1.0};
    const std::vector<std::uint32_t> groups{0, 1};
    CHECK_NOTHROW(group_factors(matrix, areas, groups, 2));
    CHECK_THROWS_AS(group_factors(forget_rows(matrix, {1}), areas, groups, 2), InvalidArgument);
    CHECK_THROWS_AS(group_factors(matrix, areas, groups, 1), InvalidArgument);
    CHECK_THROWS_AS(group_factors(matrix, areas, std::vector<std::uint32_t>{0}, 1), InvalidArgument);
    CHECK_THROWS_AS(group_factors(matrix, std::vector<double>{1.0}, groups, 2), InvalidArgument);
}
