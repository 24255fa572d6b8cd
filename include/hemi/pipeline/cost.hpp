#pragma once

#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <string>

namespace hemi {

/// What form factors of all patches will cost, from a sample of their rows.
struct FactorCost {
    double entries_per_row = 0.0;   ///< mean
    std::uint64_t memory = 0;       ///< bytes, while they are computed
    double seconds = 0.0;           ///< for the rows, at the sample's speed
    std::uint32_t sampled_rows = 0; ///< that were computed and thrown away
    std::string renderer;           ///< what computed them
    unsigned cores = 1;             ///< that it could use: the machine's, or `jobs` of the settings if fewer
};
/// Computes up to 64 rows spread evenly over the patches; fewer where 64 would take more than about a second.
/// @throws as make_row_provider() and make_visibility_provider(); NoDevice, GlError; Cancelled
[[nodiscard]] FactorCost measure_cost(const PatchMesh& mesh, const FactorSettings& settings);

} // namespace hemi
