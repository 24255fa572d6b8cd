#pragma once

#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

namespace hemi {

/// Joins triangles, one after the other, that are halves of a convex quadrilateral, where a patch size would
/// cut them into more patches than it. They are alike in group, material, condition and sides. A
/// quadrilateral that was joined begins at the first triangle's first corner, and says so: Surface::joins.
/// @param scene        valid
/// @param subdivision  where it or the scene cuts surfaces by a patch size, they are joined, and else not
void join_triangle_pairs(Scene& scene, const Subdivision& subdivision);

} // namespace hemi
