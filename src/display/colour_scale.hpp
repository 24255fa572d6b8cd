#pragma once

#include "hemi/display/colour_map.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hemi {

/// How numbers become colours, and back.
struct ColourScale {
    double low = 0.0;                   ///< value of the darkest colour; above 0 where logarithmic
    double high = 1.0;                  ///< of the brightest; above low
    bool logarithmic = false;           ///< equal steps of colour are equal ratios
    ColourMap map = ColourMap::viridis; ///< which colours
    std::uint32_t bands = 0;            ///< of one colour each, at least 2; 0: colours run smoothly
    bool lines = false;                 ///< at levels()

    /// Where a value lies between low (0) and high (1); values outside are at the ends.
    [[nodiscard]] double position(double value) const;
    [[nodiscard]] double value_at(double position) const;
    /// The same as position(), but values outside are below 0 or above 1.
    [[nodiscard]] double place(double value) const;
    /// Colour at a position, see scale_colour(): that of its band, where there are bands.
    [[nodiscard]] std::array<float, 3> colour_at(double position) const;
    /// Values between low and high where bands end or, without bands, round ones, at most eleven; ascending.
    [[nodiscard]] std::vector<double> levels() const;
    /// Values worth a mark on the scale, ascending: where bands end, at lines, else decades where logarithmic
    /// (at most eight), else fifths.
    [[nodiscard]] std::vector<double> marks() const;

    bool operator==(const ColourScale&) const = default;
};

/// Colour at a position in [0, 1]; display linear.
[[nodiscard]] std::array<float, 3> scale_colour(double position, ColourMap map = ColourMap::viridis);
/// A colour to tell item `id` from its neighbours by; display linear.
[[nodiscard]] std::array<float, 3> item_colour(std::uint32_t id);

/// Round values between low and high, ascending, at most `most` and at least one: multiples of 1, 2 or 5
/// times a power of ten.
[[nodiscard]] std::vector<double> round_marks(double low, double high, std::size_t most);
/// The same, with low above 0: 1, 2 and 5 times powers of ten, or these alone, or every few of them.
[[nodiscard]] std::vector<double> decade_marks(double low, double high, std::size_t most);

/// The least of 1, 2, 5, 10 … that is not below `value` (> 0), so that scales end on round numbers.
[[nodiscard]] double round_up(double value);

} // namespace hemi
