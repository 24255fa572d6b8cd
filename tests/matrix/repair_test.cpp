#include "hemi/matrix/repair.hpp"

#include "hemi/core/error.hpp"
#include "matrix/matrix_fixtures.hpp"
#include "support/accuracy_row.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <sched.h>

using namespace hemi;
using namespace hemi::test;

namespace {

/// What is left of a closed row when its entries, some seventy of 0.01, are rounded to floats.
constexpr double float_limit = 3e-8;

/// Every pair times 1 ± `size`, the same both ways.
ReciprocalScene with_noise(const ReciprocalScene& scene, double size, std::uint64_t seed) {
    Random random(seed);
    DenseRows exchange = exchange_of(scene);
    for (std::size_t i = 0; i < exchange.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            exchange[i][j] *= 1.0 + size * (2.0 * random() - 1.0);
            exchange[j][i] = exchange[i][j];
        }
    }
    return scene_of(exchange, scene.areas);
}

double entry(const FormFactorMatrix& matrix, std::uint32_t i, std::uint32_t j) {
    const RowView row = matrix.row(i);
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        if (row.columns[k] == j) {
            return static_cast<double>(row.values[k]);
        }
    }
    return 0.0;
}

double balance_error(const FormFactorMatrix& matrix, std::uint32_t i) {
    const RowView row = matrix.row(i);
    return std::abs(row.sum() + row.environment + row.blocked - 1.0);
}

double largest_difference(const FormFactorMatrix& one, const FormFactorMatrix& other) {
    double largest = 0.0;
    for (std::uint32_t i = 0; i < one.size(); ++i) {
        const RowView a = one.row(i);
        const RowView b = other.row(i);
        REQUIRE(std::equal(a.columns.begin(), a.columns.end(), b.columns.begin(), b.columns.end()));
        for (std::size_t k = 0; k < a.values.size(); ++k) {
            largest = std::max(largest, static_cast<double>(std::abs(a.values[k] - b.values[k])));
        }
    }
    return largest;
}

double rms_difference(const FormFactorMatrix& one, const FormFactorMatrix& other) {
    double squares = 0.0;
    for (std::uint32_t i = 0; i < one.size(); ++i) {
        for (std::uint32_t j = 0; j < one.size(); ++j) {
            const double difference = entry(one, i, j) - entry(other, i, j);
            squares += difference * difference;
        }
    }
    return std::sqrt(squares) / one.size();
}

bool same_values(const FormFactorMatrix& one, const FormFactorMatrix& other) {
    for (std::size_t b = 0; b < one.blocks().size(); ++b) {
        if (one.blocks()[b].values != other.blocks()[b].values) {
            return false;
        }
    }
    return true;
}

/// Stable visibility of a pair: about a third clear, the rest anywhere below.
std::uint8_t pair_code(std::uint32_t i, std::uint32_t j) {
    const std::uint32_t mixed = (std::min(i, j) * 2654435761u) ^ (std::max(i, j) * 40503u);
    return mixed % 3 == 0 ? visibility_clear : static_cast<std::uint8_t>(20 + mixed % 230);
}

} // namespace

TEST_CASE("repair: closure brings the rows of a closed scene to 1 and keeps them reciprocal",
          "[matrix][accuracy]") {
    for (const double ratio : {1.0, 2.0, 1000.0}) {
        const ReciprocalScene exact = closed_scene(150, 3, ratio);
        FormFactorMatrix matrix = dense_matrix(with_noise(exact, 0.05, 4).rows);
        const RepairReport report = repair(matrix, exact.areas, Repair::closure);
        INFO("areas 1 to " << ratio);
        CHECK(report.row_error_before.max > 1e-3);
        AccuracyRow("other limits", "row balance of a closed scene after closure")
            .check_below("limit", "", report.row_error_after.max, float_limit);
        CHECK(report.row_error_after.rms < 1e-8);
        CHECK(is_reciprocal(report.reciprocity_after));
        CHECK(report.iterations > 0);
        CHECK(report.iterations < 100);
        CHECK(report.largest_change < 0.2);
        for (std::uint32_t i = 0; i < 150; ++i) {
            CHECK(balance_error(matrix, i) <= report.row_error_after.max);
        }
    }
}

TEST_CASE("repair: closure is the weighted least change that meets the row sums", "[matrix]") {
    // x - x0 = w (l_i + l_j) with some l is what makes it least; l solves a small dense system.
    const std::uint32_t size = 14;
    const ReciprocalScene scene = with_noise(closed_scene(size, 21), 0.02, 22);
    const RepairSettings settings{.unoccluded_error = 1e-2};
    const FormFactorMatrix before = with_visibility(dense_matrix(scene.rows), pair_code);
    FormFactorMatrix after = before;
    const RepairReport report = repair(after, scene.areas, Repair::closure, settings);
    REQUIRE(report.at_zero + report.at_unoccluded == 0);

    DenseRows weight(size, std::vector<double>(size, 0.0));
    DenseRows system(size, std::vector<double>(size, 0.0));
    std::vector<double> gap = scene.areas;
    for (std::uint32_t i = 0; i < size; ++i) {
        for (std::uint32_t j = 0; j < size; ++j) {
            const double x = scene.areas[i] * entry(before, i, j);
            const double v = pair_code(i, j) / 255.0;
            weight[i][j] = x * x / (v * v) * (1e-4 + (v < 1.0 ? v * (1.0 - v) : 0.0));
            system[i][i] += weight[i][j];
            system[i][j] += weight[i][j];
            gap[i] -= x;
        }
    }
    for (std::size_t k = 0; k < size; ++k) { // elimination; the matrix is positive definite
        for (std::size_t i = k + 1; i < size; ++i) {
            const double factor = system[i][k] / system[k][k];
            for (std::size_t j = k; j < size; ++j) {
                system[i][j] -= factor * system[k][j];
            }
            gap[i] -= factor * gap[k];
        }
    }
    for (std::size_t k = size; k-- > 0;) {
        for (std::size_t j = k + 1; j < size; ++j) {
            gap[k] -= system[k][j] * gap[j];
        }
        gap[k] /= system[k][k];
    }
    for (std::uint32_t i = 0; i < size; ++i) {
        for (std::uint32_t j = 0; j < size; ++j) {
            const double x = scene.areas[i] * entry(before, i, j) + weight[i][j] * (gap[i] + gap[j]);
            CHECK(entry(after, i, j) == Approx(x / scene.areas[i]).epsilon(1e-6).margin(1e-12));
        }
    }
}

TEST_CASE("repair: clear pairs stay, partly hidden ones take up the error", "[matrix]") {
    const ReciprocalScene exact = closed_scene(120, 5);
    DenseRows exchange = exchange_of(exact);
    Random random(6);
    for (std::uint32_t i = 0; i < 120; ++i) {
        for (std::uint32_t j = 0; j < i; ++j) {
            const double v = pair_code(i, j) / 255.0;
            exchange[i][j] *= 1.0 + 0.1 * (2.0 * random() - 1.0) * std::sqrt((1.0 - v) / v);
            exchange[j][i] = exchange[i][j];
        }
    }
    const FormFactorMatrix before =
        with_visibility(dense_matrix(scene_of(exchange, exact.areas).rows), pair_code);
    FormFactorMatrix after = before;
    const RepairReport report = repair(after, exact.areas, Repair::closure);
    CHECK(report.row_error_after.max < float_limit);
    for (std::uint32_t i = 0; i < 120; ++i) {
        for (std::uint32_t j = 0; j < 120; ++j) {
            const double change = std::abs(entry(after, i, j) - entry(before, i, j));
            if (change > 0.0 && pair_code(i, j) == visibility_clear) {
                CHECK(change < 1e-5 * entry(before, i, j));
            }
        }
    }
    CHECK(rms_difference(after, dense_matrix(exact.rows)) <
          0.95 * rms_difference(before, dense_matrix(exact.rows)));
}

TEST_CASE("repair: clear pairs are free to move where nothing else can", "[matrix]") {
    const ReciprocalScene scene = with_noise(closed_scene(90, 7), 1e-4, 8);
    FormFactorMatrix matrix = with_visibility(dense_matrix(scene.rows),
                                              [](std::uint32_t, std::uint32_t) { return visibility_clear; });
    const RepairReport report = repair(matrix, scene.areas, Repair::closure, {.unoccluded_error = 3e-5});
    CHECK(report.row_error_before.max > 1e-6);
    CHECK(report.row_error_after.max < float_limit);
    CHECK(report.at_unoccluded == 0);
}

TEST_CASE("repair: what an open scene loses to its environment stays", "[matrix]") {
    const std::uint32_t size = 100;
    Random random(9);
    ReciprocalScene scene = closed_scene(size, 10);
    std::vector<double> environment;
    std::vector<double> blocked;
    std::vector<double> targets;
    for (std::uint32_t i = 0; i < size; ++i) {
        environment.push_back(0.6 * random());
        blocked.push_back(i % 5 == 0 ? 0.3 * random() : 0.0);
        targets.push_back(scene.areas[i] * (1.0 - environment[i] - blocked[i]));
    }
    DenseRows exchange = exchange_of(scene);
    scale_to_targets(exchange, targets);
    scene = with_noise(scene_of(exchange, scene.areas), 0.03, 11);
    FormFactorMatrix matrix = dense_matrix(scene.rows, environment, blocked);
    const RepairReport report = repair(matrix, scene.areas, Repair::closure);
    CHECK(report.row_error_after.max < float_limit);
    for (std::uint32_t i = 0; i < size; ++i) {
        CHECK(matrix.row(i).environment == environment[i]);
        CHECK(matrix.row(i).blocked == blocked[i]);
        CHECK(balance_error(matrix, i) < float_limit);
    }
}

TEST_CASE("repair: a pair on the diagonal moves as the pairs of patches and their images that it stands for",
          "[matrix]") {
    // Half of a scene whose patches see each other on their own side, and their own images on the other one.
    constexpr std::uint32_t half = 12;
    Random random(5);
    const std::vector<double> areas(2 * std::size_t{half}, 1.0);
    DenseRows whole(2 * std::size_t{half}, std::vector<double>(2 * std::size_t{half}, 0.0));
    DenseRows part(half, std::vector<double>(half, 0.0));
    for (std::size_t i = 0; i < half; ++i) {
        part[i][i] = whole[i][half + i] = whole[half + i][i] = 0.2 + 0.1 * random();
        for (std::size_t j = 0; j < i; ++j) {
            part[i][j] = part[j][i] = 0.05 + 0.03 * random();
            whole[i][j] = whole[j][i] = whole[half + i][half + j] = whole[half + j][half + i] = part[i][j];
        }
    }
    FormFactorMatrix folded = dense_matrix(part);
    FormFactorMatrix unfolded = dense_matrix(whole);
    const std::vector<double> areas_of_half(half, 1.0);
    (void)repair(folded, areas_of_half, Repair::closure);
    (void)repair(unfolded, areas, Repair::closure);
    double moved = 0.0;
    for (std::uint32_t i = 0; i < half; ++i) {
        CHECK(balance_error(folded, i) < float_limit);
        CHECK(entry(folded, i, i) == Approx(entry(unfolded, i, half + i)).margin(1e-7));
        moved = std::max(moved, std::abs(entry(folded, i, i) - part[i][i]));
        for (std::uint32_t j = 0; j < i; ++j) {
            CHECK(entry(folded, i, j) == Approx(entry(unfolded, i, j)).margin(1e-7));
        }
    }
    CHECK(moved > 0.01);
}

TEST_CASE("repair: covered rows set no target", "[matrix]") {
    const ReciprocalScene scene = with_noise(closed_scene(100, 12), 0.02, 13);
    std::vector<double> blocked(100, 0.0);
    blocked[4] = 0.9; // and yet the row has a sum of about 1
    blocked[99] = 0.5;
    FormFactorMatrix matrix = dense_matrix(scene.rows, {}, blocked);
    const RepairReport report = repair(matrix, scene.areas, Repair::closure);
    CHECK(report.row_error_after.max < float_limit);
    CHECK(is_reciprocal(report.reciprocity_after));
    for (std::uint32_t i = 0; i < 100; ++i) {
        if (blocked[i] == 0.0) {
            CHECK(balance_error(matrix, i) < float_limit);
        } else {
            CHECK(matrix.row(i).sum() == Approx(1.0).margin(0.1));
        }
    }
}

TEST_CASE("repair: two facing plates, whose system is singular, close", "[matrix]") {
    // No patch sees another of its own plate; both plates have the same area, so their targets agree.
    const std::uint32_t half = 50;
    const std::vector<double> areas(2 * half, 0.25);
    DenseRows exchange(2 * half, std::vector<double>(2 * half, 0.0));
    Random random(14);
    for (std::uint32_t i = 0; i < half; ++i) {
        for (std::uint32_t j = half; j < 2 * half; ++j) {
            exchange[i][j] = exchange[j][i] = 0.5 + random();
        }
    }
    scale_to_targets(exchange, areas);
    const ReciprocalScene scene = with_noise(scene_of(exchange, areas), 0.05, 15);
    FormFactorMatrix matrix = dense_matrix(scene.rows);
    const RepairReport report = repair(matrix, areas, Repair::closure);
    CHECK(report.row_error_after.max < float_limit);
    CHECK(is_reciprocal(report.reciprocity_after));
}

TEST_CASE("repair: targets that contradict each other are met as nearly as can be", "[matrix]") {
    // What leaves one plate must arrive at the other, but their rows ask for sums of 1 and 0.99.
    const std::uint32_t half = 40;
    const std::vector<double> areas(2 * half, 1.0);
    DenseRows rows(2 * half, std::vector<double>(2 * half, 0.0));
    std::vector<double> environment(2 * half, 0.0);
    for (std::uint32_t i = 0; i < half; ++i) {
        environment[i] = 0.01;
        for (std::uint32_t j = half; j < 2 * half; ++j) {
            rows[i][j] = rows[j][i] = 1.0 / half;
        }
    }
    FormFactorMatrix matrix = dense_matrix(rows, environment);
    const RepairReport report = repair(matrix, areas, Repair::closure);
    CHECK(report.row_error_before.max == Approx(0.01).epsilon(1e-4));
    CHECK(report.row_error_after.max < 0.0101);
    CHECK(report.row_error_after.rms < 0.0075);
    CHECK(report.iterations < 500);
    CHECK(is_reciprocal(report.reciprocity_after));
}

TEST_CASE("repair: no factor becomes negative", "[matrix]") {
    // Two patches whose rows are mostly each other, and which lose most of it to the environment.
    ReciprocalScene scene = closed_scene(90, 16);
    DenseRows exchange = exchange_of(scene);
    exchange[0][1] = exchange[1][0] = 0.5 * scene.areas[0];
    scene = scene_of(exchange, scene.areas);
    std::vector<double> environment(90, 0.0);
    environment[0] = environment[1] = 0.8;
    FormFactorMatrix matrix = dense_matrix(scene.rows, environment);
    const RepairReport report = repair(matrix, scene.areas, Repair::closure);
    CHECK(report.at_zero > 0);
    CHECK(report.passes > 1);
    CHECK(report.row_error_after.max < float_limit);
    CHECK(entry(matrix, 0, 1) == 0.0);
    for (const RowBlock& block : matrix.blocks()) {
        CHECK(std::all_of(block.values.begin(), block.values.end(), [](float f) { return f >= 0.0F; }));
    }
}

TEST_CASE("repair: a partly hidden pair does not exceed its unoccluded factor", "[matrix]") {
    const std::uint32_t size = 80;
    ReciprocalScene scene = closed_scene(size, 18);
    DenseRows exchange = exchange_of(scene);
    for (std::uint32_t j = 0; j < size; ++j) { // row 7 lacks a tenth
        exchange[7][j] *= 0.9;
        exchange[j][7] = exchange[7][j];
    }
    scene = scene_of(exchange, scene.areas);
    const auto code = [](std::uint32_t i, std::uint32_t j) {
        return (i + j) % 3 == 0 ? visibility_clear : static_cast<std::uint8_t>(245);
    };
    const FormFactorMatrix before = with_visibility(dense_matrix(scene.rows), code);
    FormFactorMatrix after = before;
    const RepairSettings settings{.unoccluded_error = 1e-3};
    const RepairReport report = repair(after, scene.areas, Repair::closure, settings);
    CHECK(report.at_unoccluded > 0);
    CHECK(report.row_error_after.max < float_limit); // by lifting the clear ones further
    for (std::uint32_t i = 0; i < size; ++i) {
        for (std::uint32_t j = 0; j < size; ++j) {
            if (code(i, j) != visibility_clear) {
                CHECK(entry(after, i, j) <= entry(before, i, j) * 255.0 / 245.0 * 1.001 * (1.0 + 1e-6));
            }
        }
    }
}

TEST_CASE("repair: a second closure changes nothing", "[matrix]") {
    for (const bool plain : {true, false}) {
        const ReciprocalScene scene = with_noise(closed_scene(130, 19), 0.05, 20);
        FormFactorMatrix matrix = dense_matrix(scene.rows);
        if (!plain) {
            matrix = with_visibility(matrix, pair_code);
        }
        (void)repair(matrix, scene.areas, Repair::closure);
        const FormFactorMatrix once = matrix;
        const RepairReport again = repair(matrix, scene.areas, Repair::closure);
        CHECK(largest_difference(once, matrix) < 1e-8);
        CHECK(again.largest_change < 1e-6);
        CHECK(again.at_zero == 0);
    }
}

TEST_CASE("repair: rows that were not computed stay empty and the others close", "[matrix]") {
    const ReciprocalScene scene = with_noise(closed_scene(140, 23), 0.05, 24);
    const std::vector<std::uint32_t> unknown{0, 1, 17, 64, 100, 139};
    for (const bool plain : {true, false}) {
        FormFactorMatrix matrix = forget_rows(dense_matrix(scene.rows), unknown);
        if (!plain) {
            matrix = with_visibility(matrix, pair_code);
        }
        const RepairReport report = repair(matrix, scene.areas, Repair::closure);
        CHECK(report.row_error_after.max < float_limit);
        CHECK(is_reciprocal(report.reciprocity_after));
        for (std::uint32_t i = 0; i < 140; ++i) {
            const bool known = std::find(unknown.begin(), unknown.end(), i) == unknown.end();
            CHECK(matrix.known(i) == known);
            CHECK(matrix.row(i).columns.empty() == !known);
            if (known) {
                CHECK(balance_error(matrix, i) < float_limit);
            }
        }
    }
}

TEST_CASE("repair: reciprocity weighs the smaller patch more", "[matrix]") {
    FormFactorMatrix matrix = dense_matrix({{0.0, 0.5, 0.25}, {0.75, 0.0, 0.0}, {0.0, 0.0, 0.0}});
    const std::vector<double> areas{4.0, 1.0, 2.0};
    const RepairReport report = repair(matrix, areas, Repair::reciprocity);
    // x_01 = (0.5 + 0.75) / (1/4 + 1) = 1; x_02 = 0.25 / (1/4 + 1/2) = 1/3: F(2, 0) was not stored.
    CHECK(entry(matrix, 0, 1) == Approx(0.25));
    CHECK(entry(matrix, 1, 0) == Approx(1.0));
    CHECK(entry(matrix, 0, 2) == Approx(1.0 / 12.0));
    CHECK(entry(matrix, 2, 0) == Approx(1.0 / 6.0));
    CHECK(report.added == 1);
    CHECK(report.reciprocity_before.relative_max == 1.0);
    CHECK(is_reciprocal(report.reciprocity_after));
    CHECK(report.iterations == 0);
}

TEST_CASE("repair: rows stored one way only become pairs, with their visibility", "[matrix]") {
    const std::uint32_t size = 130;
    const DenseRows rows = random_rows(size, 1.0, 25); // with a diagonal; most pairs one way
    std::vector<double> areas;
    Random random(26);
    for (std::uint32_t i = 0; i < size; ++i) {
        areas.push_back(0.5 + random());
    }
    const std::vector<std::uint32_t> unknown{5, 128};
    const FormFactorMatrix before = with_visibility(forget_rows(dense_matrix(rows), unknown), pair_code);
    FormFactorMatrix after = before;
    const RepairReport report = repair(after, areas, Repair::reciprocity);
    CHECK(report.added == after.entries() - before.entries());
    CHECK(is_reciprocal(report.reciprocity_after));
    for (std::uint32_t i = 0; i < size; ++i) {
        const RowView row = after.row(i);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            const std::uint32_t j = row.columns[k];
            const double value = static_cast<double>(row.values[k]);
            CHECK(row.visibility[k] == pair_code(i, j));
            if (i == j || !after.known(j)) {
                CHECK(value == entry(before, i, j));
            } else {
                const double x =
                    (entry(before, i, j) + entry(before, j, i)) / (1.0 / areas[i] + 1.0 / areas[j]);
                CHECK(value == Approx(x / areas[i]).epsilon(1e-7));
            }
        }
    }
}

TEST_CASE("repair: none only looks", "[matrix]") {
    const ReciprocalScene scene = with_noise(closed_scene(70, 27), 0.05, 28);
    const FormFactorMatrix before = dense_matrix(scene.rows);
    FormFactorMatrix after = before;
    const RepairReport report = repair(after, scene.areas, Repair::none);
    CHECK(same_values(before, after));
    CHECK(report.row_error_before.max > 1e-3);
    CHECK(report.row_error_after.max == report.row_error_before.max);
    CHECK(report.reciprocity_after.max == report.reciprocity_before.max);
}

TEST_CASE("repair: the same bits on one thread and on many", "[matrix]") {
    const std::uint32_t size = 900; // several slices
    DenseRows rows(size, std::vector<double>(size, 0.0));
    Random random(29);
    for (auto& row : rows) {
        for (double& value : row) {
            value = random() / (0.5 * size);
        }
    }
    const std::vector<double> areas(size, 1.0);
    FormFactorMatrix many = dense_matrix(rows);
    FormFactorMatrix one = many;
    (void)repair(many, areas, Repair::closure);

    cpu_set_t before;
    REQUIRE(sched_getaffinity(0, sizeof before, &before) == 0);
    cpu_set_t single;
    CPU_ZERO(&single);
    for (std::size_t cpu = 0; CPU_COUNT(&single) == 0; ++cpu) {
        if (CPU_ISSET(cpu, &before)) {
            CPU_SET(cpu, &single);
        }
    }
    REQUIRE(sched_setaffinity(0, sizeof single, &single) == 0);
    const RepairReport report = repair(one, areas, Repair::closure);
    REQUIRE(sched_setaffinity(0, sizeof before, &before) == 0);
    CHECK(same_values(many, one));
    CHECK(report.row_error_after.max < 1e-8);
}

TEST_CASE("repair: matrices without rows or entries are left as they are", "[matrix]") {
    FormFactorMatrix none(0);
    CHECK_NOTHROW(repair(none, {}, Repair::closure));
    FormFactorMatrix unknown(3);
    CHECK_NOTHROW(repair(unknown, std::vector<double>(3, 1.0), Repair::closure));
    CHECK_FALSE(unknown.known(0));
    FormFactorMatrix empty = dense_matrix({{0.0, 0.0}, {0.0, 0.0}});
    CHECK(repair(empty, std::vector<double>(2, 1.0), Repair::closure).row_error_after.max == 1.0);
}

TEST_CASE("repair: refuses areas and settings that do not fit", "[matrix]") {
    FormFactorMatrix matrix = dense_matrix({{0.0, 1.0}, {1.0, 0.0}});
    const std::vector<double> areas{1.0, 1.0};
    CHECK_THROWS_AS(repair(matrix, std::vector<double>{1.0}, Repair::closure), InvalidArgument);
    CHECK_THROWS_AS(repair(matrix, std::vector<double>{1.0, 0.0}, Repair::closure), InvalidArgument);
    CHECK_THROWS_AS(repair(matrix, areas, Repair::closure, {.unoccluded_error = 0.0}), InvalidArgument);
    CHECK_THROWS_AS(repair(matrix, areas, Repair::closure, {.tolerance = std::nan("")}), InvalidArgument);
    CHECK(matrix.entries() == 2);
}
