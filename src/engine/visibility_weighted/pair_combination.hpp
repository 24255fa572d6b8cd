#pragma once

#include "engine/visibility_weighted/pair_visibility.hpp"
#include "engine/visibility_weighted/row_index.hpp"
#include "engine/visibility_weighted/visibility_table.hpp"
#include "hemi/core/progress.hpp"
#include "hemi/scene/image_mesh.hpp"

#include <cstdint>
#include <vector>

namespace hemi {

/// V of all pairs of a row and a patch or an image of one; where both patches have a row, V is the same in
/// both, see ImageMesh::counterpart(). Second phase of compute_visibility_weighted(). Memory: 2 bytes a pair
/// of a row and a patch.
struct PairTable {
    RowIndex index;
    OwnRows own;
    /// N a row. Where ranks share the pairs, of their own rows alone, and of the patches before these only
    /// those that have no row or an own one.
    std::vector<std::vector<PairVisibility>> visibility;
    std::vector<double> environment; ///< e of each row, as measured
    std::vector<double> blocked;     ///< b of each row, as measured
};

/// Combines what both ends of every pair saw of each other, and adds shadow rays where that is uncertain.
/// @param samples      taken over and released, so that at most 4 bytes a pair are in use
/// @param images       of the scene that `samples` are of
/// @param shadow_rays  a pair that is selected for them; 0: none
/// @param progress     called after every 64 rows; may be empty
/// @throws Cancelled
[[nodiscard]] PairTable combine_pairs(VisibilityTable samples, const ImageMesh& images,
                                      std::uint32_t shadow_rays, const Progress& progress);

} // namespace hemi
