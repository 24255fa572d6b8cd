#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// Where what `patches` lose to the environment goes: for each the mean direction, of unit length, of those
/// of 65,536 cosine-weighted rays from the patch that meet nothing. Nothing where no more than one escapes.
/// It points to a gap in an enclosure; of several gaps, between them.
[[nodiscard]] std::vector<std::optional<Vec3>> leak_directions(const PatchMesh& mesh,
                                                               std::span<const std::uint32_t> patches);

} // namespace hemi
