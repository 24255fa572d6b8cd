#pragma once

#include "engine/visibility_weighted/visibility_sample.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace hemi {

/// For every patch the run of patches around it in the mesh's order that lie beside it in about the same
/// plane: where no texel covers the patch, their samples stand in for its own.
///
/// For meshes whose surfaces are one patch each, such as triangulated models. The patches of a subdivided
/// surface were pooled already, on their grid, by VisibilityAccumulator.
class CoplanarNeighbours {
public:
    /// Patches either way that may be neighbours.
    static constexpr std::uint32_t reach = 8;

    explicit CoplanarNeighbours(const PatchMesh& mesh);

    /// The mean of the nearest known samples before and after j, as one that rests on a single texel; unknown
    /// if no neighbour is known.
    /// @param row  samples as one patch has them, at least of the neighbours: any type with row[patch]
    template <class Row>
    [[nodiscard]] VisibilitySample stand_in(const Row& row, std::uint32_t j) const {
        const std::uint32_t farthest = std::max(j - first_[j], end_[j] - 1 - j);
        for (std::uint32_t k = 1; k <= farthest; ++k) {
            const VisibilitySample before = j >= first_[j] + k ? row[j - k] : VisibilitySample();
            const VisibilitySample after = j + k < end_[j] ? row[j + k] : VisibilitySample();
            if (before.known() || after.known()) {
                const double weight = (before.known() ? 1.0 : 0.0) + (after.known() ? 1.0 : 0.0);
                const double share =
                    ((before.known() ? before.share() : 0.0) + (after.known() ? after.share() : 0.0)) /
                    weight;
                return {static_cast<float>(share), 1};
            }
        }
        return {};
    }

private:
    std::vector<std::uint32_t> first_, end_; ///< run of every patch: [first, end)
};

} // namespace hemi
