#pragma once

#include "hemi/display/picture.hpp"

#include <string>
#include <vector>

namespace hemi {

/// One value a patch that is no light, to be shown in colours with a legend.
struct FalseColours {
    std::vector<double> values; ///< N; not a number where there is none: dark grey
    std::string title;          ///< of the legend; ASCII, and ² and °
    std::string unit;           ///< behind it; likewise
};

/// Draws values as draw_picture() draws light: from dark violet, the lowest, over blue and green to yellow,
/// the highest, in equal steps. The legend is in the lower left of `srgb` where there is room for it, from
/// 200 pixels of width and 160 of height on; `linear` has the colours alone.
/// @param mesh      its patches
/// @param shown     values of all of them
/// @param camera    as in draw_picture()
/// @param settings  size, samples, outlines and backs count
/// @param device    auto, egl, egl:N or osmesa
/// @throws InvalidArgument for another number of values, and infinite ones; as draw_picture()
[[nodiscard]] Picture draw_false_colours(const PatchMesh& mesh, const FalseColours& shown,
                                         const Camera& camera, const PictureSettings& settings,
                                         const std::string& device);

} // namespace hemi
