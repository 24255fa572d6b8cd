#include "display/colour_scale.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hemi {

namespace {

/// Equal steps along the scale, as sRGB.
constexpr std::array<std::array<double, 3>, 6> stops{{{0.13, 0.07, 0.27},
                                                      {0.21, 0.24, 0.56},
                                                      {0.12, 0.47, 0.60},
                                                      {0.22, 0.67, 0.46},
                                                      {0.67, 0.83, 0.27},
                                                      {1.00, 0.95, 0.48}}};

float linear_from_srgb(double value) {
    return static_cast<float>(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
}

} // namespace

double ColourScale::position(double value) const {
    if (logarithmic) {
        return value > low ? std::min(std::log(value / low) / std::log(high / low), 1.0) : 0.0;
    }
    return std::clamp((value - low) / (high - low), 0.0, 1.0);
}

double ColourScale::value_at(double position) const {
    return logarithmic ? low * std::pow(high / low, position) : low + position * (high - low);
}

std::vector<double> ColourScale::marks() const {
    std::vector<double> result;
    if (!logarithmic) {
        for (int k = 0; k <= 5; ++k) {
            result.push_back(low + (high - low) * k / 5.0);
        }
        return result;
    }
    const int first = static_cast<int>(std::ceil(std::log10(low) - 1e-9));
    const int last = static_cast<int>(std::floor(std::log10(high) + 1e-9));
    const int step = (last - first) / 8 + 1;
    for (int decade = first; decade <= last; decade += step) {
        result.push_back(std::pow(10.0, decade));
    }
    return result;
}

std::array<float, 3> scale_colour(double position) {
    const double place = std::clamp(position, 0.0, 1.0) * (stops.size() - 1);
    const std::size_t before = std::min(static_cast<std::size_t>(place), stops.size() - 2);
    const double share = place - static_cast<double>(before);
    std::array<float, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c) {
        colour[c] = linear_from_srgb((1.0 - share) * stops[before][c] + share * stops[before + 1][c]);
    }
    return colour;
}

std::array<float, 3> item_colour(std::uint32_t id) {
    // Steps of the golden ratio go round the hues without coming near each other soon.
    const double hue = std::fmod((id + 1) * 0.6180339887498949, 1.0) * 6.0;
    const double light = 0.55 + 0.45 * std::fmod((id + 1) * 0.7548776662466927, 1.0);
    std::array<float, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double away = std::abs(std::fmod(hue + 6.0 - 2.0 * static_cast<double>(c), 6.0) - 3.0);
        colour[c] = linear_from_srgb(light * (0.25 + 0.75 * std::clamp(away - 1.0, 0.0, 1.0)));
    }
    return colour;
}

double round_up(double value) {
    const double decade = std::pow(10.0, std::floor(std::log10(value)));
    for (const double step : {1.0, 2.0, 5.0}) {
        if (step * decade >= value * (1.0 - 1e-12)) {
            return step * decade;
        }
    }
    return 10.0 * decade;
}

} // namespace hemi
