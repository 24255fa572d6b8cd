#pragma once

#include "hemi/core/names.hpp"
#include "hemi/engine/baselines.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/engine/point_rows.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "hemi/engine/visibility_weighted.hpp"
#include "hemi/matrix/provenance.hpp"
#include "hemi/matrix/repair.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace hemi {

/// Where far sources of light stand together in clusters, see SourceClusters.
enum class Clusters {
    off,       ///< nowhere
    automatic, ///< where the pairs of all patches do not fit into the memory
    on,        ///< in any scene
};

/// Words of Clusters.
template <>
struct Names<Clusters> {
    /// Every value with its word.
    static constexpr NamedValue<Clusters> table[] = {
        {Clusters::off, "off"}, {Clusters::automatic, "auto"}, {Clusters::on, "on"}};
};

/// How form factors are wanted. An empty optional is the preset's own, or the method's own.
struct FactorSettings {
    Preset preset = Preset::standard;         ///< of hemicubes
    Method method = Method::hemicube;         ///< hemicubes, or a baseline method
    std::optional<std::uint32_t> resolution;  ///< texels along a hemicube edge; cells of `hemisphere`
    std::optional<std::uint32_t> eye_points;  ///< sample points for every patch: 1, 4, 9 … 64
    std::optional<std::uint32_t> shadow_rays; ///< for every partly hidden pair
    std::optional<std::uint32_t> rays;        ///< of `montecarlo`, a patch
    std::optional<std::uint64_t> seed;        ///< of the hemicubes' rotations and of rays
    bool merge_lattices = true;               ///< draw coplanar lattices of patches as one polygon
    /// What is enforced on F; empty: reciprocity and closure where factors have visibility, else nothing.
    std::optional<Repair> repair;
    bool estimate_error = true;        ///< computes better rows of a sample, about a tenth of the work
    Clusters clusters = Clusters::off; ///< of far sources; not every use of form factors can have them
    double cluster_error = 1e-3; ///< what clusters may change the light that is gathered by, relative, rms
    std::optional<std::uint64_t> max_memory; ///< bytes; empty: 80 % of what is free
    /// Device and workers. An empty worker_program stands for find_worker_program() here.
    EngineSettings engine;
};

/// What changes rows, as it follows from the settings and the size of a scene.
struct RowPlan {
    HemicubeSettings hemicube; ///< of hemicubes
    /// Unoccluded factors times visibility; empty: texels alone (`plain`).
    std::optional<VisibilityWeightedSettings> weighted;
};
/// What a preset and what was set over it make of a scene of `patches` patches. Where patches are few and
/// large, sample points matter most; where they are many and small, texels do: presets share a number of
/// hemicubes out among the patches.
[[nodiscard]] RowPlan plan_rows(const FactorSettings& settings, std::uint32_t patches);
/// The same where far patches are seen in clusters, which many patches make up for single ones: fewer sample
/// points are enough, no pair gets shadow rays, and what is hidden or in full view as a whole is told so.
[[nodiscard]] RowPlan plan_clustered_rows(const FactorSettings& settings, std::uint32_t patches);
/// The same for a baseline method.
/// @throws InvalidArgument if the method is hemicube
[[nodiscard]] BaselineSettings plan_baseline(const FactorSettings& settings);

/// What the rows will come from, but for the renderer.
[[nodiscard]] Provenance provenance_of(const FactorSettings& settings, std::uint32_t patches);

/// Bytes that form factors may take: max_memory, else 80 % of the memory that the system says is available.
[[nodiscard]] std::uint64_t memory_limit(const FactorSettings& settings);

/// What computes rows of form factors by these settings: plain hemicubes, or a baseline method.
/// @param mesh      must outlive it
/// @param settings  how, where and by how many
/// @throws as make_hemicube_engine() and make_baseline()
[[nodiscard]] std::unique_ptr<RowProvider> make_row_provider(const PatchMesh& mesh,
                                                             const FactorSettings& settings);
/// What computes rows of visibility, on the settings' device with their workers.
/// @param mesh      must outlive it
/// @param hemicube  what changes the rows
/// @param settings  device and workers
/// @throws as make_visibility_engine()
[[nodiscard]] std::unique_ptr<VisibilityProvider> make_visibility_provider(const PatchMesh& mesh,
                                                                           const HemicubeSettings& hemicube,
                                                                           const FactorSettings& settings);
/// The same from points, see make_point_visibility_engine(); not shared out among ranks, since
/// compute_point_rows() does that.
[[nodiscard]] std::unique_ptr<VisibilityProvider>
make_point_visibility_provider(const PatchMesh& mesh, std::span<const SurfacePoint> points,
                               const HemicubeSettings& hemicube, const FactorSettings& settings,
                               DirectionMeasure measure = DirectionMeasure::projected_solid_angle);

} // namespace hemi
