#pragma once

#include "hemi/display/colour_map.hpp"
#include "hemi/display/picture.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hemi {

/// One value a patch that is no light, to be shown in colours with a legend.
struct FalseColours {
    std::vector<double> values; ///< N; not a number where there is none: dark grey
    std::string title;          ///< of the legend; ASCII, and ² and °
    std::string unit;           ///< behind it; likewise
    /// Values of the first and the last colour, ascending; none: the lowest and the highest value, or, by
    /// ColourMap::cool_warm, the same on both sides of zero.
    std::optional<std::array<double, 2>> range{};
    bool logarithmic = false; ///< equal steps of colour are equal ratios; values below 0 are at the low end
    ColourMap map = ColourMap::viridis; ///< which colours
    bool legend = true;                 ///< whether there is one
    /// Colours, of equal steps of the scale, 2 to 32; 0: they run smoothly.
    std::uint32_t bands = 0;
    /// Lines of equal values, interpolated between patches: where bands end, else at round values.
    bool iso_lines = false;
    /// Whether the values run on smoothly where one material or group ends and another begins in the same
    /// plane, and iso-lines with them.
    bool across_materials = false;
};

struct Dots;

/// Draws values as draw_picture() draws light, in the colours of a map. The legend is in the lower left of
/// `srgb` where there is room for it, from 200 pixels of width and 160 of height on; `linear` has the colours
/// alone. < and > at its ends say that there are values beyond. W/m² are told as kW/m² where there are 10,000
/// or more.
/// @param mesh      its patches
/// @param shown     values of all of them
/// @param camera    as in draw_picture()
/// @param settings  size, samples, outlines and backs count
/// @param device    auto, egl, egl:N or osmesa
/// @param dots      in the picture, with a legend above the other one; may be null
/// @throws InvalidArgument for another number of values, 1 band or more than 32, infinite ones, and a range
///   that does not ascend or,
///   where logarithmic, does not begin above 0; as draw_picture()
[[nodiscard]] Picture draw_false_colours(const PatchMesh& mesh, const FalseColours& shown,
                                         const Camera& camera, const PictureSettings& settings,
                                         const std::string& device, const Dots* dots = nullptr);

} // namespace hemi
