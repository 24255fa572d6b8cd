#pragma once

#include "hemi/display/colour_map.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace hemi {

/// How numbers become colours, and back.
struct ColourScale {
    double low = 0.0;                   ///< value of the darkest colour; above 0 where logarithmic
    double high = 1.0;                  ///< of the brightest; above low
    bool logarithmic = false;           ///< equal steps of colour are equal ratios
    ColourMap map = ColourMap::viridis; ///< which colours

    /// Where a value lies between low (0) and high (1); values outside are at the ends.
    [[nodiscard]] double position(double value) const;
    [[nodiscard]] double value_at(double position) const;
    /// Values worth a mark on the scale, ascending: decades where logarithmic (at most eight), else fifths.
    [[nodiscard]] std::vector<double> marks() const;

    bool operator==(const ColourScale&) const = default;
};

/// Colour at a position in [0, 1]; display linear.
[[nodiscard]] std::array<float, 3> scale_colour(double position, ColourMap map = ColourMap::viridis);
/// A colour to tell item `id` from its neighbours by; display linear.
[[nodiscard]] std::array<float, 3> item_colour(std::uint32_t id);

/// The least of 1, 2, 5, 10 … that is not below `value` (> 0), so that scales end on round numbers.
[[nodiscard]] double round_up(double value);

} // namespace hemi
