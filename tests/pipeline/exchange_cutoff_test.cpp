#include "hemi/core/error.hpp"
#include "hemi/pipeline/heat.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace hemi;

namespace {

/// A network of these conductances, with areas by which the emissivity of every group is 0.5.
HeatExchange network(std::vector<std::vector<double>> rows, const std::vector<double>& to_environment) {
    HeatExchange result;
    for (std::size_t g = 0; g < rows.size(); ++g) {
        const double sum = std::accumulate(rows[g].begin(), rows[g].end(), to_environment[g]);
        result.areas.push_back(2.0 * sum);
        result.emissivity.push_back(sum > 0.0 ? 0.5 : 0.0);
        const double area = sum > 0.0 ? 2.0 * sum : 1.0;
        result.environment.push_back(to_environment[g] / area);
        for (const double value : rows[g]) {
            result.conductance.push_back(value);
            result.script_f.push_back(value / area);
            result.gebhart.push_back(value / area / 0.5);
        }
    }
    return result;
}

/// Groups that stand in a line, the nearer the larger what they exchange.
HeatExchange line(std::size_t groups, double own) {
    std::vector<std::vector<double>> rows(groups, std::vector<double>(groups, 0.0));
    std::vector<double> environment(groups);
    for (std::size_t g = 0; g < groups; ++g) {
        environment[g] = 0.02 * static_cast<double>(g % 7);
        for (std::size_t h = 0; h < groups; ++h) {
            const double apart = std::abs(static_cast<double>(g) - static_cast<double>(h));
            rows[g][h] = g == h ? own : 1.0 / (apart * apart * (1.0 + 0.1 * static_cast<double>(g * h % 5)));
        }
    }
    return network(rows, environment);
}

void check_balance(const HeatExchange& before, const HeatExchange& after, double min) {
    const std::size_t groups = before.areas.size();
    double environment = 0.0;
    for (std::size_t g = 0; g < groups; ++g) {
        CAPTURE(g);
        double sum = after.environment[g];
        const double outside = after.environment[g] * after.areas[g];
        CHECK((outside == 0.0 || outside >= min * (1.0 - 1e-12)));
        environment += outside - before.environment[g] * before.areas[g];
        for (std::size_t h = 0; h < groups; ++h) {
            const double value = after.conductance[g * groups + h];
            sum += after.script_f[g * groups + h];
            CHECK(value == after.conductance[h * groups + g]);
            CHECK((g == h || value == 0.0 || value >= min));
            CHECK(value >= 0.0);
            CHECK(after.gebhart[g * groups + h] * after.emissivity[g] ==
                  Approx(after.script_f[g * groups + h]).margin(1e-300));
        }
        CHECK(sum == Approx(after.emissivity[g]).epsilon(1e-10).margin(1e-15));
    }
    // What the environment gets of a scene of one temperature is what it was, or its own.
    CHECK(environment <= 1e-9);
}

} // namespace

TEST_CASE("Exchange cutoff: what is left is symmetric, balanced and not small", "[heat]") {
    for (const double own : {0.0, 0.3}) {
        for (const double min : {1e-3, 0.02, 0.1, 0.4}) {
            CAPTURE(own, min);
            const HeatExchange before = line(30, own);
            HeatExchange after = before;
            const ExchangeCutoff report = drop_small_conductances(after, min);
            check_balance(before, after, min);
            std::uint64_t dropped = 0;
            double change = 0.0;
            for (std::size_t g = 0; g < 30; ++g) {
                dropped += before.environment[g] > 0.0 && after.environment[g] == 0.0 ? 1 : 0;
                if (after.environment[g] > 0.0) {
                    change = std::max(change, std::abs(after.environment[g] / before.environment[g] - 1.0));
                }
                for (std::size_t h = 0; h < g; ++h) {
                    const double was = before.conductance[g * 30 + h];
                    const double is = after.conductance[g * 30 + h];
                    dropped += was > 0.0 && is == 0.0 ? 1 : 0;
                    change = is > 0.0 ? std::max(change, std::abs(is / was - 1.0)) : change;
                }
            }
            CHECK(report.dropped == dropped);
            CHECK(report.kept == 30 * 29 / 2 + 25 - dropped);
            CHECK(report.largest_change == Approx(change).epsilon(1e-9));
            CHECK((report.largest_share > 0.0) == (dropped > 0));
        }
    }
}

TEST_CASE("Exchange cutoff: little that is dropped goes to the others, next to nothing to the group itself",
          "[heat]") {
    // Four groups alike, that exchange s with two neighbours and d with the one opposite: 2 s + d is the sum.
    const double s = 1.0;
    const double d = 0.01;
    const HeatExchange before =
        network({{0, s, d, s}, {s, 0, s, d}, {d, s, 0, s}, {s, d, s, 0}}, {0.0, 0.0, 0.0, 0.0});
    HeatExchange after = before;
    const ExchangeCutoff report = drop_small_conductances(after, 0.5);
    check_balance(before, after, 0.5);
    CHECK(report.dropped == 2);
    CHECK(report.kept == 4);
    CHECK(report.isolated.empty());
    CHECK(report.largest_share == Approx(d / (2.0 * s + d)));
    const double own = d * d / (2.0 * s + d); // times D², which all have alike
    const double scale = (2.0 * s + d) / (2.0 * s + own);
    CHECK(after.conductance[1] == Approx(s * scale).epsilon(1e-12));
    CHECK(after.conductance[0] == Approx(own * scale).epsilon(1e-9));
    CHECK(report.largest_change == Approx(scale - 1.0).epsilon(1e-9));
}

TEST_CASE("Exchange cutoff: closed forms and ends", "[heat]") {
    // Two plates stay as they are: nothing is below.
    HeatExchange plates = network({{0.0, 0.4}, {0.4, 0.0}}, {0.0, 0.0});
    CHECK(drop_small_conductances(plates, 0.4).dropped == 0);
    CHECK(plates.conductance == std::vector<double>{0.0, 0.4, 0.4, 0.0});
    // All of it is: nothing is left but the groups themselves, and the report names them.
    const ExchangeCutoff all = drop_small_conductances(plates, 0.5);
    CHECK(all.isolated == std::vector<std::uint32_t>{0, 1});
    CHECK(all.kept == 0);
    CHECK(plates.conductance[0] == Approx(0.4).epsilon(1e-12));
    CHECK(plates.conductance[1] == 0.0);
    // Three black plates in a row, the outer ones seeing each other a little: no scaling of what is left has
    // these sums, since the middle would have to give what both outer ones need.
    const HeatExchange three = network({{0, 1, 1e-4}, {1, 0, 1}, {1e-4, 1, 0}}, {0.0, 0.0, 0.0});
    HeatExchange left = three;
    const ExchangeCutoff report = drop_small_conductances(left, 1e-3);
    check_balance(three, left, 1e-3);
    CHECK(report.dropped == 1);
    CHECK(left.conductance[1] == Approx(1.0).epsilon(1e-12));
    CHECK(left.conductance[0] == Approx(1e-4).epsilon(1e-9));
    // A group that emits nothing has nothing to lose.
    HeatExchange mirror = network({{0, 1, 0}, {1, 0.2, 0}, {0, 0, 0}}, {0.001, 0.3, 0.0});
    const HeatExchange whole = mirror;
    CHECK(drop_small_conductances(mirror, 0.01).isolated.empty());
    check_balance(whole, mirror, 0.01);
    CHECK(mirror.environment[0] == 0.0);
    CHECK_THROWS_AS(drop_small_conductances(mirror, 0.0), InvalidArgument);
    CHECK_THROWS_AS(drop_small_conductances(mirror, std::nan("")), InvalidArgument);
}
