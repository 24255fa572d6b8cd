#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi::cli {

struct GroupSize {
    std::uint32_t patches = 0;
    double area = 0.0;
};

/// Patches and area of every group.
/// @param areas     N areas
/// @param group_of  group of each of the N patches, below `groups`
[[nodiscard]] std::vector<GroupSize> group_sizes(std::span<const double> areas,
                                                 std::span<const std::uint32_t> group_of, std::size_t groups);
/// @param areas  of the mesh's patches
[[nodiscard]] std::vector<GroupSize> group_sizes(const PatchMesh& mesh, std::span<const double> areas);

} // namespace hemi::cli
