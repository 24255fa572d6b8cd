#pragma once

#include "hemi/engine/row_provider.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <span>

namespace hemi {

/// What the hemicubes of patch i found of the visibility of the other patches, seen but not owned. It has an
/// entry for every patch j whose front would be in view if nothing hid it, hidden or not.
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
};

/// A way to compute rows of visibility. @see make_visibility_engine
using VisibilityProvider = BasicRowProvider<VisibilityRow>;
/// Receives one row of visibility.
using VisibilitySink = VisibilityProvider::Sink;

} // namespace hemi
