#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <vector>

namespace hemi {

/// A patch with a surface so near in front of it that few sample points cannot tell what it hides. Neighbours
/// that meet the patch at its border are not meant.
struct NearSurface {
    std::uint32_t patch = 0;   ///< the patch
    std::uint32_t surface = 0; ///< the nearest one
    double gap = 0.0;          ///< its distance in patch sizes (square roots of areas), below near_gap
};

/// Surfaces nearer than this, in sizes of the patch, matter.
inline constexpr double near_gap = 0.25;

/// All patches that have one, ascending. A surface that stands on a patch, its border running through the
/// patch's inside, has a gap of about 0: the patch is partly buried. Distances are taken at 21 or 25 points
/// of a patch.
[[nodiscard]] std::vector<NearSurface> find_near_surfaces(const PatchMesh& mesh);

} // namespace hemi
