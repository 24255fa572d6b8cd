#pragma once

#include "display/colour_scale.hpp"
#include "hemi/display/picture.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hemi {

/// Round values between low and high, ascending, at most `most` and at least one: multiples of 1, 2 or 5
/// times a power of ten.
[[nodiscard]] std::vector<double> round_marks(double low, double high, std::size_t most);
/// Words of one of them, with as many digits as tell it from the next.
[[nodiscard]] std::string mark_text(double mark, const std::vector<double>& marks);

/// Room that a legend takes below a picture.
struct LegendSpace {
    std::uint32_t width = 0;  ///< at least, pixels
    std::uint32_t height = 0; ///< pixels
};
/// That below a picture of so many pixels of height, so that draw_legend() has room and covers nothing of it.
[[nodiscard]] LegendSpace legend_space(std::uint32_t height);

/// Draws a title and a scale with marks into the lower left of `srgb`.
/// @param beyond  whether values lie below and above the scale: < and > at its ends say so
/// @return whether there was room for it
bool draw_legend(Picture& picture, const ColourScale& scale, std::string_view title,
                 const std::array<bool, 2>& beyond = {false, false});

} // namespace hemi
