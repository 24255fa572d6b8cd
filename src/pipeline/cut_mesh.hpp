#pragma once

#include "hemi/scene/imprint.hpp"
#include "hemi/scene/patch_mesh.hpp"

namespace hemi {

/// The patches of a scene as read.
/// @param with_imprint  cut where faces touch, see imprint()
[[nodiscard]] inline PatchMesh cut_mesh(const Scene& scene, const Subdivision& subdivision,
                                        bool with_imprint) {
    const auto cut = with_imprint ? imprint(scene, subdivision) : std::nullopt;
    return cut ? PatchMesh(cut->scene) : PatchMesh(scene, subdivision);
}

} // namespace hemi
