#include "core/gauss_legendre.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hemi;

TEST_CASE("gauss_legendre: integrates polynomials up to degree 2n - 1", "[core]") {
    for (std::uint32_t count = 1; count <= 16; ++count) {
        for (std::uint32_t degree = 0; degree < 2 * count; ++degree) {
            double sum = 0.0;
            for (const GaussPoint& point : gauss_legendre(count)) {
                sum += point.weight * std::pow(point.at, degree);
            }
            CHECK(sum == Approx(1.0 / (degree + 1.0)).epsilon(1e-13));
        }
    }
}

TEST_CASE("gauss_legendre: points ascend and mirror each other", "[core]") {
    const auto points = gauss_legendre(5);
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
        CHECK(points[k].at < points[k + 1].at);
        CHECK(points[k].at + points[points.size() - 1 - k].at == Approx(1.0).margin(1e-15));
    }
}
