#pragma once

#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include <span>
#include <vector>

namespace hemi {

/// Gouraud values: a value for every corner of every patch, PatchMesh order, 4 corners a patch (the fourth
/// unused for triangles), `channels` values a corner: [(patch·4 + corner)·channels + c].
///
/// A corner's value is the area-weighted mean over the patches that meet there and belong to the same smooth
/// surface: same material, same group, normals within 20°, and not covered. Corners of covered patches take
/// what uncovered patches give them, and else the mean of the nearest corners that have a value.
/// Patches that touch a corner in the middle of one of their edges count as meeting there; where they are
/// parts of the same surface (PatchMesh::parts), the corner has what the longer edge shows there.
/// @param mesh      N patches
/// @param channels  numbers a patch
/// @param values    N·channels, of channel c of patch i at [i·channels + c]
/// @param blocked   b_i per patch, or empty; a patch with b_i > buried_above is covered.
[[nodiscard]] std::vector<float> corner_values(const PatchMesh& mesh, std::uint32_t channels,
                                               std::span<const double> values,
                                               std::span<const double> blocked);

} // namespace hemi
