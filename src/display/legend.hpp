#pragma once

#include "display/colour_scale.hpp"
#include "hemi/display/picture.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hemi {

/// A linear value by the sRGB curve, 8 bits. Source: IEC 61966-2-1.
[[nodiscard]] std::uint8_t srgb_of(float linear);
/// Words of one of round_marks(), with as many digits as tell it from the next.
[[nodiscard]] std::string mark_text(double mark, const std::vector<double>& marks);
/// Words of one of ColourScale::marks() where these are no round ones, to a tenth of the least step.
[[nodiscard]] std::string level_text(double level, const std::vector<double>& marks);
/// Whether a line on that colour has to be light; as picture.frag draws iso-lines.
/// @param linear  display linear
[[nodiscard]] bool is_dark_colour(const std::array<float, 3>& linear);

/// Draws a title and a scale with marks, bands and lines into the lower left of `srgb`.
/// @param beyond  whether values lie below and above the scale: < and > at its ends say so
/// @param below   legends that it stands above
/// @return whether there was room for it
bool draw_legend(Picture& picture, const ColourScale& scale, std::string_view title,
                 const std::array<bool, 2>& beyond = {false, false}, std::uint32_t below = 0);

/// What a colour means that stands for no number.
struct KeyLine {
    std::array<float, 3> colour; ///< display linear
    std::string words;           ///< ASCII
};
/// Draws a title and what colours mean into the lower left of `srgb`.
/// @return whether there was room for it
bool draw_key(Picture& picture, std::string_view title, std::span<const KeyLine> lines);

/// The same as draw_legend() by itself, on white, to stand below a picture: `linear` is empty.
/// @param width  of the picture, pixels; a narrower one than 320 gets a legend of 320
[[nodiscard]] Picture legend_strip(std::uint32_t width, const ColourScale& scale, std::string_view title,
                                   const std::array<bool, 2>& beyond = {false, false});

} // namespace hemi
