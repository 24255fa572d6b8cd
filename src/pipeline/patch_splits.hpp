#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// How patches are cut where their size errs: across the way in which the light changes, so that a strip
/// whose light changes from one long edge to the other gets two strips. Only where it changes both ways there
/// are four parts.
class PatchSplits {
public:
    /// @param mesh  N patches; outlives this
    explicit PatchSplits(const PatchMesh& mesh);

    /// How to cut a patch: by how much the values of corners bend along u and v from it to the patches beside
    /// it on its surface. Where it has no such neighbours along one of these, by what they do not say of its
    /// own bend; where it has none at all, by its shape.
    /// @param corners   of all patches: channel c of corner k of patch i at [(i·4 + k)·channels + c]
    /// @param channel   that counts
    /// @param bend      of the patch in this channel, see vertex_bends()
    [[nodiscard]] PatchSplit across_bend(std::uint32_t patch, std::span<const float> corners,
                                         std::uint32_t channels, std::uint32_t channel, double bend) const;

    /// Adds what keeps patches along a common edge at most one step apart in size, and none of them slender.
    /// @param splits  in any order, a patch once; ascending afterwards
    void grade(std::vector<PatchSplit>& splits) const;

private:
    /// Where a patch lies on its surface, in cells as fine as the finest patch there.
    struct Place {
        std::array<std::int64_t, 2> first; ///< along u and v
        std::array<std::int64_t, 2> width;
    };
    [[nodiscard]] const GridPart& part(std::uint32_t patch) const { return parts_[patch]; }
    [[nodiscard]] bool is_triangle(std::uint32_t patch) const;
    [[nodiscard]] bool halves_are_slender(std::uint32_t patch, std::size_t way) const;
    [[nodiscard]] Place place(std::uint32_t patch) const;
    [[nodiscard]] std::optional<double> bend_along(std::uint32_t patch, std::size_t way,
                                                   std::span<const float> corners, std::uint32_t channels,
                                                   std::uint32_t channel) const;
    [[nodiscard]] std::vector<std::uint32_t> larger_beside(std::uint32_t patch, std::size_t way) const;

    const PatchMesh& mesh_;
    std::vector<GridPart> parts_;                      ///< of all patches
    std::vector<std::array<std::uint32_t, 2>> finest_; ///< levels on every surface, along u and v
    /// Of vertices by surface, side and place the first and the last corner there, as i·4 + k: on both sides
    /// of what stands there.
    std::map<std::array<std::int64_t, 4>, std::array<std::size_t, 2>> corners_at_;
    std::map<std::array<std::uint32_t, 4>, std::uint32_t> by_cell_; ///< patches on fronts
};

} // namespace hemi
