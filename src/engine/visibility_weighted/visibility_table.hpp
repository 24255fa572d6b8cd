#pragma once

#include "engine/visibility_weighted/row_index.hpp"
#include "engine/visibility_weighted/visibility_sample.hpp"
#include "hemi/core/progress.hpp"
#include "hemi/engine/visibility_provider.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Samples of one row: of all patches, or of some in two runs.
struct SampledRow {
    std::uint32_t first = 0;               ///< patch that the first run begins with
    std::uint32_t end = 0;                 ///< one past its last
    std::uint32_t second = 0;              ///< patch that the second run begins with, behind the first
    std::vector<VisibilitySample> samples; ///< of the first run, then of the second

    /// Of a patch that is in one of them.
    [[nodiscard]] VisibilitySample operator[](std::uint32_t patch) const {
        return samples[patch < end ? patch - first : patch - second + (end - first)];
    }
};

/// Rows of visibility, all at hand: a pair's two directions are in different rows. First phase of
/// compute_visibility_weighted(). Memory: 2 bytes a pair of a row and a patch.
///
/// Where ranks share the pairs, each combines those of its own rows with the patches behind them (and with
/// those that have no row), and has for that all samples of its own rows, and of the others those of its own
/// patches and what may stand in for these: 4 bytes a pair over the number of ranks.
struct VisibilityTable {
    RowIndex index;
    OwnRows own;
    std::vector<SampledRow> samples; ///< N a row, fewer of those of other ranks
    std::vector<double> mean;        ///< see mean_share(), of each row
    std::vector<double> environment; ///< e of each row
    std::vector<double> blocked;     ///< b of each row
};

/// Computes the rows of `patches`.
/// @param patches   ascending; must outlive the table
/// @param size      N
/// @param divided   whether ranks share the pairs
/// @param progress  called after every row; may be empty
/// @throws Cancelled; Error if the provider does not give each row once
[[nodiscard]] VisibilityTable sample_visibility(VisibilityProvider& visibility,
                                                std::span<const std::uint32_t> patches, std::uint32_t size,
                                                bool divided, const Progress& progress);

} // namespace hemi
