#include "display/colour_scale.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace hemi {

namespace {

/// Equal steps along a map, as 0xRRGGBB of sRGB. Sources: viridis and inferno, S. van der Walt and N. Smith,
/// 2015 (matplotlib, CC0); turbo, A. Mikhailov, "Turbo, an improved rainbow colormap", 2019; cool-warm, K.
/// Moreland, "Diverging color maps for scientific visualization", 2009.
constexpr std::array<std::uint32_t, 9> viridis{0x440154, 0x472C7A, 0x3B518B, 0x2C718E, 0x21908D,
                                               0x27AD81, 0x5CC863, 0xAADC32, 0xFDE725};
constexpr std::array<std::uint32_t, 9> inferno{0x000004, 0x1F0C48, 0x550F6D, 0x88226A, 0xBB3754,
                                               0xE35933, 0xF98C0A, 0xF9C932, 0xFCFFA4};
constexpr std::array<std::uint32_t, 9> turbo{0x30123B, 0x4662D8, 0x36AAF9, 0x1AE4B6, 0x72FE5E,
                                             0xC8EF34, 0xFABA39, 0xE4460A, 0x7A0403};
constexpr std::array<std::uint32_t, 5> cool_warm{0x3B4CC0, 0x8DB0FE, 0xDDDDDD, 0xF4987A, 0xB40426};
constexpr std::array<std::uint32_t, 2> grey{0x000000, 0xFFFFFF};

std::span<const std::uint32_t> stops_of(ColourMap map) {
    switch (map) {
    case ColourMap::inferno:
        return inferno;
    case ColourMap::turbo:
        return turbo;
    case ColourMap::cool_warm:
        return cool_warm;
    case ColourMap::grey:
        return grey;
    default:
        return viridis;
    }
}

float linear_from_srgb(double value) {
    return static_cast<float>(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
}

} // namespace

double ColourScale::position(double value) const {
    return std::clamp(place(value), 0.0, 1.0);
}

double ColourScale::place(double value) const {
    if (logarithmic) {
        return value > 0.0 ? std::log(value / low) / std::log(high / low) : -1.0;
    }
    return (value - low) / (high - low);
}

double ColourScale::value_at(double position) const {
    return logarithmic ? low * std::pow(high / low, position) : low + position * (high - low);
}

std::array<float, 3> ColourScale::colour_at(double position) const {
    if (bands < 2) {
        return scale_colour(position, map);
    }
    const auto count = static_cast<double>(bands);
    const double band = std::clamp(std::floor(position * count), 0.0, count - 1.0);
    return scale_colour(band / (count - 1.0), map); // the first and the last have the ends' colours
}

std::vector<double> ColourScale::levels() const {
    constexpr std::size_t most = 11;
    std::vector<double> result;
    if (bands > 1) {
        for (std::uint32_t k = 1; k < bands; ++k) {
            result.push_back(value_at(static_cast<double>(k) / static_cast<double>(bands)));
        }
        return result;
    }
    const double rounding = 1e-9 * (high - low);
    for (const double mark : logarithmic ? decade_marks(low, high, most) : round_marks(low, high, most)) {
        if (mark > low + rounding && mark < high - rounding) {
            result.push_back(mark);
        }
    }
    return result;
}

std::vector<double> ColourScale::marks() const {
    std::vector<double> result;
    if (bands > 1 || lines) {
        result = levels();
        if (bands > 1) {
            result.insert(result.begin(), low);
            result.push_back(high);
        }
        return result;
    }
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

std::array<float, 3> scale_colour(double position, ColourMap map) {
    const std::span<const std::uint32_t> stops = stops_of(map);
    const double place = std::clamp(position, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
    const std::size_t before = std::min(static_cast<std::size_t>(place), stops.size() - 2);
    const double share = place - static_cast<double>(before);
    std::array<float, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto part = [c](std::uint32_t stop) { return (stop >> (16 - 8 * c) & 0xFF) / 255.0; };
        colour[c] = linear_from_srgb((1.0 - share) * part(stops[before]) + share * part(stops[before + 1]));
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

std::vector<double> decade_marks(double low, double high, std::size_t most) {
    const int first = static_cast<int>(std::floor(std::log10(low)));
    const int last = static_cast<int>(std::ceil(std::log10(high)));
    std::vector<double> marks;
    const auto add = [&](double mark) {
        if (mark >= low * (1.0 - 1e-9) && mark <= high * (1.0 + 1e-9)) {
            marks.push_back(mark);
        }
    };
    for (int decade = first; decade <= last; ++decade) {
        for (const double step : {1.0, 2.0, 5.0}) {
            add(step * std::pow(10.0, decade));
        }
    }
    for (int every = 1; marks.size() > most && every <= last - first; ++every) {
        marks.clear();
        for (int decade = first; decade <= last; decade += every) {
            add(std::pow(10.0, decade));
        }
    }
    if (marks.empty() || marks.size() > most) {
        marks.assign(1, std::sqrt(low * high));
    }
    return marks;
}

std::vector<double> round_marks(double low, double high, std::size_t most) {
    const auto first = [low](double step) { return std::ceil(low / step - 1e-9); };
    const auto last = [high](double step) { return std::floor(high / step + 1e-9); };
    double step = round_up((high - low) / static_cast<double>(most));
    while (last(step) - first(step) + 1.0 > static_cast<double>(most)) {
        step = round_up(1.5 * step);
    }
    std::vector<double> marks;
    const double count = last(step) - first(step);
    for (int k = 0; k <= count; ++k) { // where numbers are so close that + 1.0 is nothing, too
        marks.push_back((first(step) + k) * step + 0.0); // no -0
    }
    if (marks.empty()) {
        marks.push_back(0.5 * (low + high));
    }
    return marks;
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
