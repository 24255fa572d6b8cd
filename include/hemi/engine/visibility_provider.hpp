#pragma once

#include "hemi/engine/row_provider.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Sets of patches whose visibility a row may tell by one number: those that one drawn polygon shows on one
/// side, and those of many such sides near one another.
struct PatchSets {
    std::vector<std::uint32_t> first;         ///< sets + 1: where those of a set begin in `patches`
    std::vector<std::uint32_t> patches;       ///< set by set; none of the sets that others make up
    std::vector<std::uint32_t> first_members; ///< sets + 1: where those of a set begin in `members`
    std::vector<std::uint32_t> members;       ///< of sets that others make up: these

    /// Number of sets.
    [[nodiscard]] std::uint32_t size() const noexcept {
        return first.empty() ? 0 : static_cast<std::uint32_t>(first.size() - 1);
    }
    /// Patches of a set that is not made up of others.
    [[nodiscard]] std::span<const std::uint32_t> patches_of(std::uint32_t set) const {
        return std::span(patches).subspan(first[set], first[set + 1] - first[set]);
    }
    /// The sets that make up one, none of which others make up.
    [[nodiscard]] std::span<const std::uint32_t> members_of(std::uint32_t set) const {
        return std::span(members).subspan(first_members[set], first_members[set + 1] - first_members[set]);
    }
};

/// What is known of the visibility of all patches of a set, as VisibilityRow has it of one.
struct JointVisibility {
    std::uint32_t set;   ///< of PatchSets
    float share;         ///< V
    std::uint8_t texels; ///< how many it rests on
};

/// What the hemicubes of patch i found of the visibility of the other patches, seen but not owned. It has an
/// entry for every patch j whose front would be in view if nothing hid it, hidden or not; or for a set that
/// holds it. Sets that are hidden may hold patches that look away, too.
///
/// No row of F: the shares do not sum to 1. compute_visibility_weighted() makes factors of such rows.
struct VisibilityRow {
    std::span<const std::uint32_t> columns; ///< patches j, ascending
    /// V(i, j), the share of j that nothing hides from i, in [0, 1], weighted by delta form factors; pooled
    /// over j's neighbours on the same surface where too few texels cover j.
    std::span<const float> shares;
    /// How many texels each share rests on, 1 to 254; or visibility_clear if enough texels cover the patch
    /// and none of them is hidden.
    std::span<const std::uint8_t> texels;
    double environment = 0.0; ///< e_i, share of the hemisphere, cosine-weighted, that meets nothing
    double blocked = 0.0;     ///< b_i, the same for the backs of one-sided surfaces
    /// Patches that have no entry of their own, set by set; only where HemicubeSettings::joint allows it.
    std::span<const JointVisibility> joint = {};
    const PatchSets* sets = nullptr; ///< that `joint` counts; lives as long as the provider
};

/// A way to compute rows of visibility. @see make_visibility_engine
using VisibilityProvider = BasicRowProvider<VisibilityRow>;
/// Receives one row of visibility.
using VisibilitySink = VisibilityProvider::Sink;

} // namespace hemi
