#pragma once

#include "display/colour_scale.hpp"
#include "display/smooth_surfaces.hpp"
#include "hemi/display/picture.hpp"

#include <array>
#include <span>
#include <vector>

namespace hemi {

/// `base` with a colour for every patch, display linear, to be drawn flat with linear tone mapping.
[[nodiscard]] PictureMesh painted(const PictureMesh& base, std::span<const std::array<float, 3>> colours);
/// Greys by the direction that a patch faces, so that shapes can be told.
[[nodiscard]] std::vector<std::array<float, 3>> plain_colours(const PatchMesh& mesh);
/// Colours of values, one a patch. What has none, NaN, is dark grey.
[[nodiscard]] std::vector<std::array<float, 3>>
value_colours(std::span<const double> values, const ColourScale& scale, const PatchMesh& mesh);

/// Puts what iso-lines are drawn by into `painted`: in place of the Gouraud values of the first channel,
/// which flat pictures do not show, the place of the value on the scale, see corner_values().
/// @param painted  see painted(); is changed
/// @param values   one a patch; none around what has none, NaN
void put_iso_values(PictureMesh& painted, const PatchMesh& mesh, const SmoothSurfaces& surfaces,
                    std::span<const double> values, const ColourScale& scale);
/// Where they are, for PictureSettings::iso_lines; nothing where the scale has no lines.
[[nodiscard]] std::vector<float> iso_positions(const ColourScale& scale);

} // namespace hemi
