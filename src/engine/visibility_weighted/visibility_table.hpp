#pragma once

#include "engine/visibility_weighted/row_index.hpp"
#include "engine/visibility_weighted/visibility_sample.hpp"
#include "hemi/core/progress.hpp"
#include "hemi/engine/visibility_provider.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Rows of visibility, all at hand: a pair's two directions are in different rows. First phase of
/// compute_visibility_weighted(). Memory: 2 bytes a pair of a row and a patch.
struct VisibilityTable {
    RowIndex index;
    std::vector<std::vector<VisibilitySample>> samples; ///< N a row
    std::vector<double> environment;                    ///< e of each row
    std::vector<double> blocked;                        ///< b of each row
};

/// Computes the rows of `patches`.
/// @param patches   ascending; must outlive the table
/// @param size      N
/// @param progress  called after every row; may be empty
/// @throws Cancelled; Error if the provider does not give each row once
[[nodiscard]] VisibilityTable sample_visibility(VisibilityProvider& visibility,
                                                std::span<const std::uint32_t> patches, std::uint32_t size,
                                                const Progress& progress);

} // namespace hemi
