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

/// Draws a title and a scale with marks into the lower left of `srgb`.
/// @param beyond  whether values lie below and above the scale: < and > at its ends say so
/// @param below   legends that it stands above
/// @return whether there was room for it
bool draw_legend(Picture& picture, const ColourScale& scale, std::string_view title,
                 const std::array<bool, 2>& beyond = {false, false}, std::uint32_t below = 0);

/// The same by itself, on white, to stand below a picture: `linear` is empty.
/// @param width  of the picture, pixels; a narrower one than 320 gets a legend of 320
[[nodiscard]] Picture legend_strip(std::uint32_t width, const ColourScale& scale, std::string_view title,
                                   const std::array<bool, 2>& beyond = {false, false});

} // namespace hemi
