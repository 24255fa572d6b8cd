#pragma once

#include "display/colour_scale.hpp"
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

} // namespace hemi
