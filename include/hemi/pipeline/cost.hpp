#pragma once

#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <string>

namespace hemi {

/// What form factors of all patches will cost.
struct FactorCost {
    double entries_per_row = 0.0; ///< mean
    std::uint64_t memory = 0;     ///< bytes, while they are computed
    double seconds = 0.0;         ///< for the rows
    std::string renderer;         ///< empty: a rule of thumb, nothing was measured
    unsigned cores = 1;           ///< that the rule of thumb counts on
};
/// A rule of thumb for software OpenGL, from scenes of 2,000 to 20,000 patches.
[[nodiscard]] FactorCost estimate_cost(const PatchMesh& mesh, const FactorSettings& settings);
/// The same from 64 rows that are computed and thrown away.
/// @throws NoDevice, GlError; Cancelled
[[nodiscard]] FactorCost measure_cost(const PatchMesh& mesh, const FactorSettings& settings);

} // namespace hemi
