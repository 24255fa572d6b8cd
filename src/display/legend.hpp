#pragma once

#include "display/colour_scale.hpp"
#include "hemi/display/picture.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace hemi {

/// Round values between low and high, ascending, at most `most` and at least one: multiples of 1, 2 or 5
/// times a power of ten.
[[nodiscard]] std::vector<double> round_marks(double low, double high, std::size_t most);
/// Words of one of them, with as many digits as tell it from the next.
[[nodiscard]] std::string mark_text(double mark, const std::vector<double>& marks);

/// Draws a title and a linear scale with marks into the lower left of `srgb`.
/// @return whether there was room for it
bool draw_legend(Picture& picture, const ColourScale& scale, std::string_view title);

} // namespace hemi
