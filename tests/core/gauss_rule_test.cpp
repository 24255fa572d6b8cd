#include "core/gauss_rule.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hemi;

TEST_CASE("gauss_rule: integrates polynomials up to degree 2n - 1", "[core]") {
    for (std::size_t count = 1; count <= gauss_rule_max; ++count) {
        const GaussRule rule = gauss_rule(count);
        REQUIRE(rule.points.size() == count);
        for (std::size_t degree = 0; degree < 2 * count; ++degree) {
            double sum = 0.0;
            for (std::size_t k = 0; k < count; ++k) {
                sum += rule.weights[k] * std::pow(rule.points[k], static_cast<double>(degree));
            }
            const double exact = degree % 2 == 1 ? 0.0 : 2.0 / (static_cast<double>(degree) + 1.0);
            CHECK(sum == Approx(exact).epsilon(1e-12).margin(1e-14));
        }
    }
}

TEST_CASE("gauss_rule: points ascend and mirror each other", "[core]") {
    const GaussRule rule = gauss_rule(5);
    for (std::size_t k = 0; k + 1 < 5; ++k) {
        CHECK(rule.points[k] < rule.points[k + 1]);
        CHECK(rule.points[k] + rule.points[4 - k] == Approx(0.0).margin(1e-15));
    }
}
