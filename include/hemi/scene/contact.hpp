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

} // namespace hemi
