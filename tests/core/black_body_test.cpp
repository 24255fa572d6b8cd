#include "hemi/core/black_body.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace hemi;

TEST_CASE("black body: shares of the exitance below a wavelength are right to 1e-13", "[core][heat]") {
    // At the wavelength of the peak: 2897.771955 µm K.
    CHECK(black_body_fraction(2897.771955) == Approx(0.25005455).epsilon(0).margin(5e-9));
    CHECK(black_body_fraction(0.0) == 0.0);
    CHECK(black_body_fraction(std::numeric_limits<double>::infinity()) == 1.0);
    // Both series, by their derivative: dF/dx = -15/pi⁴ x³ / (e^x - 1), x = c2 / (wavelength T), integrated
    // by Simpson's rule in small steps across the place where one takes over from the other.
    const auto density = [](double x) { return 15.0 / std::pow(M_PI, 4) * x * x * x / std::expm1(x); };
    const int steps = 4000;
    const double from = 0.5;
    const double width = 2.0 / steps;
    double integral = 0.0;
    for (int k = 0; k < steps; k += 2) {
        const double x = from + k * width;
        integral += width / 3.0 * (density(x) + 4.0 * density(x + width) + density(x + 2.0 * width));
    }
    const double difference = black_body_fraction(second_radiation_constant / from) -
                              black_body_fraction(second_radiation_constant / (from + 2.0));
    CHECK(difference == Approx(integral).epsilon(0).margin(1e-13));
    const double at_seam = black_body_fraction(second_radiation_constant / (1.0 - 1e-15)) -
                           black_body_fraction(second_radiation_constant / (1.0 + 1e-15));
    CHECK(std::abs(at_seam) < 2e-15);
}

TEST_CASE("black body: bands share out all of it", "[core][heat]") {
    const std::vector<double> limits{1.0, 3.0, 8.0};
    const std::vector<double> shares = band_fractions(1500.0, limits);
    REQUIRE(shares.size() == 4);
    CHECK(shares[0] + shares[1] + shares[2] + shares[3] == Approx(1.0).epsilon(1e-15));
    CHECK(shares[0] == Approx(black_body_fraction(1500.0)));
    CHECK(band_fractions(0.0, limits) == std::vector<double>{0.0, 0.0, 0.0, 1.0});
    CHECK(band_fractions(300.0, {}) == std::vector<double>{1.0});
}

TEST_CASE("temperatures: kelvin, or with a unit", "[core][heat]") {
    CHECK(parse_temperature("293.15") == 293.15);
    CHECK(parse_temperature("300 K") == 300.0);
    CHECK(parse_temperature("20 C") == 293.15);
    CHECK(parse_temperature("+20\xc2\xb0"
                            "C") == 293.15);
    CHECK(parse_temperature(" -40 \xc2\xb0"
                            "C ") == Approx(233.15));
    CHECK(parse_temperature("-300C") == Approx(-26.85));
    for (const char* text : {"", "warm", "20 F", "20 CC", "nan", "inf", "C"}) {
        CHECK_FALSE(parse_temperature(text));
    }
    CHECK(black_body_temperature(black_body_exitance(550.0)) == Approx(550.0).epsilon(1e-15));
    CHECK(black_body_temperature(-1.0) == 0.0);
}
