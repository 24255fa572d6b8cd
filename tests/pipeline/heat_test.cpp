#include "hemi/pipeline/heat.hpp"

#include "hemi/core/black_body.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <initializer_list>
#include <numeric>

using namespace hemi;
using Catch::Contains;

namespace {

double power_of(double kelvin) {
    return black_body_exitance(kelvin);
}

HeatCondition at(double kelvin) {
    HeatCondition condition;
    condition.temperature = kelvin;
    return condition;
}

HeatCondition with_flux(double flux) {
    HeatCondition condition;
    condition.heat_flux = flux;
    return condition;
}

/// Patches that are groups of their own, by a dense F; what rows lack is the environment's or the backs'.
FormFactors make_factors(const std::vector<std::vector<double>>& rows, std::vector<double> areas,
                         std::vector<std::string> groups, const std::vector<double>& blocked = {}) {
    FormFactors factors;
    const auto size = static_cast<std::uint32_t>(rows.size());
    factors.matrix = FormFactorMatrix(size);
    RowBlock block;
    block.begin = {0};
    bool open = false;
    for (std::uint32_t i = 0; i < size; ++i) {
        double sum = 0.0;
        for (std::uint32_t j = 0; j < size; ++j) {
            if (rows[i][j] > 0.0) {
                block.columns.push_back(j);
                block.values.push_back(static_cast<float>(rows[i][j]));
                sum += rows[i][j];
            }
        }
        block.begin.push_back(block.columns.size());
        block.blocked.push_back(blocked.empty() ? 0.0 : blocked[i]);
        const double rest = 1.0 - sum - block.blocked.back();
        block.environment.push_back(rest > 1e-9 ? rest : 0.0);
        open = open || rest > 1e-9;
        block.known.push_back(1);
    }
    factors.matrix.set_block(std::move(block));
    factors.areas = std::move(areas);
    factors.groups = std::move(groups);
    factors.group_of.resize(size);
    std::iota(factors.group_of.begin(), factors.group_of.end(), 0u);
    factors.enclosure = open ? Enclosure::open : Enclosure::closed;
    return factors;
}

/// Patch i has emissivity eps[i] and condition i.
HeatProblem grey(std::vector<double> eps, std::vector<HeatCondition> conditions) {
    HeatProblem problem;
    problem.exitance.assign(eps.size(), 0.0);
    problem.table_of.assign(eps.size(), no_heat);
    problem.condition_of.resize(eps.size());
    std::iota(problem.condition_of.begin(), problem.condition_of.end(), 0u);
    problem.emissivity = std::move(eps);
    problem.conditions = std::move(conditions);
    return problem;
}

/// The same in several bands.
HeatProblem banded(const HeatProblem& grey, std::vector<double> limits,
                   const std::vector<std::vector<double>>& eps) {
    HeatProblem problem = grey;
    problem.band_limits = std::move(limits);
    problem.bands = static_cast<std::uint32_t>(problem.band_limits.size()) + 1;
    problem.emissivity.clear();
    for (const std::vector<double>& of_patch : eps) {
        problem.emissivity.insert(problem.emissivity.end(), of_patch.begin(), of_patch.end());
    }
    problem.exitance.assign(problem.emissivity.size(), 0.0);
    return problem;
}

/// A duct that is 1 wide and 2 high, by crossed strings: bottom, right, top, left.
FormFactors duct() {
    const double ends = std::sqrt(5.0) - 2.0;
    const double sides = (std::sqrt(5.0) - 1.0) / 2.0;
    const double to_side = (1.0 - ends) / 2.0;
    const double to_end = (1.0 - sides) / 2.0;
    return make_factors({{0.0, to_side, ends, to_side},
                         {to_end, 0.0, to_end, sides},
                         {ends, to_side, 0.0, to_side},
                         {to_end, sides, to_end, 0.0}},
                        {1.0, 2.0, 1.0, 2.0}, {"bottom", "right", "top", "left"});
}

/// Rows of three patches that lack a little, of which the third is buried.
FormFactors with_buried() {
    return make_factors({{0.0, 0.75, 0.0}, {0.75, 0.0, 0.0}, {0.0, 0.0, 0.0}}, {1.0, 1.0, 1.0},
                        {"hot", "cold", "under"}, {0.0, 0.0, 1.0});
}

FormFactors plates() {
    return make_factors({{0.0, 1.0}, {1.0, 0.0}}, {1.0, 1.0}, {"hot", "cold"});
}

} // namespace

TEST_CASE("heat: MOOSE's grey cavity with adiabatic sides", "[heat]") {
    const FormFactors factors = duct();
    const HeatProblem problem =
        grey({1.0, 0.3, 0.75, 0.9}, {at(550.0), with_flux(0.0), at(300.0), with_flux(0.0)});
    const HeatSolution solution = solve_heat(factors, problem);
    // Factors are floats: 3e-8 of a factor.
    CHECK(solution.net_flux[0] == Approx(2423.657817).epsilon(1e-7));
    CHECK(solution.radiosity[2] == Approx(1267.186267).epsilon(1e-7));
    CHECK(solution.temperature[1] == Approx(488.460360).epsilon(1e-8));
    CHECK(solution.temperature[3] == Approx(488.460360).epsilon(1e-8));
    CHECK(solution.net_flux[1] == 0.0);
    CHECK(solution.relative_balance < 1e-10);
    CHECK(solution.residual < 1e-11);
    // Of reflectance 1 they are as hot.
    HeatProblem mirrors = problem;
    mirrors.emissivity = {1.0, 0.0, 0.75, 0.0};
    mirrors.condition_of = {0, no_heat, 2, no_heat};
    const HeatSolution reflected = solve_heat(factors, mirrors);
    CHECK(reflected.temperature[1] == Approx(solution.temperature[1]).epsilon(1e-10));
    CHECK(reflected.net_flux[0] == Approx(solution.net_flux[0]).epsilon(1e-9));
}

TEST_CASE("heat: plates, spheres, a shield", "[heat]") {
    const double driving = power_of(800.0) - power_of(300.0);
    const double resistance = 1.0 / 0.8 + 1.0 / 0.3 - 1.0;
    const HeatSolution solution = solve_heat(plates(), grey({0.8, 0.3}, {at(800.0), at(300.0)}));
    CHECK(solution.net_flux[0] == Approx(driving / resistance).epsilon(1e-11));
    CHECK(solution.net_flux[1] == Approx(-driving / resistance).epsilon(1e-11));

    const FormFactors spheres = make_factors({{0.0, 1.0}, {0.25, 0.75}}, {1.0, 4.0}, {"inner", "outer"});
    const HeatSolution between = solve_heat(spheres, grey({0.6, 0.2}, {at(800.0), at(300.0)}));
    CHECK(between.net_flux[0] == Approx(driving / (1.0 / 0.6 + 0.25 * (1.0 / 0.2 - 1.0))).epsilon(1e-11));

    // Long coaxial cylinders, the outer one twice as wide; per length as spheres, by the ratio of the radii.
    const FormFactors cylinders = make_factors({{0.0, 1.0}, {0.5, 0.5}}, {1.0, 2.0}, {"inner", "outer"});
    const HeatSolution coaxial = solve_heat(cylinders, grey({0.6, 0.2}, {at(800.0), at(300.0)}));
    CHECK(coaxial.net_flux[0] == Approx(driving / (1.0 / 0.6 + 0.5 * (1.0 / 0.2 - 1.0))).epsilon(1e-11));
    CHECK(coaxial.net_flux[1] == Approx(-0.5 * coaxial.net_flux[0]).epsilon(1e-11));

    // Both sides of the shield have one temperature, and no net power together.
    FormFactors shielded = make_factors({{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 1}, {0, 0, 1, 0}},
                                        {1, 1, 1, 1}, {"hot", "shield", "back of the shield", "cold"});
    HeatProblem problem = grey({0.8, 0.1, 0.1, 0.3}, {at(800.0), with_flux(0.0), {}, at(300.0)});
    problem.conditions[1].isothermal = true;
    problem.condition_of = {0, 1, 1, 3};
    const HeatSolution shield = solve_heat(shielded, problem);
    CHECK(shield.net_flux[0] == Approx(driving / (resistance + 2.0 / 0.1 - 1.0)).epsilon(1e-8));
    CHECK(shield.temperature[1] == shield.temperature[2]);
    CHECK(shield.net_flux[1] == Approx(-shield.net_flux[0]).epsilon(1e-8));
    CHECK(shield.relative_balance < 1e-8);
    // One that takes nothing in does not tell the other side of the hot one.
    problem.emissivity = {0.8, 0.0, 0.0, 0.3};
    problem.conditions[3] = with_flux(0.0);
    CHECK_THROWS_WITH(solve_heat(shielded, problem), Contains("cold") && Contains("any temperature"));
}

TEST_CASE("heat: a given flux makes the temperature that makes the flux", "[heat]") {
    const FormFactors factors = duct();
    HeatProblem problem = grey({0.9, 0.3, 0.75, 0.5}, {with_flux(5000.0), at(400.0), {}, with_flux(-800.0)});
    problem.conditions[2].power = 700.0; // an area of 1 m²
    const HeatSolution by_flux = solve_heat(factors, problem);
    CHECK(by_flux.net_flux[0] == 5000.0);
    CHECK(by_flux.net_flux[2] == 700.0);
    HeatProblem back = problem;
    for (std::size_t i = 0; i < 4; ++i) {
        back.conditions[i] = at(by_flux.temperature[i]);
    }
    const HeatSolution by_temperature = solve_heat(factors, back);
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(by_temperature.net_flux[i] == Approx(by_flux.net_flux[i]).epsilon(1e-9));
    }
    CHECK(by_flux.relative_balance < 1e-10);
    // The power is of the area in m².
    problem.unit = 0.1;
    problem.conditions[2].power = 7.0;
    CHECK(solve_heat(factors, problem).net_flux[2] == Approx(700.0));
}

TEST_CASE("heat: exitance adds to what the temperature makes", "[heat]") {
    HeatProblem problem = grey({0.8, 0.3}, {at(800.0), at(300.0)});
    problem.exitance = {100.0, 0.0};
    const HeatSolution solution = solve_heat(plates(), problem);
    CHECK(solution.emitted[0] == Approx(0.8 * power_of(800.0) + 100.0));
    // The same as a black body that is so much brighter.
    const double bright = power_of(800.0) + 100.0 / 0.8;
    CHECK(solution.net_flux[0] ==
          Approx((bright - power_of(300.0)) / (1.0 / 0.8 + 1.0 / 0.3 - 1.0)).epsilon(1e-11));
}

TEST_CASE("heat: bands are as many grey problems where temperatures are given", "[heat]") {
    const FormFactors factors = duct();
    const std::vector<double> limits{2.5, 6.0};
    const std::vector<std::vector<double>> eps{
        {0.9, 0.7, 0.2}, {0.3, 0.5, 0.8}, {0.75, 0.6, 1.0}, {0.4, 0.4, 0.1}};
    const HeatProblem one = grey({0.5, 0.5, 0.5, 0.5}, {at(1500.0), at(700.0), at(300.0), at(900.0)});
    const HeatProblem problem = banded(one, limits, eps);
    const HeatSolution all = solve_heat(factors, problem);
    for (std::size_t k = 0; k < 3; ++k) {
        HeatProblem single = grey({eps[0][k], eps[1][k], eps[2][k], eps[3][k]}, {});
        single.condition_of.assign(4, no_heat);
        for (std::size_t i = 0; i < 4; ++i) {
            const double kelvin = *one.conditions[i].temperature;
            single.exitance[i] = eps[i][k] * band_fractions(kelvin, limits)[k] * power_of(kelvin);
        }
        const HeatSolution solution = solve_heat(factors, single);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(all.radiosity[i * 3 + k] == Approx(solution.radiosity[i]).epsilon(1e-10));
            CHECK(all.irradiation[i * 3 + k] == Approx(solution.irradiation[i]).epsilon(1e-10));
        }
    }
    CHECK(all.outer == 0);
    CHECK(all.relative_balance < 1e-10);
}

TEST_CASE("heat: bands with fluxes, found by outer iterations", "[heat]") {
    const FormFactors factors = duct();
    const HeatProblem one =
        grey({0.9, 0.3, 0.75, 0.5}, {at(1500.0), with_flux(0.0), at(300.0), with_flux(-2000.0)});
    const std::vector<double> limits{2.5, 6.0};
    SECTION("equal in all bands they are grey") {
        const HeatProblem problem =
            banded(one, limits, {{0.9, 0.9, 0.9}, {0.3, 0.3, 0.3}, {0.75, 0.75, 0.75}, {0.5, 0.5, 0.5}});
        const HeatSolution bands = solve_heat(factors, problem);
        const HeatSolution simple = solve_heat(factors, one);
        CHECK(bands.outer > 1);
        CHECK(bands.outer_change <= 1e-10);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(bands.temperature[i] == Approx(simple.temperature[i]).epsilon(1e-8));
        }
    }
    SECTION("different ones") {
        const HeatProblem problem =
            banded(one, limits, {{0.9, 0.7, 0.2}, {0.3, 0.5, 0.8}, {0.75, 0.6, 1.0}, {0.4, 0.4, 0.1}});
        const HeatSolution bands = solve_heat(factors, problem);
        CHECK(bands.net_flux[1] == Approx(0.0).margin(1e-4));
        CHECK(bands.net_flux[3] == Approx(-2000.0).epsilon(1e-7));
        CHECK(bands.relative_balance < 1e-8);
        HeatProblem back = problem;
        for (std::size_t i = 0; i < 4; ++i) {
            back.conditions[i] = at(bands.temperature[i]);
        }
        CHECK(solve_heat(factors, back).net_flux[0] == Approx(bands.net_flux[0]).epsilon(1e-8));
    }
}

TEST_CASE("heat: emissivity by temperature", "[heat]") {
    HeatProblem problem = grey({0.5, 0.3}, {at(800.0), at(300.0)});
    problem.tables = {{{300.0, 0.4}, {1300.0, 0.9}}};
    problem.table_of = {0, no_heat};
    const HeatSolution solution = solve_heat(plates(), problem);
    const double flux = (power_of(800.0) - power_of(300.0)) / (1.0 / 0.65 + 1.0 / 0.3 - 1.0);
    CHECK(solution.net_flux[0] == Approx(flux).epsilon(1e-11));
    // The other way round: the flux is given, and the temperature follows.
    problem.conditions[0] = with_flux(flux);
    CHECK(solve_heat(plates(), problem).temperature[0] == Approx(800.0).epsilon(1e-9));
    problem.conditions[0].isothermal = true;
    CHECK(solve_heat(plates(), problem).temperature[0] == Approx(800.0).epsilon(1e-8));
}

TEST_CASE("heat: perfect reflectors are as hot as what they see", "[heat]") {
    const FormFactors factors = duct();
    HeatProblem mirrors = grey({1.0, 0.0, 0.75, 0.0}, {at(550.0), with_flux(0.0), at(300.0), with_flux(0.0)});
    const HeatSolution simple = solve_heat(factors, mirrors);
    CHECK(simple.temperature[1] == Approx(488.460360).epsilon(1e-8));
    mirrors.conditions[1].isothermal = true;
    CHECK(solve_heat(factors, mirrors).temperature[1] == Approx(simple.temperature[1]).epsilon(1e-10));
    const std::vector<std::vector<double>> eps{{1.0, 1.0}, {0.0, 0.0}, {0.75, 0.75}, {0.0, 0.0}};
    HeatProblem bands = banded(mirrors, {6.0}, eps);
    CHECK(solve_heat(factors, bands).temperature[1] == Approx(simple.temperature[1]).epsilon(1e-10));
    bands.conditions[1].isothermal = false;
    CHECK(solve_heat(factors, bands).temperature[3] == Approx(simple.temperature[3]).epsilon(1e-10));
    // They can have no flux but their exitance.
    for (HeatProblem problem : {mirrors, bands}) {
        *problem.conditions[1].heat_flux = 100.0;
        CHECK_THROWS_WITH(solve_heat(factors, problem), Contains("group right") && Contains("emissivity"));
        problem.exitance[problem.bands] = 100.0;
        CHECK(solve_heat(factors, problem).net_flux[1] == Approx(100.0).epsilon(1e-12));
    }
    // Both walls of one temperature: the mean of what they get.
    HeatProblem joined = mirrors;
    joined.condition_of[3] = 1;
    const HeatSolution together = solve_heat(factors, joined);
    CHECK(together.temperature[3] == together.temperature[1]);
    CHECK(together.temperature[1] == Approx(simple.temperature[1]).epsilon(1e-8));
    // In one band a flux is a source, whatever the emissivity; of the temperature it tells nothing then.
    mirrors.conditions[1] = with_flux(100.0);
    CHECK(std::isnan(solve_heat(factors, mirrors).temperature[1]));
}

TEST_CASE("heat: an environment, and none", "[heat]") {
    const FormFactors factors = make_factors({{0.0, 0.4}, {0.4, 0.0}}, {1.0, 1.0}, {"floor", "ceiling"});
    HeatProblem problem = grey({0.9, 0.6}, {at(320.0), with_flux(0.0)});
    problem.environment_temperature = 320.0;
    const HeatSolution equal = solve_heat(factors, problem);
    CHECK(equal.net_flux[0] == Approx(0.0).margin(1e-9)); // all of one temperature
    CHECK(equal.temperature[1] == Approx(320.0).epsilon(1e-12));
    CHECK(equal.relative_balance < 1e-7);
    problem.environment_temperature.reset();
    struct Warnings : Observer {
        std::vector<std::string> all;
        void warning(std::string_view message, std::string_view) override { all.emplace_back(message); }
    } warnings;
    const HeatSolution dark = solve_heat(factors, problem, {}, warnings);
    REQUIRE(warnings.all.size() == 1);
    CHECK_THAT(warnings.all[0], Contains("0 K"));
    CHECK(dark.environment_power < 0.0);
    CHECK(dark.net_flux[0] == Approx(-dark.environment_power).epsilon(1e-9));
    // A series says nothing of it again, line by line.
    problem.tables = {{{300.0, 0.4}, {1300.0, 0.9}}};
    problem.table_of[0] = 0;
    CHECK_FALSE(
        solve_heat_series(factors, problem, {{"floor"}, {300.0, 400.0}, {}}, {}, warnings).superposed);
    CHECK(warnings.all.size() == 1);
    // Nothing sees it in a closed scene.
    HeatProblem closed = grey({0.8, 0.3}, {at(800.0), at(300.0)});
    closed.environment_temperature = 280.0;
    CHECK(solve_heat(plates(), closed, {}, warnings).environment_power == 0.0);
    REQUIRE(warnings.all.size() == 2);
    CHECK_THAT(warnings.all[1], Contains("280 K") && Contains("no surface sees"));
}

TEST_CASE("heat: buried patches have no flux and are left out of means", "[heat]") {
    FormFactors factors = make_factors({{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, {1.0, 1.0, 0.5},
                                       {"hot", "cold"}, {0.0, 0.0, 1.0});
    factors.group_of = {0, 1, 0};
    HeatProblem problem = grey({0.8, 0.3, 0.8}, {at(800.0), at(300.0)});
    problem.condition_of = {0, 1, 0};
    const HeatSolution solution = solve_heat(factors, problem);
    CHECK(solution.buried == std::vector<std::uint8_t>{0, 0, 1});
    CHECK(solution.net_flux[2] == 0.0);
    CHECK(solution.relative_balance < 1e-10);
    const std::vector<GroupHeat> groups = group_heat(factors, problem, solution);
    REQUIRE(groups.size() == 3);
    CHECK(groups[0].area == 1.5);
    CHECK(groups[0].net_flux == Approx(solution.net_flux[0]));
    CHECK(groups[0].net_power == Approx(solution.net_flux[0]));
    CHECK(groups[0].temperature == Approx(800.0));
    CHECK(groups[2].net_power == Approx(0.0).margin(1e-6));
    CHECK(solution.radiosity[2] == Approx(power_of(800.0))); // as in a cavity
    // A power is that of the patches that can get rid of it.
    problem.conditions[0] = {};
    problem.conditions[0].power = 1000.0;
    const HeatSolution powered = solve_heat(factors, problem);
    CHECK(powered.net_flux[0] == 1000.0);
    // Nothing tells what is in between there.
    for (const auto* values : {&powered.temperature, &powered.radiosity, &powered.irradiation,
                               &powered.emitted, &powered.absorbed}) {
        CHECK(std::isnan((*values)[2]));
        CHECK(std::isfinite((*values)[0]));
    }
    CHECK(powered.relative_balance < 1e-10);
    // Of a group that is all buried, what it is made of is known; a power cannot leave it.
    factors.groups = {"hot", "cold", "under"};
    factors.group_of = {0, 1, 2};
    problem.emissivity[2] = 0.7;
    problem.conditions = {at(800.0), at(300.0), with_flux(0.0)};
    problem.condition_of = {0, 1, 2};
    const auto under = [&] { return group_heat(factors, problem, solve_heat(factors, problem))[2]; };
    CHECK(under().emissivity == Approx(0.7));
    CHECK(std::isnan(under().radiosity));
    CHECK(std::isnan(under().temperature));
    CHECK(under().net_power == 0.0);
    problem.conditions[2].isothermal = true;
    CHECK(std::isnan(under().temperature));
    problem.conditions[2] = {};
    problem.conditions[2].power = 5.0;
    CHECK_THROWS_WITH(under(), Contains("group under") && Contains("5 W") && Contains("buried"));
    problem.conditions[2].power = 0.0;
    CHECK(under().net_power == 0.0);
}

TEST_CASE("heat: what has no solution is refused by name", "[heat]") {
    const FormFactors factors = duct();
    CHECK_THROWS_WITH(solve_heat(factors, grey({0.9, 0.9, 0.9, 0.9}, {with_flux(10.0), with_flux(0.0),
                                                                      with_flux(0.0), with_flux(0.0)})),
                      Contains("bottom") && Contains("left") && Contains("no solution"));
    CHECK_THROWS_WITH(solve_heat(factors, grey({0.9, 0.9, 0.9, 0.9}, {with_flux(10.0), with_flux(0.0),
                                                                      with_flux(-10.0), with_flux(0.0)})),
                      Contains("any temperature"));
    CHECK_THROWS_WITH(solve_heat(factors, grey({0.9, 0.9, 0.9, 0.9},
                                               {at(300.0), at(300.0), at(300.0), with_flux(-5000.0)})),
                      Contains("left") && Contains("below 0 K"));
    // One enclosure has a temperature, the other has none.
    const FormFactors two = make_factors({{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 1}, {0, 0, 1, 0}},
                                         {1, 1, 1, 1}, {"a", "b", "c", "d"});
    CHECK_THROWS_WITH(solve_heat(two, grey({0.9, 0.9, 0.9, 0.9},
                                           {at(300.0), with_flux(0.0), with_flux(1.0), with_flux(0.0)})),
                      Contains("c, d"));
    // What a lamp that absorbs nothing gives must go somewhere, too.
    HeatProblem lamp = grey({0.0, 0.9, 0.9, 0.9}, {with_flux(0.0)});
    lamp.exitance[0] = 100.0;
    lamp.condition_of = {no_heat, 0, 0, 0};
    CHECK_THROWS_WITH(solve_heat(factors, lamp), Contains("100 W") && Contains("no solution"));
    FormFactors lopsided = plates();
    lopsided.areas = {1.0, 2.0};
    CHECK_THROWS_AS(solve_heat(lopsided, grey({0.8, 0.3}, {at(800.0), at(300.0)})), InvalidArgument);
}

TEST_CASE("heat: a series is as many single runs", "[heat]") {
    const FormFactors factors = make_factors(
        {{0.0, 0.3, 0.2, 0.3}, {0.15, 0.0, 0.15, 0.5}, {0.2, 0.3, 0.0, 0.3}, {0.15, 0.5, 0.15, 0.0}},
        {1.0, 2.0, 1.0, 2.0}, {"bottom", "right", "top", "left"});
    HeatProblem problem = grey({0.9, 0.3, 0.75, 0.5}, {at(1500.0), with_flux(0.0), at(300.0), {}});
    problem.conditions[3].power = 100.0;
    problem.exitance = {5.0, 0.0, 0.0, 0.0};
    problem.environment_temperature = 280.0;
    HeatSchedule schedule;
    schedule.columns = {"top", "left", "environment"};
    schedule.values = {300.0, 100.0, 280.0, 500.0, -250.0, 20.0, 0.0, 1000.0, 300.0};
    const auto check = [&](bool superposed, double accuracy) {
        const HeatSeries series = solve_heat_series(factors, problem, schedule);
        CHECK(series.superposed == superposed);
        REQUIRE(series.net_flux.size() == 12);
        for (std::size_t l = 0; l < 3; ++l) {
            HeatProblem single = problem;
            single.conditions[2] = at(schedule.values[l * 3]);
            if (problem.conditions[3].power) {
                single.conditions[3].power = schedule.values[l * 3 + 1];
            }
            single.environment_temperature = schedule.values[l * 3 + 2];
            const HeatSolution solution = solve_heat(factors, single);
            const std::vector<GroupHeat> groups = group_heat(factors, single, solution);
            for (std::size_t g = 0; g < 4; ++g) {
                CHECK(series.temperature[l * 4 + g] == Approx(groups[g].temperature).epsilon(accuracy));
                CHECK(series.net_flux[l * 4 + g] ==
                      Approx(groups[g].net_flux).epsilon(accuracy).margin(1e-6));
                CHECK(series.net_power[l * 4 + g] ==
                      Approx(groups[g].net_power).epsilon(accuracy).margin(1e-6));
            }
            CHECK(series.environment_power[l] == Approx(solution.environment_power).epsilon(accuracy));
        }
    };
    SECTION("by superposition") {
        check(true, 1e-9);
    }
    SECTION("by superposition, with perfect reflectors") {
        problem.emissivity[1] = 0.0;
        check(true, 1e-9);
        problem.condition_of[1] = no_heat;
        check(true, 1e-9);
    }
    SECTION("a flux that needs less than 0 K is refused with line, group and patch") {
        schedule.values[4] = -1e5;
        CHECK_THROWS_WITH(solve_heat_series(factors, problem, schedule),
                          Contains("line 2") && Contains("group left") && Contains("0 K"));
        problem.conditions[3].isothermal = true; // line by line
        CHECK_THROWS_WITH(solve_heat_series(factors, problem, schedule),
                          Contains("line 2") && Contains("group left") && Contains("0 K"));
        schedule.values[4] = -250.0;
        HeatSettings few;
        few.max_outer = 0;
        CHECK_THROWS_WITH(solve_heat_series(factors, problem, schedule, few), Contains("line 1"));
    }
    SECTION("a schedule is looked through before the work") {
        CHECK(check_heat_schedule(factors.groups, factors.group_of, problem, schedule) ==
              std::vector<HeatQuantity>{HeatQuantity::temperature, HeatQuantity::power,
                                        HeatQuantity::temperature});
        schedule.columns[1] = "top";
        CHECK_THROWS_WITH(check_heat_schedule(factors.groups, factors.group_of, problem, schedule),
                          Contains("two columns \"top\""));
    }
    SECTION("line by line, where emissivities depend on temperatures") {
        problem.tables = {{{300.0, 0.4}, {1300.0, 0.9}}};
        problem.table_of[2] = 0;
        check(false, 1e-12);
    }
    SECTION("a column stands for all conditions of its group, and makes one where there is none") {
        FormFactors joined = factors;
        joined.groups = {"bottom", "right", "walls"};
        joined.group_of = {0, 1, 2, 2};
        HeatProblem several = problem;
        several.conditions[3] = at(900.0); // beside the 300 K of the other one
        several.condition_of[1] = no_heat;
        const HeatSeries series =
            solve_heat_series(joined, several, {{"walls", "right"}, {500.0, 350.0}, {}});
        HeatProblem single = problem;
        single.conditions = {at(1500.0), at(350.0), at(500.0), at(500.0)};
        const HeatSolution solution = solve_heat(joined, single);
        const std::vector<GroupHeat> groups = group_heat(joined, single, solution);
        for (std::size_t g = 0; g < 3; ++g) {
            CHECK(series.net_power[g] == Approx(groups[g].net_power).epsilon(1e-9));
        }
        several.conditions[3] = with_flux(0.0);
        CHECK_THROWS_WITH(solve_heat_series(joined, several, {{"walls"}, {500.0}, {}}),
                          Contains("walls") && Contains("several kinds"));
        several.condition_of[3] = no_heat;
        CHECK_THROWS_WITH(solve_heat_series(joined, several, {{"walls"}, {500.0}, {}}),
                          Contains("parts without"));
    }
    SECTION("unknown groups are refused with the nearest") {
        schedule.columns[0] = "topp";
        CHECK_THROWS_WITH(solve_heat_series(factors, problem, schedule), Contains("\"top\""));
    }
    SECTION("temperatures below 0 K are refused with their place") {
        schedule.values[3] = -1.0;
        CHECK_THROWS_WITH(solve_heat_series(factors, problem, schedule),
                          Contains("line 2") && Contains("top"));
    }
}

TEST_CASE("heat: a series in bands by superposition", "[heat]") {
    const FormFactors factors = duct();
    const HeatProblem problem =
        banded(grey({0.5, 0.5, 0.5, 0.5}, {at(1500.0), at(700.0), at(300.0), at(900.0)}), {2.5, 6.0},
               {{0.9, 0.7, 0.2}, {0.3, 0.5, 0.8}, {0.75, 0.6, 1.0}, {0.4, 0.4, 0.1}});
    const HeatSchedule schedule{{"right"}, {700.0, 1200.0}, {}};
    const HeatSeries series = solve_heat_series(factors, problem, schedule);
    CHECK(series.superposed);
    HeatProblem later = problem;
    later.conditions[1] = at(1200.0);
    const HeatSolution first = solve_heat(factors, problem);
    const HeatSolution second = solve_heat(factors, later);
    for (std::size_t g = 0; g < 4; ++g) {
        CHECK(series.net_flux[g] == Approx(first.net_flux[g]).epsilon(1e-9));
        CHECK(series.net_flux[4 + g] == Approx(second.net_flux[g]).epsilon(1e-9));
    }
}

TEST_CASE("exchange: reciprocal, balanced, and what the fluxes are made of", "[heat]") {
    const FormFactors factors = make_factors(
        {{0.0, 0.3, 0.2, 0.3}, {0.15, 0.0, 0.15, 0.5}, {0.2, 0.3, 0.0, 0.3}, {0.15, 0.5, 0.15, 0.0}},
        {1.0, 2.0, 1.0, 2.0}, {"bottom", "right", "top", "left"});
    HeatProblem problem = grey({0.9, 0.02, 0.75, 0.0}, {at(1500.0), at(500.0), at(300.0), with_flux(0.0)});
    problem.environment_temperature = 250.0;
    problem.unit = 0.5;
    const HeatExchange exchange = heat_exchange(factors, problem);
    const HeatSolution solution = solve_heat(factors, problem);
    CHECK(exchange.areas == std::vector<double>{0.25, 0.5, 0.25, 0.5});
    const std::vector<double> powers{power_of(1500.0), power_of(500.0), power_of(300.0), 0.0};
    for (std::size_t g = 0; g < 4; ++g) {
        double sum = exchange.environment[g];
        double net = exchange.areas[g] * exchange.environment[g] * (powers[g] - power_of(250.0));
        for (std::size_t h = 0; h < 4; ++h) {
            sum += exchange.script_f[g * 4 + h];
            CHECK(exchange.conductance[g * 4 + h] == exchange.conductance[h * 4 + g]);
            net += exchange.conductance[g * 4 + h] * (powers[g] - powers[h]);
        }
        CHECK(sum == Approx(exchange.emissivity[g]).epsilon(1e-9).margin(1e-15));
        CHECK(net == Approx(exchange.areas[g] * solution.net_flux[g]).epsilon(1e-8).margin(1e-9));
        CHECK(exchange.gebhart[g * 4] * exchange.emissivity[g] == Approx(exchange.script_f[g * 4]));
    }
    CHECK(exchange.script_f[3] == 0.0); // nothing is absorbed on the left
    // Two plates: 1 / (1/eps + 1/eps - 1).
    const HeatExchange two = heat_exchange(plates(), grey({0.8, 0.3}, {}));
    CHECK(two.script_f[1] == Approx(1.0 / (1.0 / 0.8 + 1.0 / 0.3 - 1.0)).epsilon(1e-11));
    CHECK_THROWS_AS(
        heat_exchange(duct(), banded(problem, {3.0}, {{0.9, 0.9}, {0.5, 0.5}, {0.5, 0.5}, {0.5, 0.5}})),
        InputError);
}

TEST_CASE("heat_as_solution: what leaves a patch is exitance and reflection, and net flux the difference",
          "[pipeline][heat]") {
    const FormFactors factors = with_buried();
    HeatProblem problem = grey({0.8, 0.4, 0.5}, {at(500.0), with_flux(-100.0), at(300.0)});
    problem.environment_temperature = 280.0;
    problem.environment.assign(1, 0.0);
    const HeatSolution found = solve_heat(factors, problem);
    const Solution solution = heat_as_solution(factors, problem, found, 3); // grey, of equal channels
    REQUIRE(solution.radiosity.size() == 9);
    for (std::size_t k = 0; k < 6; ++k) {
        const std::size_t i = k / 3;
        CHECK(solution.radiosity[k] - solution.irradiance[k] == Approx(found.net_flux[i]));
        CHECK(solution.exitance[k] == Approx(found.emitted[i]));
        CHECK(solution.temperature[i] == found.temperature[i]);
    }
    CHECK(solution.exitance[0] == Approx(0.8 * power_of(500.0)));
    CHECK(solution.environment_share[1] == Approx(0.25));
    CHECK(solution.row_sum[0] == Approx(0.75));
    CHECK(solution.temperature[2] == 300.0); // buried
    CHECK(solution.net_flux[2] == 0.0);
    CHECK(solution.radiosity[6] == found.radiosity[2]);
    CHECK(solution.back_face_share[2] == 1.0);
    CHECK_THROWS_AS(heat_as_solution(plates(), problem, found, 1), InvalidArgument);
}
