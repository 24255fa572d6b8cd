#include "hemi/core/error.hpp"
#include "hemi/matrix/repair.hpp"
#include "solver/row_balance.hpp"
#include "solver/solver_fixtures.hpp"
#include "support/accuracy_row.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <sched.h>

using namespace hemi;
using namespace hemi::test;

namespace {

/// Rows of a closed scene as floats, closed and reciprocal to their rounding, one lamp.
OwnedProblem closed_problem(const ReciprocalScene& scene, double reflectance) {
    OwnedProblem problem = uniform_problem(dense_matrix(scene.rows), reflectance, 0.0);
    problem.exitance[0] = 1.0;
    problem.areas = scene.areas;
    (void)repair(problem.factors, problem.areas, Repair::closure);
    return problem;
}

OwnedProblem furnace(std::uint32_t size, double reflectance) {
    OwnedProblem problem = closed_problem(closed_scene(size, 31), reflectance);
    std::fill(problem.exitance.begin(), problem.exitance.end(), 2.0);
    return problem;
}

/// Two closed rooms whose last and first patch see each other through an opening.
OwnedProblem two_rooms(std::uint32_t size_of_room, double opening, double reflectance) {
    const ReciprocalScene one = closed_scene(size_of_room, 32);
    const ReciprocalScene other = closed_scene(size_of_room, 33);
    const std::uint32_t size = 2 * size_of_room;
    DenseRows exchange(size, std::vector<double>(size, 0.0));
    std::vector<double> areas = one.areas;
    areas.insert(areas.end(), other.areas.begin(), other.areas.end());
    for (std::uint32_t i = 0; i < size_of_room; ++i) {
        for (std::uint32_t j = 0; j < size_of_room; ++j) {
            exchange[i][j] = one.areas[i] * one.rows[i][j];
            exchange[size_of_room + i][size_of_room + j] = other.areas[i] * other.rows[i][j];
        }
    }
    exchange[size_of_room - 1][size_of_room] = exchange[size_of_room][size_of_room - 1] = opening;
    scale_to_targets(exchange, areas);
    return closed_problem(scene_of(exchange, areas), reflectance);
}

/// Open, with environment and blocked shares, symmetric and in balance.
OwnedProblem open_problem(std::uint32_t size, std::uint32_t channels, std::uint64_t seed) {
    Random random(seed);
    const ReciprocalScene closed = closed_scene(size, seed + 1);
    DenseRows exchange = exchange_of(closed);
    std::vector<double> environment;
    std::vector<double> blocked;
    std::vector<double> targets;
    for (std::uint32_t i = 0; i < size; ++i) {
        environment.push_back(random() < 0.5 ? 0.3 * random() : 0.0);
        blocked.push_back(random() < 0.2 ? 0.1 * random() : 0.0);
        targets.push_back(closed.areas[i] * (1.0 - environment[i] - blocked[i]));
    }
    scale_to_targets(exchange, targets);
    const ReciprocalScene scene = scene_of(exchange, closed.areas);
    OwnedProblem problem{dense_matrix(scene.rows, environment, blocked), channels, {}, {}, {}, scene.areas};
    for (std::size_t k = 0; k < std::size_t{size} * channels; ++k) {
        problem.reflectance.push_back(random() < 0.2 ? 0.0 : 0.99 * random());
        problem.exitance.push_back(random() < 0.3 ? 10.0 * random() : 0.0);
    }
    for (std::uint32_t c = 0; c < channels; ++c) {
        problem.environment.push_back(random());
    }
    return problem;
}

SolverSettings gradients(double tolerance = 1e-10) {
    return {.method = SolverMethod::conjugate_gradient, .tolerance = tolerance};
}

double largest_relative_difference(const std::vector<double>& one, const std::vector<double>& other) {
    REQUIRE(one.size() == other.size());
    double largest = 0.0;
    for (std::size_t k = 0; k < one.size(); ++k) {
        largest = std::max(largest, std::abs(one[k] - other[k]) / std::max(other[k], 1e-300));
    }
    return largest;
}

double largest_error(const std::vector<double>& values, double exact) {
    return largest_relative_difference(values, std::vector<double>(values.size(), exact));
}

template <class Expected>
std::string refusal(const OwnedProblem& problem, const SolverSettings& settings) {
    try {
        (void)solve_radiosity(problem.view(), settings);
    } catch (const Expected& error) {
        return error.what();
    }
    FAIL("it was not refused");
    return {};
}

} // namespace

TEST_CASE("conjugate gradients: a furnace of float factors is right up to reflectance 1 - 1e-6",
          "[solver][accuracy][slow]") {
    for (const double rho : {0.5, 0.9, 0.99, 0.9999, 1.0 - 1e-6}) {
        const OwnedProblem problem = furnace(150, rho);
        const Solution solution = solve_radiosity(problem.view(), gradients(1e-9));
        INFO("reflectance " << rho);
        AccuracyRow("other limits", "furnace up to reflectance 1 - 1e-6, conjugate gradients, relative")
            .check_below("limit", "", largest_error(solution.radiosity, 2.0 / (1.0 - rho)), 1e-7);
        CHECK(solution.residual <= 1e-9);
        CHECK(solution.sweeps < 10);
    }
}

TEST_CASE("sweeps: a furnace of float factors is right up to reflectance 1 - 1e-6",
          "[solver][accuracy][slow]") {
    // Few patches, for it takes millions of sweeps.
    const std::vector<double> areas{1.0, 1.1, 1.3, 1.2};
    DenseRows exchange{
        {0.0, 1.0, 2.0, 1.5}, {1.0, 0.0, 1.2, 1.0}, {2.0, 1.2, 0.0, 1.7}, {1.5, 1.0, 1.7, 0.0}};
    scale_to_targets(exchange, areas);
    for (const SolverMethod method : {SolverMethod::gauss_seidel, SolverMethod::jacobi}) {
        const double rho = 1.0 - (method == SolverMethod::jacobi ? 1e-5 : 1e-6);
        OwnedProblem problem = closed_problem(scene_of(exchange, areas), rho);
        problem.exitance.assign(4, 2.0);
        const Solution solution =
            solve_radiosity(problem.view(), {.method = method, .tolerance = 5e-7, .max_sweeps = 100'000'000});
        AccuracyRow("other limits", method == SolverMethod::jacobi
                                        ? "furnace of reflectance 1 - 1e-5, Jacobi, relative"
                                        : "furnace of reflectance 1 - 1e-6, Gauss-Seidel, relative")
            .check_below("limit", "", largest_error(solution.radiosity, 2.0 / (1.0 - rho)), 1e-6);
    }
}

TEST_CASE("sweeps: rows that are wrong by some per mille keep a furnace in balance", "[solver]") {
    OwnedProblem problem = furnace(40, 0.9999);
    for (RowBlock& block : problem.factors.take_blocks()) {
        for (std::uint32_t local = 0; local < block.rows(); ++local) {
            for (std::uint64_t k = block.begin[local]; k < block.begin[local + 1]; ++k) {
                block.values[k] *= local % 2 == 0 ? 1.004F : 0.997F;
            }
        }
        problem.factors.set_block(std::move(block));
    }
    const Solution solution =
        solve_radiosity(problem.view(), {.method = SolverMethod::gauss_seidel, .tolerance = 1e-8});
    CHECK(largest_error(solution.radiosity, 2.0 / 1e-4) < 1e-6);
}

TEST_CASE("conjugate gradients: the number of iterations does not depend on the reflectance", "[solver]") {
    const ReciprocalScene scene = closed_scene(200, 34);
    std::uint32_t fewest = 1000;
    std::uint32_t most = 0;
    for (const double rho : {0.5, 0.9, 0.99, 0.9999, 1.0 - 1e-6}) {
        const OwnedProblem problem = closed_problem(scene, rho);
        const Solution solution = solve_radiosity(problem.view(), gradients(1e-9));
        fewest = std::min(fewest, solution.sweeps);
        most = std::max(most, solution.sweeps);
        CHECK(largest_relative_difference(solution.radiosity, solve_dense(problem)) < 1e-6);
    }
    CHECK(fewest >= 5);
    CHECK(most <= 25);
}

TEST_CASE("sweeps: as many as the reflectance says", "[solver]") {
    // The slow part of the error falls by the factor rho a Jacobi sweep, by rho² a Gauss-Seidel sweep.
    const OwnedProblem problem = closed_problem(closed_scene(200, 34), 0.9);
    const double expected = std::log(1e10) / 0.1;
    const auto sweeps = [&](SolverMethod method) {
        return solve_radiosity(problem.view(), {.method = method, .tolerance = 1e-10}).sweeps;
    };
    CHECK(sweeps(SolverMethod::jacobi) == Approx(expected).epsilon(0.15));
    CHECK(sweeps(SolverMethod::gauss_seidel) == Approx(expected / 2.0).epsilon(0.15));
}

TEST_CASE("conjugate gradients: reflectances from 0 to 1 - 1e-6 in one scene", "[solver]") {
    OwnedProblem problem = closed_problem(closed_scene(160, 35), 0.0);
    Random random(36);
    const double levels[] = {0.0, 0.3, 0.95, 1.0 - 1e-6};
    for (std::size_t i = 0; i < 160; ++i) {
        problem.reflectance[i] = levels[static_cast<std::size_t>(4.0 * random())];
        problem.exitance[i] = random() < 0.1 ? 5.0 * random() : 0.0;
    }
    const Solution solution = solve_radiosity(problem.view(), gradients());
    CHECK(largest_relative_difference(solution.radiosity, solve_dense(problem)) < 1e-6);
    CHECK(solution.sweeps <= 40);
    const Solution sweeps =
        solve_radiosity(problem.view(), {.method = SolverMethod::gauss_seidel, .tolerance = 1e-10});
    CHECK(largest_relative_difference(solution.radiosity, sweeps.radiosity) < 1e-6);
}

TEST_CASE("conjugate gradients: two rooms joined by a small opening", "[solver][slow]") {
    for (const double opening : {1e-2, 1e-5}) {
        for (const double rho : {0.9, 0.9999, 1.0 - 1e-6}) {
            const OwnedProblem problem = two_rooms(80, opening, rho);
            const Solution solution = solve_radiosity(problem.view(), gradients(1e-9));
            INFO("opening " << opening << ", reflectance " << rho);
            CHECK(solution.sweeps < 40);
            CHECK(largest_relative_difference(solution.radiosity, solve_dense(problem)) < 1e-5);
            // Less light on the far side of the opening, and none is lost but by absorption.
            CHECK(solution.radiosity.back() < solution.radiosity[1]);
            double absorbed = 0.0;
            for (std::size_t i = 0; i < problem.areas.size(); ++i) {
                absorbed +=
                    problem.areas[i] * (solution.radiosity[i] - problem.exitance[i]) * (1.0 - rho) / rho;
            }
            CHECK(absorbed == Approx(problem.areas[0]).epsilon(1e-6));
        }
    }
}

TEST_CASE("conjugate gradients: agree with elimination and sweeps in open scenes", "[solver][slow]") {
    for (const std::uint32_t channels : {1u, 2u, 3u, 4u, 5u, 9u}) {
        for (const std::uint32_t size : {64u, 101u}) {
            OwnedProblem problem = open_problem(size, channels, 100 * size + channels);
            (void)repair(problem.factors, problem.areas, Repair::reciprocity);
            const Solution solution = solve_radiosity(problem.view(), gradients(1e-12));
            const Solution sweeps =
                solve_radiosity(problem.view(), {.method = SolverMethod::gauss_seidel, .tolerance = 1e-12});
            CHECK(solution.residual <= 1e-12);
            CHECK(largest_difference(solution.radiosity, sweeps.radiosity) < 1e-5);
            CHECK(largest_difference(solution.radiosity, solve_dense(problem)) < 1e-5);
            CHECK(solution.dominance == Approx(sweeps.dominance));
        }
    }
}

TEST_CASE("conjugate gradients: black rows may be unknown, lamps among them", "[solver]") {
    OwnedProblem problem = open_problem(130, 2, 41);
    const std::vector<std::uint32_t> unknown{0, 1, 40, 64, 100, 129};
    for (const std::uint32_t i : unknown) {
        problem.reflectance[2 * i] = problem.reflectance[2 * i + 1] = 0.0;
        problem.exitance[2 * i] = 3.0 + i;
    }
    const Solution all = solve_radiosity(problem.view(), gradients());
    problem.factors = forget_rows(problem.factors, unknown);
    const Solution some = solve_radiosity(problem.view(), gradients());
    CHECK(largest_relative_difference(some.radiosity, all.radiosity) < 1e-6);
    for (const std::uint32_t i : unknown) {
        CHECK(some.radiosity[2 * i] == problem.exitance[2 * i]);
    }
}

TEST_CASE("solve_radiosity: all black, nothing emitting, one patch", "[solver]") {
    for (const SolverMethod method :
         {SolverMethod::gauss_seidel, SolverMethod::jacobi, SolverMethod::conjugate_gradient}) {
        OwnedProblem black = open_problem(50, 3, 51);
        std::fill(black.reflectance.begin(), black.reflectance.end(), 0.0);
        const Solution solution = solve_radiosity(black.view(), {.method = method});
        CHECK(solution.radiosity == black.exitance);
        CHECK(solution.residual == 0.0);
        CHECK(solution.sweeps <= 1);

        OwnedProblem dark = open_problem(50, 3, 52);
        dark.environment.clear();
        std::fill(dark.exitance.begin(), dark.exitance.end(), 0.0);
        CHECK(solve_radiosity(dark.view(), {.method = method}).radiosity == dark.exitance);

        OwnedProblem one = uniform_problem(dense_matrix({{0.0}}, {1.0}), 0.5, 2.0);
        one.areas = {3.0};
        one.environment = {4.0};
        CHECK(solve_radiosity(one.view(), {.method = method}).radiosity[0] == Approx(4.0));

        OwnedProblem self = uniform_problem(dense_matrix({{0.75}}, {0.25}), 0.8, 1.0);
        self.areas = {2.0};
        CHECK(solve_radiosity(self.view(), {.method = method}).radiosity[0] == Approx(2.5));

        OwnedProblem none{FormFactorMatrix(0), 3, {}, {}, {}};
        if (method != SolverMethod::conjugate_gradient) {
            CHECK(solve_radiosity(none.view(), {.method = method}).radiosity.empty());
        }
    }
}

TEST_CASE("conjugate gradients: channels that differ end together", "[solver]") {
    OwnedProblem problem = closed_problem(closed_scene(90, 53), 0.0);
    problem.channels = 4;
    problem.reflectance.clear();
    problem.exitance.clear();
    for (std::size_t i = 0; i < 90; ++i) {
        problem.reflectance.insert(problem.reflectance.end(), {0.0, 0.01, 0.5, 1.0 - 1e-6});
        problem.exitance.insert(problem.exitance.end(),
                                {1.0, i == 0 ? 1e-200 : 0.0, 0.0, i == 5 ? 1e200 : 0.0});
    }
    const Solution solution = solve_radiosity(problem.view(), gradients(1e-9));
    CHECK(solution.residual <= 1e-9);
    CHECK(largest_relative_difference(solution.radiosity, solve_dense(problem)) < 1e-5);
}

TEST_CASE("conjugate gradients: a grey channel equals each of three equal channels bit for bit", "[solver]") {
    const OwnedProblem grey = open_problem(150, 1, 54);
    for (const std::uint32_t channels : {2u, 3u, 4u, 7u}) {
        OwnedProblem colour{grey.factors, channels, {}, {}, {}, grey.areas};
        for (std::size_t i = 0; i < 150; ++i) {
            colour.reflectance.insert(colour.reflectance.end(), channels, grey.reflectance[i]);
            colour.exitance.insert(colour.exitance.end(), channels, grey.exitance[i]);
        }
        colour.environment.assign(channels, grey.environment[0]);
        const Solution one = solve_radiosity(grey.view(), gradients());
        const Solution many = solve_radiosity(colour.view(), gradients());
        CHECK(one.sweeps == many.sweeps);
        for (std::uint32_t c = 0; c < channels; ++c) {
            std::vector<double> channel;
            for (std::size_t i = 0; i < 150; ++i) {
                channel.push_back(many.radiosity[i * channels + c]);
            }
            CHECK(same_bits(channel, one.radiosity));
        }
    }
}

TEST_CASE("conjugate gradients: linear in the light, at any magnitude", "[solver]") {
    const OwnedProblem problem = open_problem(60, 1, 55);
    const Solution one = solve_radiosity(problem.view(), gradients());
    for (const int exponent : {-700, -3, 800}) {
        OwnedProblem scaled = problem;
        for (double& value : scaled.exitance) {
            value = std::ldexp(value, exponent);
        }
        scaled.environment[0] = std::ldexp(scaled.environment[0], exponent);
        Solution other = solve_radiosity(scaled.view(), gradients());
        for (double& value : other.radiosity) {
            value = std::ldexp(value, -exponent);
        }
        CHECK(same_bits(one.radiosity, other.radiosity));
    }
}

TEST_CASE("conjugate gradients: the same bits on one thread and on many", "[solver]") {
    const std::uint32_t size = 900; // several slices
    DenseRows rows(size, std::vector<double>(size, 1.0 / size));
    OwnedProblem problem = uniform_problem(dense_matrix(rows), 0.95, 0.0);
    problem.areas.assign(size, 1.0);
    Random random(56);
    for (double& exitance : problem.exitance) {
        exitance = random();
    }
    const Solution many = solve_radiosity(problem.view(), gradients());
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
    const Solution one = solve_radiosity(problem.view(), gradients());
    REQUIRE(sched_setaffinity(0, sizeof before, &before) == 0);
    CHECK(same_bits(one.radiosity, many.radiosity));
}

TEST_CASE("solve_radiosity: chooses the method and says why", "[solver]") {
    OwnedProblem problem = closed_problem(closed_scene(50, 57), 0.95);
    const auto solve = [&] { return solve_radiosity(problem.view()); };
    Solution solution = solve();
    CHECK(solution.method == SolverMethod::conjugate_gradient);
    CHECK_THAT(solution.reason, Catch::Contains("0.95") && Catch::Contains("reciprocal"));

    std::fill(problem.reflectance.begin(), problem.reflectance.end(), 0.9);
    solution = solve();
    CHECK(solution.method == SolverMethod::gauss_seidel);
    CHECK_THAT(solution.reason, Catch::Contains("0.9"));

    std::fill(problem.reflectance.begin(), problem.reflectance.end(), 0.95);
    const std::vector<double> areas = std::exchange(problem.areas, {});
    solution = solve();
    CHECK(solution.method == SolverMethod::gauss_seidel);
    CHECK_THAT(solution.reason, Catch::Contains("areas"));

    problem.areas = areas;
    problem.factors = dense_matrix(random_rows(50, 1.0, 58));
    solution = solve();
    CHECK(solution.method == SolverMethod::gauss_seidel);
    CHECK_THAT(solution.reason, Catch::Contains("not reciprocal"));

    CHECK(solve_radiosity(problem.view(), {.method = SolverMethod::jacobi}).reason == "as asked for");
    CHECK(to_word(SolverMethod::automatic) == "auto");
    CHECK(to_word(SolverMethod::gauss_seidel) == "gauss-seidel");
    CHECK(to_word(SolverMethod::jacobi) == "jacobi");
    CHECK(to_word(SolverMethod::conjugate_gradient) == "cg");
}

TEST_CASE("conjugate gradients: refuse rows that are not reciprocal and areas that do not fit", "[solver]") {
    OwnedProblem problem = uniform_problem(dense_matrix(random_rows(50, 1.0, 59)), 0.5, 1.0);
    CHECK_THAT(refusal<InvalidArgument>(problem, gradients()), Catch::Contains("need the areas"));
    problem.areas.assign(50, 1.0);
    CHECK_THAT(refusal<InvalidArgument>(problem, gradients()),
               Catch::Contains("repair the rows") && Catch::Contains("patches "));
    problem.areas.pop_back();
    CHECK_THAT(refusal<InvalidArgument>(problem, gradients()), Catch::Contains("49 areas"));
    problem.areas.push_back(0.0);
    CHECK_THAT(refusal<InvalidArgument>(problem, gradients()), Catch::Contains("patch 49"));
}

TEST_CASE("conjugate gradients: say so when they do not come to an end", "[solver]") {
    const OwnedProblem problem = closed_problem(closed_scene(60, 60), 0.95);
    SolverSettings settings = gradients();
    settings.max_sweeps = 2;
    CHECK_THAT(refusal<NotConverged>(problem, settings),
               Catch::Contains("conjugate gradients") && Catch::Contains("after 2 iterations"));
    CHECK_THAT(refusal<NotConverged>(problem, gradients(1e-30)), Catch::Contains("rounding"));

    ReciprocalScene making = closed_scene(60, 61);
    for (auto& row : making.rows) {
        for (double& value : row) {
            value *= 1.25;
        }
    }
    OwnedProblem energy = uniform_problem(dense_matrix(making.rows), 0.9, 1.0);
    energy.areas = making.areas;
    (void)repair(energy.factors, energy.areas, Repair::reciprocity);
    CHECK_THAT(refusal<NotConverged>(energy, gradients()), Catch::Contains("row sum"));

    std::uint32_t last = 0;
    SolverSettings watched = gradients();
    watched.watch = [&](std::uint32_t iteration, double, const auto&) {
        last = iteration;
        return iteration < 3;
    };
    CHECK_THROWS_AS(solve_radiosity(problem.view(), watched), Cancelled);
    CHECK(last == 3);
}

TEST_CASE("balance_row: small errors of a row go to the patch itself, large ones stay", "[solver]") {
    CHECK(balance_row(0.7, 0.2, 0.1).defect == Approx(0.0).margin(1e-15));
    CHECK(balance_row(0.7, 0.2, 0.1).lost == Approx(0.3));
    CHECK(balance_row(0.995, 0.0, 0.0).defect == Approx(0.005));
    CHECK(balance_row(0.995, 0.0, 0.0).lost == 0.0);
    CHECK(balance_row(1.005, 0.0, 0.0).defect == Approx(-0.005));
    CHECK(balance_row(0.5, 0.0, 0.0).defect == 0.0);
    CHECK(balance_row(0.5, 0.0, 0.0).lost == 0.5);
    CHECK(balance_row(1.25, 0.0, 0.0).defect == 0.0);
    // Covered: the row may see more than its balance leaves, but not make light.
    CHECK(balance_row(0.3, 0.0, 0.9).defect == 0.0);
    CHECK(balance_row(0.3, 0.0, 0.9).lost == 0.7);
    CHECK(balance_row(0.995, 0.0, 0.5).defect == 0.0);
    CHECK(balance_row(1.004, 0.0, 0.5).defect == Approx(-0.004));
}
