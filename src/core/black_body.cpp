#include "hemi/core/black_body.hpp"

#include <charconv>
#include <cmath>
#include <iterator>
#include <numbers>

namespace hemi {

namespace {

constexpr double kelvin_of_ice = 273.15;

/// Integral of t³ / (e^t - 1) from 0 to a small x, by Bernoulli numbers: it converges below 2 pi.
double integral_to(double x) {
    // B(2n) / (2n)!
    constexpr double bernoulli[] = {1.0 / 12.0,          -1.0 / 720.0,
                                    1.0 / 30240.0,       -1.0 / 1209600.0,
                                    1.0 / 47900160.0,    -691.0 / 1307674368000.0,
                                    1.0 / 74724249600.0, -3617.0 / 10670622842880000.0};
    double sum = 1.0 / 3.0 - x / 8.0;
    double power = 1.0;
    for (std::size_t n = 0; n < std::size(bernoulli); ++n) {
        power *= x * x;
        sum += bernoulli[n] * power / (2.0 * static_cast<double>(n) + 5.0);
    }
    return x * x * x * sum;
}

/// The same from x to infinity, by exponentials: the larger x the fewer.
double integral_from(double x) {
    double sum = 0.0;
    for (int n = 1; n <= 60; ++n) {
        const double k = n;
        const double term =
            std::exp(-k * x) * (x * x * x + 3.0 * x * x / k + 6.0 * x / (k * k) + 6.0 / (k * k * k)) / k;
        sum += term;
        if (term <= 1e-17 * sum) {
            break;
        }
    }
    return sum;
}

} // namespace

double black_body_temperature(double exitance) {
    return exitance > 0.0 ? std::sqrt(std::sqrt(exitance / stefan_boltzmann)) : 0.0;
}

double black_body_fraction(double wavelength_temperature) {
    constexpr double whole = std::numbers::pi * std::numbers::pi * std::numbers::pi * std::numbers::pi / 15.0;
    if (!(wavelength_temperature > 0.0)) {
        return 0.0;
    }
    const double x = second_radiation_constant / wavelength_temperature;
    return x < 1.0 ? 1.0 - integral_to(x) / whole : integral_from(x) / whole;
}

std::vector<double> band_fractions(double kelvin, std::span<const double> limits) {
    std::vector<double> fractions;
    double below = 0.0;
    for (const double limit : limits) {
        const double share = black_body_fraction(limit * kelvin);
        fractions.push_back(share - below);
        below = share;
    }
    fractions.push_back(1.0 - below);
    return fractions;
}

std::optional<double> parse_temperature(std::string_view text) {
    const auto skip_blanks = [&text] {
        while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) {
            text.remove_prefix(1);
        }
    };
    skip_blanks();
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') {
        text.remove_prefix(1);
    }
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || !std::isfinite(value)) {
        return std::nullopt;
    }
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    skip_blanks();
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) {
        text.remove_suffix(1);
    }
    if (text.empty() || text == "K") {
        return value;
    }
    // The degree sign in UTF-8 and in Latin-1.
    if (text == "C" ||
        text == "\xc2\xb0"
                "C" ||
        text == "\xb0"
                "C") {
        return value + kelvin_of_ice;
    }
    return std::nullopt;
}

} // namespace hemi
