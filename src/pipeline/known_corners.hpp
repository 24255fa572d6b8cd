#pragma once

#include "hemi/pipeline/vertex_gather.hpp"
#include "hemi/solver/solution.hpp"

#include <cstdint>
#include <span>

namespace hemi {

/// What corners of patches show that were not cut when others were: what they did, with as much more or less
/// of reflected light as their patch has, if that is less than twice or half as much. Other patches' corners
/// are not known.
/// @param before   of the mesh before, with Solution::vertex_radiosity; without these nothing is known
/// @param now      of the mesh
/// @param parents  of each of its patches, the one of the mesh before that it lies in
[[nodiscard]] KnownCorners known_corners(const Solution& before, const Solution& now,
                                         std::span<const std::uint32_t> parents);

} // namespace hemi
