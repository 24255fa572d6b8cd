#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

/// How different two pictures look.
namespace hemi::test {

/// 8-bit sRGB, rows from the top, 3 bytes a pixel.
struct SrgbPicture {
    std::size_t width = 0;
    std::size_t height = 0;
    std::vector<std::uint8_t> pixels;
};

/// Differences of colour as CIE 1976 ΔE (about 2 is just noticeable side by side), after each pixel has been
/// averaged with its eight neighbours: a hairline that moves by a pixel is not what one sees.
struct PictureDifference {
    double mean = 0.0;
    double percentile_99 = 0.0;
    double worst_cell = 0.0; ///< largest mean over a cell of 10 x 10 pixels: local faults
};

namespace picture_detail {

using Colour = std::array<double, 3>;

inline Colour linear_of(const SrgbPicture& picture, std::size_t x, std::size_t y) {
    Colour colour{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double value = picture.pixels[(y * picture.width + x) * 3 + c] / 255.0;
        colour[c] = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
    }
    return colour;
}

/// Mean linear colour of the pixels round (x, y).
inline Colour blurred(const SrgbPicture& picture, std::size_t x, std::size_t y) {
    Colour sum{};
    double weight = 0.0;
    for (std::size_t v = y == 0 ? 0 : y - 1; v < std::min(y + 2, picture.height); ++v) {
        for (std::size_t u = x == 0 ? 0 : x - 1; u < std::min(x + 2, picture.width); ++u) {
            const Colour colour = linear_of(picture, u, v);
            for (std::size_t c = 0; c < 3; ++c) {
                sum[c] += colour[c];
            }
            weight += 1.0;
        }
    }
    return {sum[0] / weight, sum[1] / weight, sum[2] / weight};
}

/// CIE 1976 L*a*b* of a linear sRGB colour, white D65.
inline Colour lab(const Colour& rgb) {
    const auto f = [](double t) {
        return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0;
    };
    const double x = f((0.4124564 * rgb[0] + 0.3575761 * rgb[1] + 0.1804375 * rgb[2]) / 0.95047);
    const double y = f(0.2126729 * rgb[0] + 0.7151522 * rgb[1] + 0.0721750 * rgb[2]);
    const double z = f((0.0193339 * rgb[0] + 0.1191920 * rgb[1] + 0.9503041 * rgb[2]) / 1.08883);
    return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

} // namespace picture_detail

/// @param a,b  of the same size
inline PictureDifference picture_difference(const SrgbPicture& a, const SrgbPicture& b) {
    constexpr std::size_t cell = 10;
    const std::size_t columns = (a.width + cell - 1) / cell;
    std::vector<double> all;
    std::vector<double> sums(columns * ((a.height + cell - 1) / cell));
    std::vector<double> counts(sums.size());
    double total = 0.0;
    for (std::size_t y = 0; y < a.height; ++y) {
        for (std::size_t x = 0; x < a.width; ++x) {
            const auto one = picture_detail::lab(picture_detail::blurred(a, x, y));
            const auto other = picture_detail::lab(picture_detail::blurred(b, x, y));
            const double difference = std::hypot(one[0] - other[0], one[1] - other[1], one[2] - other[2]);
            all.push_back(difference);
            total += difference;
            sums[(y / cell) * columns + x / cell] += difference;
            counts[(y / cell) * columns + x / cell] += 1.0;
        }
    }
    PictureDifference result;
    result.mean = total / static_cast<double>(all.size());
    const auto nth = all.begin() + static_cast<std::ptrdiff_t>(all.size() * 99 / 100);
    std::nth_element(all.begin(), nth, all.end());
    result.percentile_99 = *nth;
    for (std::size_t k = 0; k < sums.size(); ++k) {
        result.worst_cell = std::max(result.worst_cell, sums[k] / counts[k]);
    }
    return result;
}

} // namespace hemi::test
