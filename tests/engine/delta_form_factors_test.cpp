#include "hemi/engine/delta_form_factors.hpp"

#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <numbers>

using namespace hemi;

namespace {

constexpr double unit = 1.0 / DeltaFormFactors::total;

std::uint64_t sum_of_rows(const DeltaFormFactors& weights, std::uint32_t begin, std::uint32_t end) {
    std::uint64_t sum = 0;
    for (std::uint32_t row = begin; row < end; ++row) {
        for (std::uint32_t column = 0; column < weights.resolution(); ++column) {
            sum += weights.weight(row, column);
        }
    }
    return sum;
}

bool about_equal(std::uint32_t one, std::uint32_t other) {
    return std::max(one, other) - std::min(one, other) <= 1;
}

// Four-point Gauss-Legendre quadrature of f over [u0, u1] x [v0, v1].
template <class Function>
double quadrature(const Function& f, double u0, double u1, double v0, double v1) {
    constexpr double nodes[4] = {-0.861136311594052575, -0.339981043584856265, 0.339981043584856265,
                                 0.861136311594052575};
    constexpr double factors[4] = {0.347854845137453857, 0.652145154862546143, 0.652145154862546143,
                                   0.347854845137453857};
    double sum = 0.0;
    for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < 4; ++b) {
            sum += factors[a] * factors[b] *
                   f((u0 + u1) / 2 + nodes[a] * (u1 - u0) / 2, (v0 + v1) / 2 + nodes[b] * (v1 - v0) / 2);
        }
    }
    return sum * (u1 - u0) * (v1 - v0) / 4;
}

} // namespace

TEST_CASE("DeltaFormFactors: the weights of a hemicube sum to exactly 1", "[engine]") {
    for (const std::uint32_t resolution : {2u, 4u, 6u, 50u, 128u, 510u, 1024u}) {
        const DeltaFormFactors weights(resolution);
        CHECK(weights.rows() == 3 * resolution);
        CHECK(sum_of_rows(weights, 0, weights.rows()) == DeltaFormFactors::total);
    }
}

TEST_CASE("DeltaFormFactors: faces have their closed values", "[engine]") {
    for (const std::uint32_t resolution : {2u, 64u, 128u, 1022u}) {
        const DeltaFormFactors weights(resolution);
        CHECK(static_cast<double>(sum_of_rows(weights, 0, resolution)) * unit ==
              Approx(0.55412642).margin(6e-9));
        for (std::uint32_t face = 0; face < 4; ++face) {
            const std::uint32_t begin = resolution + face * resolution / 2;
            CHECK(static_cast<double>(sum_of_rows(weights, begin, begin + resolution / 2)) * unit ==
                  Approx(0.11146839).margin(6e-9));
        }
    }
}

TEST_CASE("DeltaFormFactors: prefix sums ascend and continue from row to row", "[engine]") {
    const DeltaFormFactors weights(130);
    std::uint32_t last = 0;
    for (std::uint32_t row = 0; row < weights.rows(); ++row) {
        const auto prefix = weights.prefix_row(row);
        REQUIRE(prefix.size() == 131);
        CHECK(prefix.front() == last);
        for (const std::uint32_t value : prefix) {
            REQUIRE(value >= last);
            last = value;
        }
    }
    CHECK(last == DeltaFormFactors::total);
}

TEST_CASE("DeltaFormFactors: symmetric to one unit of rounding", "[engine]") {
    const std::uint32_t resolution = 128;
    const DeltaFormFactors weights(resolution);
    bool top = true;
    bool sides = true;
    for (std::uint32_t row = 0; row < resolution; ++row) {
        for (std::uint32_t column = 0; column < resolution; ++column) {
            const std::uint32_t weight = weights.weight(row, column);
            top = top && about_equal(weight, weights.weight(row, resolution - 1 - column));
            top = top && about_equal(weight, weights.weight(resolution - 1 - row, column));
            top = top && about_equal(weight, weights.weight(column, row));
        }
    }
    for (std::uint32_t row = 0; row < resolution / 2; ++row) {
        for (std::uint32_t column = 0; column < resolution; ++column) {
            const std::uint32_t weight = weights.weight(resolution + row, column);
            sides = sides && about_equal(weight, weights.weight(resolution + row, resolution - 1 - column));
            for (std::uint32_t face = 1; face < 4; ++face) {
                sides = sides &&
                        about_equal(weight, weights.weight(resolution + face * resolution / 2 + row, column));
            }
        }
    }
    CHECK(top);
    CHECK(sides);
}

TEST_CASE("DeltaFormFactors: every texel is the integral of the form factor kernel over it", "[engine]") {
    for (const std::uint32_t resolution : {16u, 64u}) {
        const DeltaFormFactors weights(resolution);
        const double step = 2.0 / resolution;
        const auto top = [](double x, double y) {
            const double r2 = 1.0 + x * x + y * y;
            return std::numbers::inv_pi / (r2 * r2);
        };
        const auto side = [](double y, double z) {
            const double r2 = 1.0 + y * y + z * z;
            return z * std::numbers::inv_pi / (r2 * r2);
        };
        double worst = 0.0;
        for (std::uint32_t row = 0; row < weights.rows(); ++row) {
            for (std::uint32_t column = 0; column < resolution; ++column) {
                const double u = -1.0 + step * column;
                const double exact =
                    row < resolution ? quadrature(top, u, u + step, -1.0 + step * row, step * (row + 1) - 1.0)
                                     : quadrature(side, u, u + step, step * (row % (resolution / 2)),
                                                  step * (row % (resolution / 2) + 1));
                worst = std::max(worst, std::abs(weights.weight(row, column) * unit - exact));
            }
        }
        // Quadrature with four points is not exact at resolution 16.
        CHECK(worst < (resolution == 16 ? 1e-9 : 1.01 * unit));
    }
}

TEST_CASE("DeltaFormFactors: of spheres every texel weighs its solid angle", "[engine]") {
    const std::uint32_t resolution = 64;
    const DeltaFormFactors weights(resolution, DirectionMeasure::solid_angle);
    CHECK(sum_of_rows(weights, 0, weights.rows()) == DeltaFormFactors::total);
    CHECK(static_cast<double>(sum_of_rows(weights, 0, resolution)) * unit == Approx(1.0 / 3.0).margin(1e-9));
    const double step = 2.0 / resolution;
    const auto kernel = [](double x, double y) {
        return 0.5 * std::numbers::inv_pi / std::pow(1.0 + x * x + y * y, 1.5);
    };
    double worst = 0.0;
    for (std::uint32_t row = 0; row < weights.rows(); ++row) {
        for (std::uint32_t column = 0; column < resolution; ++column) {
            const double u = -1.0 + step * column;
            const double v = row < resolution ? -1.0 + step * row : step * (row % (resolution / 2));
            const double exact = quadrature(kernel, u, u + step, v, v + step);
            worst = std::max(worst, std::abs(weights.weight(row, column) * unit - exact));
        }
    }
    CHECK(worst < 1.01 * unit);
    CHECK(weights.scaled(0.5).sum() == DeltaFormFactors::total / 2);
}

TEST_CASE("DeltaFormFactors: small texels keep their weight at the highest resolution", "[engine][slow]") {
    const std::uint32_t resolution = 4096;
    const DeltaFormFactors weights(resolution);
    const double step = 2.0 / resolution;
    double worst = 0.0;
    for (std::uint32_t row = 0; row < weights.rows(); row += 13) {
        for (std::uint32_t column = row % 7; column < resolution; column += 7) {
            const double u = -1.0 + step * (column + 0.5);
            const bool top = row < resolution;
            const double v = top ? -1.0 + step * (row + 0.5) : step * (row % (resolution / 2) + 0.5);
            const double r2 = 1.0 + u * u + v * v;
            const double exact = step * step * (top ? 1.0 : v) * std::numbers::inv_pi / (r2 * r2);
            worst = std::max(worst, std::abs(weights.weight(row, column) * unit - exact));
        }
    }
    CHECK(worst < 1.01 * unit);
    CHECK(weights.prefix_row(weights.rows() - 1).back() == DeltaFormFactors::total);
}

TEST_CASE("DeltaFormFactors: the smallest hemicube has four equal texels on top", "[engine]") {
    const DeltaFormFactors weights(2);
    for (std::uint32_t row = 0; row < 2; ++row) {
        for (std::uint32_t column = 0; column < 2; ++column) {
            CHECK(weights.weight(row, column) * unit == Approx(0.55412642 / 4).margin(3e-9));
        }
    }
    for (std::uint32_t row = 2; row < 6; ++row) {
        CHECK(weights.weight(row, 0) * unit == Approx(0.11146839 / 2).margin(3e-9));
        CHECK(weights.weight(row, 1) * unit == Approx(0.11146839 / 2).margin(3e-9));
    }
}

TEST_CASE("DeltaFormFactors: refuses resolutions that are odd or out of range", "[engine]") {
    for (const std::uint32_t resolution : {0u, 1u, 3u, 127u, 4097u, 4098u, 0xFFFFFFFEu}) {
        CHECK_THROWS_AS(DeltaFormFactors(resolution), InvalidArgument);
        CHECK_THROWS_AS(DeltaFormFactors::check_resolution(resolution), InvalidArgument);
    }
    CHECK_THROWS_WITH(DeltaFormFactors(129), Catch::Contains("129"));
    for (const std::uint32_t resolution : {2u, 128u, 4096u}) {
        CHECK_NOTHROW(DeltaFormFactors::check_resolution(resolution));
    }
}
