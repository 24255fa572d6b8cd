#pragma once

#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace hemi {

/// What a stage of the work will take.
struct StageCost {
    Phase phase = Phase::visibility; ///< which one
    double seconds = 0.0;            ///< at the speed of a sample
};

/// What form factors of all patches will cost, from a sample of their rows.
struct FactorCost {
    double entries_per_row = 0.0;   ///< mean
    std::uint64_t memory = 0;       ///< bytes, while they are computed
    double seconds = 0.0;           ///< for the rows, at the sample's speed
    std::uint32_t sampled_rows = 0; ///< that were computed and thrown away
    std::string renderer;           ///< what computed them
    unsigned cores = 1;             ///< that it could use: the machine's, or `jobs` of the settings if fewer
    bool clusters = false;          ///< whether far patches would be seen in clusters
    std::vector<StageCost> stages;  ///< in their order; of the rows alone unless all were asked for

    /// Of all stages.
    [[nodiscard]] double all_seconds() const;
};

/// Whether far patches are seen in clusters: where that is asked for, or all pairs do not fit into the
/// memory.
/// @param mesh             N patches
/// @param settings         that its form factors are computed by
/// @param entries_per_row  mean; 0 tells of scenes that need clusters in any case
[[nodiscard]] bool needs_clusters(const PatchMesh& mesh, const FactorSettings& settings,
                                  double entries_per_row = 0.0);

/// What form factors of all patches consist of, in this order.
/// @param mesh      its patches
/// @param settings  that they are computed by
[[nodiscard]] std::vector<Phase> factor_phases(const PatchMesh& mesh, const FactorSettings& settings);

/// Computes up to 64 rows spread evenly over the patches; fewer where 64 would take more than about a second.
/// @param mesh        its patches
/// @param settings    that all rows would be computed by
/// @param all_stages  also combines pairs, finds factors and closes rows of such samples; or, where clusters
///   are needed, computes rows with these
/// @throws as make_row_provider() and make_visibility_provider(); NoDevice, GlError; Cancelled
[[nodiscard]] FactorCost measure_cost(const PatchMesh& mesh, const FactorSettings& settings,
                                      bool all_stages = false);

} // namespace hemi
