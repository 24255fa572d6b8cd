#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Which of `patches` lie face to face against another surface: their centre is on a coplanar surface that
/// faces the other way. The bottom of a box that stands on a floor is such a patch. In a closed scene it
/// looks out of the enclosure (e = 1, the floor's back being in its own plane), which is no leak. Cost:
/// surfaces times patches asked for.
[[nodiscard]] std::vector<std::uint32_t> patches_in_contact(const PatchMesh& mesh,
                                                            std::span<const std::uint32_t> patches);

/// An edge of a sheet that ends just short of another face, so that light passes between them.
struct NearContact {
    std::uint32_t sheet; ///< index of a two-sided surface
    std::uint32_t face;  ///< of the other one
    double gap;          ///< between the edge and that one, the largest along it, scene units
};

/// Edges of two-sided surfaces that end at most 1e-4 of the scene's diagonal from another surface, over which
/// the middle of the edge lies, and do not touch it (see Imprint): mostly they are meant to. The surfaces are
/// not parallel, and the edge is a hundred gaps long at least. Of a pair the first edge is told.
/// @param scene  valid
/// @return ascending by sheet, then face. Time: about N log N
[[nodiscard]] std::vector<NearContact> near_contacts(const Scene& scene);

} // namespace hemi
