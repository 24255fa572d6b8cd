#include "core/gauss_rule.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace hemi {

namespace {

struct Rules {
    std::array<std::array<double, gauss_rule_max>, gauss_rule_max + 1> points{};
    std::array<std::array<double, gauss_rule_max>, gauss_rule_max + 1> weights{};

    Rules() {
        for (std::size_t n = 1; n <= gauss_rule_max; ++n) {
            for (std::size_t k = 0; k < n; ++k) {
                solve(n, k);
            }
        }
    }

private:
    /// Newton on the Legendre polynomial, from Tricomi's estimate of its k-th root.
    void solve(std::size_t n, std::size_t k) {
        const auto degree = static_cast<double>(n);
        const auto index = static_cast<double>(k);
        double x = -std::cos(std::numbers::pi * (index + 0.75) / (degree + 0.5));
        double slope = 0.0;
        for (int step = 0; step < 20; ++step) {
            double value = x;
            double before = 1.0;
            for (std::size_t d = 2; d <= n; ++d) {
                const auto order = static_cast<double>(d);
                const double next = ((2.0 * order - 1.0) * x * value - (order - 1.0) * before) / order;
                before = value;
                value = next;
            }
            slope = degree * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        if (2 * k + 1 == n) {
            x = 0.0;
        }
        points[n][k] = x;
        weights[n][k] = 2.0 / ((1.0 - x * x) * slope * slope);
    }
};

} // namespace

GaussRule gauss_rule(std::size_t n) {
    static const Rules rules;
    return {{rules.points[n].data(), n}, {rules.weights[n].data(), n}};
}

} // namespace hemi
