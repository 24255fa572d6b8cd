#include "hemi/solver/solver.hpp"

#include "hemi/core/error.hpp"
#include "solver/solver_fixtures.hpp"
#include "support/accuracy_row.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <string>

using namespace hemi;
using namespace hemi::test;

namespace {

const SolverMethod methods[] = {SolverMethod::gauss_seidel, SolverMethod::jacobi};

SolverSettings tight(SolverMethod method = SolverMethod::gauss_seidel) {
    return {.method = method, .tolerance = 1e-13};
}

std::string not_converged_message(const OwnedProblem& problem, const SolverSettings& settings) {
    try {
        (void)solve_radiosity(problem.view(), settings);
    } catch (const NotConverged& error) {
        return error.what();
    }
    FAIL("it converged");
    return {};
}

} // namespace

TEST_CASE("solve_radiosity: two patches of different area and reflectance", "[solver]") {
    // Areas 1 and 4, F(0, 1) = 0.5 and F(1, 0) = 0.125. Inserting one equation into the other:
    //   B_0 = (E_0 + rho_0 F_01 E_1) / (1 - rho_0 rho_1 F_01 F_10), B_1 likewise.
    const double f01 = 0.5;
    const double f10 = 0.125;
    const double rho[2] = {0.8, 0.3};
    const double e[2] = {2.0, 7.0};
    const OwnedProblem problem{dense_matrix({{0.0, f01}, {f10, 0.0}}), 1, {rho[0], rho[1]}, {e[0], e[1]}, {}};
    const double determinant = 1.0 - rho[0] * rho[1] * f01 * f10;
    for (const SolverMethod method : methods) {
        const Solution solution = solve_radiosity(problem.view(), tight(method));
        CHECK(solution.radiosity[0] == Approx((e[0] + rho[0] * f01 * e[1]) / determinant).epsilon(1e-12));
        CHECK(solution.radiosity[1] == Approx((e[1] + rho[1] * f10 * e[0]) / determinant).epsilon(1e-12));
        CHECK(solution.residual <= 1e-13);
        CHECK(solution.dominance == Approx(rho[0] * f01));
    }
}

TEST_CASE("solve_radiosity: parallel plates exchange the flux of the textbook", "[solver]") {
    // Endless grey plates, emissivities 1 - rho, black exitances M: the net flux from 0 to 1 is
    //   (M_0 - M_1) / (1/eps_0 + 1/eps_1 - 1).
    const double eps[2] = {0.6, 0.25};
    const double black[2] = {500.0, 120.0};
    const OwnedProblem problem{dense_matrix({{0.0, 1.0}, {1.0, 0.0}}),
                               1,
                               {1.0 - eps[0], 1.0 - eps[1]},
                               {eps[0] * black[0], eps[1] * black[1]},
                               {}};
    const std::vector<double> radiosity = solve_radiosity(problem.view(), tight()).radiosity;
    const double flux = (black[0] - black[1]) / (1.0 / eps[0] + 1.0 / eps[1] - 1.0);
    CHECK(radiosity[0] - radiosity[1] == Approx(flux).epsilon(1e-11));
}

TEST_CASE("solve_radiosity: parallel plates under an open sky", "[solver]") {
    // Unit squares at unit distance: F = 0.19982 across, the rest is sky.
    const double f = static_cast<double>(0.19982F);
    const double sky = 1.0 - f;
    const double rho = 0.7;
    const double e[2] = {1.0, 0.0};
    const OwnedProblem problem{
        dense_matrix({{0.0, f}, {f, 0.0}}, {sky, sky}), 1, {rho, rho}, {e[0], e[1]}, {3.0}};
    const double source[2] = {e[0] + rho * sky * 3.0, e[1] + rho * sky * 3.0};
    const double determinant = 1.0 - rho * rho * f * f;
    const Solution solution = solve_radiosity(problem.view(), tight());
    CHECK(solution.radiosity[0] == Approx((source[0] + rho * f * source[1]) / determinant).epsilon(1e-12));
    CHECK(solution.radiosity[1] == Approx((source[1] + rho * f * source[0]) / determinant).epsilon(1e-12));

    const std::vector<double> arriving = irradiance(problem.view(), solution.radiosity);
    CHECK(arriving[0] == Approx(f * solution.radiosity[1] + sky * 3.0).epsilon(1e-14));
    CHECK(solution.radiosity[0] == Approx(e[0] + rho * arriving[0]).epsilon(1e-12));
}

TEST_CASE("solve_radiosity: who watches sees every sweep's radiosity, the last one's being the solution",
          "[solver]") {
    const OwnedProblem problem{dense_matrix({{0.0, 0.5}, {0.125, 0.0}}), 1, {0.8, 0.3}, {2.0, 7.0}, {}};
    for (const SolverMethod method : methods) {
        SolverSettings settings = tight(method);
        std::vector<std::vector<double>> seen;
        settings.watch = [&](std::uint32_t sweep, double residual, const auto& radiosity) {
            CHECK(sweep == seen.size() + 1);
            CHECK(residual >= 0.0);
            seen.push_back(radiosity());
            return true;
        };
        const Solution solution = solve_radiosity(problem.view(), settings);
        REQUIRE(seen.size() == solution.sweeps);
        CHECK(seen.back() == solution.radiosity);
        CHECK(seen[0][0] == Approx(2.0 + 0.8 * 0.5 * 7.0));
        CHECK(seen[0][1] == Approx(7.0 + 0.3 * 0.125 * (method == SolverMethod::jacobi ? 2.0 : seen[0][0])));
    }
    SolverSettings settings = tight();
    settings.watch = [](std::uint32_t, double, const auto&) -> bool { throw Cancelled(); };
    CHECK_THROWS_AS(solve_radiosity(problem.view(), settings), Cancelled);
}

TEST_CASE("solve_radiosity: agrees with Gaussian elimination", "[solver][accuracy]") {
    for (const std::uint32_t channels : {1u, 2u, 3u, 4u, 5u, 8u, 9u}) {
        for (const std::uint32_t size : {1u, 2u, 7u, 64u, 101u}) {
            const OwnedProblem problem = random_problem(size, channels, 100 * size + channels);
            const std::vector<double> exact = solve_dense(problem);
            for (const SolverMethod method : methods) {
                const Solution solution = solve_radiosity(problem.view(), tight(method));
                AccuracyRow("other limits", "solvers against Gaussian elimination")
                    .check_below("limit", "", largest_difference(solution.radiosity, exact), 1e-10);
                CHECK(solution.residual <= 1e-13);
            }
        }
    }
}

TEST_CASE("solve_radiosity: Gauss-Seidel needs about half the sweeps of Jacobi", "[solver]") {
    const OwnedProblem problem = random_problem(200, 3, 42, 0.99);
    const SolverSettings gauss_seidel{.tolerance = 1e-10};
    const SolverSettings jacobi{.method = SolverMethod::jacobi, .tolerance = 1e-10};
    const Solution one = solve_radiosity(problem.view(), gauss_seidel);
    const Solution other = solve_radiosity(problem.view(), jacobi);
    CHECK(largest_difference(one.radiosity, other.radiosity) < 1e-7);
    CHECK(one.sweeps < other.sweeps);
    CHECK(one.sweeps > other.sweeps / 4);
}

TEST_CASE("solve_radiosity: the residual is the one of its definition", "[solver]") {
    const OwnedProblem problem = random_problem(80, 3, 77);
    const Solution solution = solve_radiosity(problem.view(), {.tolerance = 1e-4});
    CHECK(solution.residual <= 1e-4);

    const std::vector<double> arriving = irradiance(problem.view(), solution.radiosity);
    double worst = 0.0;
    double dominance = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        double gap_squares = 0.0;
        double source_squares = 0.0;
        for (std::uint32_t i = 0; i < 80; ++i) {
            const std::size_t k = i * 3 + c;
            const double gap =
                problem.exitance[k] + problem.reflectance[k] * arriving[k] - solution.radiosity[k];
            const double source = problem.exitance[k] + problem.reflectance[k] *
                                                            problem.factors.row(i).environment *
                                                            problem.environment[c];
            gap_squares += gap * gap;
            source_squares += source * source;
            dominance = std::max(dominance, problem.reflectance[k] * problem.factors.row(i).sum());
        }
        worst = std::max(worst, std::sqrt(gap_squares / source_squares));
    }
    CHECK(solution.residual == Approx(worst).epsilon(1e-6));
    CHECK(solution.dominance == Approx(dominance));
}

TEST_CASE("solve_radiosity: a furnace glows at E / (1 - rho)", "[solver]") {
    // Rows of 16 equal entries sum to 1 without rounding.
    const DenseRows rows(16, std::vector<double>(16, 0.0625));
    for (const double rho : {0.0, 0.5, 0.9, 0.99}) {
        const OwnedProblem problem = uniform_problem(dense_matrix(rows), rho, 2.0);
        for (const SolverMethod method : methods) {
            const Solution solution = solve_radiosity(problem.view(), {.method = method});
            for (const double radiosity : solution.radiosity) {
                CHECK(radiosity == Approx(2.0 / (1.0 - rho)).epsilon(1e-6 / (1.0 - rho)));
            }
        }
    }

    const double rho = 0.9;
    const OwnedProblem random = uniform_problem(dense_matrix(random_rows(300, 1.0, 8)), rho, 2.0);
    for (const double radiosity : solve_radiosity(random.view(), tight()).radiosity) {
        CHECK(radiosity == Approx(20.0).epsilon(1e-6)); // entries are floats: 6e-8 / (1 - rho)
    }
}

TEST_CASE("solve_radiosity: an open furnace in an environment as bright as itself is uniform too",
          "[solver]") {
    // B = E / (1 - rho) everywhere, the environment included, satisfies every row: sum + e = 1.
    const DenseRows rows(8, std::vector<double>(8, 0.0625));
    OwnedProblem problem = uniform_problem(dense_matrix(rows, std::vector<double>(8, 0.5)), 0.75, 1.0);
    problem.environment = {4.0};
    for (const double radiosity : solve_radiosity(problem.view(), tight()).radiosity) {
        CHECK(radiosity == Approx(4.0).epsilon(1e-12));
    }
}

TEST_CASE("solve_radiosity: the environment enters by e, the blocked share is dark", "[solver]") {
    const FormFactorMatrix factors = dense_matrix({{0.0, 0.25}, {0.25, 0.0}}, {0.5, 0.0}, {0.25, 0.75});
    const OwnedProblem problem{factors, 2, {0.5, 0.5, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {8.0, 0.0}};
    const Solution solution = solve_radiosity(problem.view(), tight());
    CHECK(solution.radiosity == std::vector<double>{0.5 * 0.5 * 8.0, 1.0, 0.0, 0.0});
    CHECK(irradiance(problem.view(), solution.radiosity) ==
          std::vector<double>{0.5 * 8.0, 0.0, 0.25 * 2.0, 0.25});

    OwnedProblem dark = problem;
    dark.environment.clear();
    CHECK(solve_radiosity(dark.view(), tight()).radiosity == std::vector<double>{0.0, 1.0, 0.0, 0.0});
}

TEST_CASE("solve_radiosity: a patch that sees itself", "[solver]") {
    const OwnedProblem problem{dense_matrix({{0.75}}, {0.25}), 1, {0.8}, {1.0}, {}};
    for (const SolverMethod method : methods) {
        const Solution solution = solve_radiosity(problem.view(), tight(method));
        CHECK(solution.radiosity[0] == Approx(1.0 / (1.0 - 0.8 * 0.75)).epsilon(1e-14));
        CHECK(solution.sweeps <= 2);
    }
}

TEST_CASE("solve_radiosity: a scene without light is dark and has no residual", "[solver]") {
    OwnedProblem problem = random_problem(20, 3, 4);
    problem.environment.clear();
    std::fill(problem.exitance.begin(), problem.exitance.end(), 0.0);
    const Solution solution = solve_radiosity(problem.view());
    CHECK(solution.residual == 0.0);
    CHECK(largest_difference(solution.radiosity, problem.exitance) == 0.0);
}

TEST_CASE("solve_radiosity: a dark channel does not keep a lit one from converging", "[solver]") {
    OwnedProblem problem = random_problem(30, 2, 14);
    problem.environment = {0.0, 1.0};
    for (std::size_t k = 0; k < problem.exitance.size(); k += 2) {
        problem.exitance[k] = 0.0;
    }
    const Solution solution = solve_radiosity(problem.view(), tight());
    CHECK(solution.residual <= 1e-13);
    CHECK(solution.radiosity[0] == 0.0);
    CHECK(largest_difference(solution.radiosity, solve_dense(problem)) < 1e-10);
}

TEST_CASE("solve_radiosity: no patches have no radiosity", "[solver]") {
    const OwnedProblem problem{FormFactorMatrix(0), 3, {}, {}, {}};
    CHECK(solve_radiosity(problem.view()).radiosity.empty());
    CHECK(irradiance(problem.view(), {}).empty());
}

TEST_CASE("solve_radiosity: a grey channel equals each of three equal channels bit for bit", "[solver]") {
    const OwnedProblem grey = random_problem(150, 1, 5);
    for (const std::uint32_t channels : {2u, 3u, 4u, 7u}) {
        OwnedProblem colour{grey.factors, channels, {}, {}, {}};
        for (std::size_t i = 0; i < 150; ++i) {
            colour.reflectance.insert(colour.reflectance.end(), channels, grey.reflectance[i]);
            colour.exitance.insert(colour.exitance.end(), channels, grey.exitance[i]);
        }
        colour.environment.assign(channels, grey.environment[0]);
        for (const SolverMethod method : methods) {
            const Solution one = solve_radiosity(grey.view(), {.method = method});
            const Solution many = solve_radiosity(colour.view(), {.method = method});
            CHECK(one.sweeps == many.sweeps);
            CHECK(one.residual == many.residual);
            for (std::uint32_t c = 0; c < channels; ++c) {
                std::vector<double> channel;
                for (std::size_t i = 0; i < 150; ++i) {
                    channel.push_back(many.radiosity[i * channels + c]);
                }
                CHECK(same_bits(channel, one.radiosity));
            }
        }
    }
}

TEST_CASE("solve_radiosity: two runs give the same bytes", "[solver]") {
    const OwnedProblem problem = random_problem(120, 3, 15);
    for (const SolverMethod method : methods) {
        const Solution one = solve_radiosity(problem.view(), {.method = method});
        const Solution other = solve_radiosity(problem.view(), {.method = method});
        CHECK(same_bits(one.radiosity, other.radiosity));
        CHECK(one.residual == other.residual);
        CHECK(one.sweeps == other.sweeps);
    }
}

TEST_CASE("solve_radiosity: linear in the light, at any magnitude", "[solver]") {
    const OwnedProblem problem = random_problem(60, 1, 25);
    const Solution one = solve_radiosity(problem.view());
    for (const int exponent : {-700, -3, 800}) {
        OwnedProblem scaled = problem;
        for (double& value : scaled.exitance) {
            value = std::ldexp(value, exponent);
        }
        scaled.environment[0] = std::ldexp(scaled.environment[0], exponent);
        Solution other = solve_radiosity(scaled.view());
        for (double& value : other.radiosity) {
            value = std::ldexp(value, -exponent);
        }
        CHECK(same_bits(one.radiosity, other.radiosity));
        CHECK(one.sweeps == other.sweeps);
    }
}

TEST_CASE("solve_radiosity: unknown rows are allowed where nothing is reflected", "[solver]") {
    OwnedProblem problem = random_problem(70, 2, 35);
    const std::vector<std::uint32_t> unknown{0, 33, 69};
    for (const std::uint32_t i : unknown) {
        problem.reflectance[2 * i] = problem.reflectance[2 * i + 1] = 0.0;
    }
    const Solution all = solve_radiosity(problem.view());
    problem.factors = forget_rows(problem.factors, unknown);
    const Solution some = solve_radiosity(problem.view());
    CHECK(same_bits(all.radiosity, some.radiosity));

    const std::vector<double> arriving = irradiance(problem.view(), some.radiosity);
    for (const std::uint32_t i : unknown) {
        CHECK(some.radiosity[2 * i] == problem.exitance[2 * i]);
        CHECK(arriving[2 * i] == 0.0);
        CHECK(arriving[2 * i + 1] == 0.0);
    }

    problem.reflectance[2 * 33 + 1] = 0.25;
    CHECK_THROWS_AS(solve_radiosity(problem.view()), InvalidArgument);
    CHECK_THROWS_WITH(solve_radiosity(problem.view()), Catch::Contains("patch 33"));
}

TEST_CASE("solve_radiosity: refuses what does not fit or is out of range", "[solver]") {
    OwnedProblem problem = random_problem(10, 3, 45);
    SolverSettings settings;
    REQUIRE_NOTHROW(solve_radiosity(problem.view()));

    SECTION("too few reflectances") {
        problem.reflectance.pop_back();
    }
    SECTION("too many exitances") {
        problem.exitance.push_back(0.0);
    }
    SECTION("environment of another number of channels") {
        problem.environment.pop_back();
    }
    SECTION("no channels") {
        problem.channels = 0;
        problem.reflectance.clear();
        problem.exitance.clear();
        problem.environment.clear();
    }
    SECTION("reflectance 1") {
        problem.reflectance[4] = 1.0;
    }
    SECTION("negative reflectance") {
        problem.reflectance[4] = -0.1;
    }
    SECTION("reflectance that is not a number") {
        problem.reflectance[4] = std::numeric_limits<double>::quiet_NaN();
    }
    SECTION("negative exitance") {
        problem.exitance[4] = -1.0;
    }
    SECTION("infinite exitance") {
        problem.exitance[4] = std::numeric_limits<double>::infinity();
    }
    SECTION("negative environment") {
        problem.environment[1] = -1.0;
    }
    SECTION("infinite environment") {
        problem.environment[1] = std::numeric_limits<double>::infinity();
    }
    SECTION("tolerance 0") {
        settings.tolerance = 0.0;
    }
    SECTION("tolerance that is not a number") {
        settings.tolerance = std::numeric_limits<double>::quiet_NaN();
    }
    SECTION("a patch that reflects more than everything to itself") {
        problem = uniform_problem(dense_matrix({{2.0}}), 0.5, 1.0);
    }

    CHECK_THROWS_AS(solve_radiosity(problem.view(), settings), InvalidArgument);
}

TEST_CASE("solve_radiosity: needs form factors", "[solver]") {
    CHECK_THROWS_AS(solve_radiosity(RadiosityProblem{}), InvalidArgument);
}

TEST_CASE("irradiance: refuses radiosity of another size", "[solver]") {
    const OwnedProblem problem = random_problem(10, 3, 45);
    CHECK_THROWS_AS(irradiance(problem.view(), std::vector<double>(29)), InvalidArgument);
}

TEST_CASE("solve_radiosity: the error names patch, channel and value", "[solver]") {
    OwnedProblem problem = random_problem(10, 3, 45);
    problem.reflectance[3 * 7 + 2] = 1.5;
    CHECK_THROWS_WITH(solve_radiosity(problem.view()),
                      Catch::Contains("patch 7, channel 2: reflectance 1.5"));
}

TEST_CASE("solve_radiosity: says so when the sweeps allowed are too few", "[solver]") {
    const OwnedProblem problem = random_problem(50, 1, 55);
    for (const SolverMethod method : methods) {
        const std::string message =
            not_converged_message(problem, {.method = method, .tolerance = 1e-10, .max_sweeps = 3});
        CHECK_THAT(message, Catch::Contains(method == SolverMethod::jacobi ? "Jacobi" : "Gauss-Seidel"));
        CHECK_THAT(message, Catch::Contains("after 3 sweeps"));
        CHECK_THAT(message, Catch::Contains("tolerance 1e-10"));
    }
    not_converged_message(problem, {.max_sweeps = 0});
}

TEST_CASE("solve_radiosity: an impossible tolerance ends early", "[solver]") {
    for (const SolverMethod method : methods) {
        for (const std::uint64_t seed : {65u, 66u, 67u}) {
            const OwnedProblem problem = random_problem(50, 3, seed);
            std::uint32_t sweeps = 0;
            CHECK_THROWS_AS(
                solve_radiosity(problem.view(), {.method = method,
                                                 .tolerance = 1e-30,
                                                 .watch =
                                                     [&](std::uint32_t sweep, double, const auto&) {
                                                         sweeps = sweep;
                                                         return true;
                                                     }}),
                NotConverged);
            CHECK(sweeps < 1000);
        }
    }
}

TEST_CASE("solve_radiosity: foresees that the sweeps allowed are too few", "[solver]") {
    const OwnedProblem problem = uniform_problem(dense_matrix(random_rows(60, 1.0, 75)), 1.0 - 1e-7, 1.0);
    std::uint32_t sweeps = 0;
    std::string message;
    try {
        (void)solve_radiosity(problem.view(), {.watch = [&](std::uint32_t sweep, double, const auto&) {
                                  sweeps = sweep;
                                  return true;
                              }});
    } catch (const NotConverged& error) {
        message = error.what();
    }
    CHECK(sweeps < 1000);
    CHECK_THAT(message, Catch::Contains("sweeps would be needed and 100000 are allowed"));
}

TEST_CASE("solve_radiosity: slow convergence within the sweeps allowed is not given up", "[solver]") {
    // A corridor: every patch sees its two neighbours only, light comes from one end.
    const std::uint32_t size = 100;
    DenseRows rows(size, std::vector<double>(size, 0.0));
    for (std::uint32_t i = 0; i < size; ++i) {
        rows[i][i == 0 ? 0 : i - 1] += 0.5;
        rows[i][i + 1 == size ? i : i + 1] += 0.5;
    }
    OwnedProblem problem = uniform_problem(dense_matrix(rows), 0.9995, 0.0);
    problem.exitance[size - 1] = 1.0;
    const std::vector<double> exact = solve_dense(problem);
    for (const SolverMethod method : methods) {
        const Solution solution = solve_radiosity(problem.view(), {.method = method, .tolerance = 1e-8});
        CHECK(solution.sweeps > 1000);
        CHECK(largest_difference(solution.radiosity, exact) < 1e-3);
    }
}

TEST_CASE("solve_radiosity: rows that make energy end in an error that says so", "[solver]") {
    const OwnedProblem problem = uniform_problem(dense_matrix(random_rows(60, 1.25, 85)), 0.9, 1.0);
    for (const SolverMethod method : methods) {
        const std::string message = not_converged_message(problem, {.method = method});
        CHECK_THAT(message, Catch::Contains("row sum"));
        CHECK_THAT(message, Catch::Contains("1.125"));
    }

    const OwnedProblem violent = uniform_problem(dense_matrix({{0.0, 1e30}, {1e30, 0.0}}), 0.9, 1.0);
    CHECK_THAT(not_converged_message(violent, {}), Catch::Contains("finite"));
}

TEST_CASE("solve_radiosity: calls back after every sweep and can be cancelled", "[solver]") {
    const OwnedProblem problem = random_problem(50, 3, 95);
    std::vector<std::uint32_t> sweeps;
    std::vector<double> residuals;
    const Solution solution =
        solve_radiosity(problem.view(), {.watch = [&](std::uint32_t sweep, double residual, const auto&) {
                            sweeps.push_back(sweep);
                            residuals.push_back(residual);
                            return true;
                        }});
    REQUIRE(sweeps.size() == solution.sweeps);
    for (std::size_t k = 0; k < sweeps.size(); ++k) {
        CHECK(sweeps[k] == k + 1);
    }
    CHECK(residuals.back() < residuals.front());

    std::uint32_t last = 0;
    CHECK_THROWS_AS(solve_radiosity(problem.view(), {.watch =
                                                         [&](std::uint32_t sweep, double, const auto&) {
                                                             last = sweep;
                                                             return sweep < 3;
                                                         }}),
                    Cancelled);
    CHECK(last == 3);
}

TEST_CASE("solve_radiosity: sweeps that begin at the solution end at once, and dark channels stay dark",
          "[solver]") {
    const OwnedProblem owned = random_problem(30, 2, 5);
    RadiosityProblem problem = owned.view();
    const SolverSettings cold{.method = SolverMethod::gauss_seidel, .tolerance = 1e-9};
    const Solution first = solve_radiosity(problem, cold);
    SolverSettings warm = cold;
    warm.start = first.radiosity;
    const Solution again = solve_radiosity(problem, warm);
    CHECK(again.sweeps <= 2);
    CHECK(first.sweeps > 5);
    CHECK(largest_difference(again.radiosity, first.radiosity) < 1e-7);
    std::vector<double> exitance = owned.exitance;
    std::vector<double> environment = owned.environment;
    for (std::size_t k = 1; k < exitance.size(); k += 2) {
        exitance[k] = 0.0;
    }
    environment[1] = 0.0;
    problem.exitance = exitance;
    problem.environment = environment;
    const Solution dark = solve_radiosity(problem, warm);
    for (std::size_t k = 1; k < dark.radiosity.size(); k += 2) {
        CHECK(dark.radiosity[k] == 0.0);
    }
    warm.start = std::span(first.radiosity).first(59);
    CHECK_THROWS_AS(solve_radiosity(problem, warm), InvalidArgument);
}
