#pragma once

#include "engine/visibility_weighted/visibility_sample.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// For every patch the run of patches around it in the mesh's order that lie beside it in about the same
/// plane: where no texel covers the patch, their samples stand in for its own.
///
/// For meshes whose surfaces are one patch each, such as triangulated models. The patches of a subdivided
/// surface were pooled already, on their grid, by VisibilityAccumulator.
class CoplanarNeighbours {
public:
    explicit CoplanarNeighbours(const PatchMesh& mesh);

    /// The mean of the nearest known samples before and after j, as one that rests on a single texel; unknown
    /// if no neighbour is known.
    /// @param row  samples of all patches, as one patch has them
    [[nodiscard]] VisibilitySample stand_in(std::span<const VisibilitySample> row, std::uint32_t j) const;

private:
    std::vector<std::uint32_t> first_, end_; ///< run of every patch: [first, end)
};

} // namespace hemi
