#pragma once

#include "hemi/scene/imprint.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/triangle_pairs.hpp"

namespace hemi {

/// The patches of a scene as read, with pairs of triangles joined where the size of the patches asks for it.
/// @param with_imprint  cut where faces touch, see imprint()
[[nodiscard]] inline PatchMesh cut_mesh(Scene scene, const Subdivision& subdivision, bool with_imprint) {
    join_triangle_pairs(scene, subdivision);
    const auto cut = with_imprint ? imprint(scene, subdivision) : std::nullopt;
    return cut ? PatchMesh(cut->scene) : PatchMesh(scene, subdivision);
}

} // namespace hemi
