#pragma once

#include "hemi/core/progress.hpp"
#include "hemi/engine/delta_form_factors.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "hemi/engine/visibility_weighted.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace hemi {

class ClusterTree;

/// SurfacePoint::surface of a point anywhere in space.
inline constexpr std::uint32_t no_surface = 0xFFFFFFFF;

/// A place that receives light, on a surface or anywhere else, with a direction that it faces.
struct SurfacePoint {
    Vec3 position{0.0};         ///< scene units
    Vec3 normal{0.0, 0.0, 1.0}; ///< of unit length
    /// Index of the surface that it lies on, which hides nothing; or no_surface. Surfaces in whose plane the
    /// point lies, to rounding, hide nothing either.
    std::uint32_t surface = 0;
};

/// Visibility of the patches from points, by one hemicube each: row k is that of point k, its columns are the
/// patches. As make_visibility_engine() otherwise; eye points of the settings do not count. By the solid
/// angle, points are small spheres, whose normals do not count: two hemicubes look up and down, and all of a
/// row, its environment too, is weighed by the solid angle.
/// @param mesh      must outlive the engine
/// @param points    are read here and not kept
/// @param settings  what changes the rows
/// @param engine    device and workers
/// @param measure   of directions from the points
/// @throws InvalidArgument if a point's surface does not exist; as make_hemicube_engine()
[[nodiscard]] std::unique_ptr<VisibilityProvider>
make_point_visibility_engine(const PatchMesh& mesh, std::span<const SurfacePoint> points,
                             const HemicubeSettings& settings, const EngineSettings& engine,
                             DirectionMeasure measure = DirectionMeasure::projected_solid_angle);

/// Receives the row of point `index`: factors from it to the patches. The view is valid during the call only.
using PointRowSink = std::function<void(std::uint32_t index, const RowView& row)>;

/// Patches of a scene up to which each that no texel covers is asked for its factor from a point.
inline constexpr std::uint32_t points_ask_singly = 32768;

/// How rows of points are made.
struct PointRowOptions {
    /// That the visibility was made with.
    DirectionMeasure measure = DirectionMeasure::projected_solid_angle;
    /// Patches, with their images, up to which all are taken singly.
    std::uint32_t singly = points_ask_singly;
    /// A cluster is far where its radius is below this share of its distance from the point.
    double opening = 0.3;
    /// Clusters that columns may be, node k column N + k, of a scene without symmetry; must outlive the call.
    /// Null: columns are patches. The library's own (src/engine/clusters/cluster_tree.hpp).
    const ClusterTree* clusters = nullptr;
};

/// Factors from points to all patches, as F(k, j) = F0(k, j)·V(k, j): what a small area at the point and
/// facing along its normal sees of patch j. F0 is exact or by Gauss points (ExchangeAreas::at_point), V is
/// the visible share of the texels that j covers in the point's hemicube, with shadow rays to those few
/// patches whose share is least certain and matters most. Rows are closed: their sum, e and b make 1. Where
/// nothing of the environment is seen (as compute_visibility_weighted() has it) the factors are scaled for
/// it, else e is what is left. Rows of small spheres are shares of the full solid angle: F0 is then the exact
/// solid angle of the patch over 4 pi.
///
/// In scenes of many patches those far away are taken by clusters, as in compute_clustered(), but for bright
/// ones. What a row costs then hardly depends on N, unless columns must be patches: it is as long as patches
/// in view are many. Gathered light changes by less than 0.1 % (rms), by 0.4 % where small bright lamps are
/// strewn over curved surfaces. The visibility may tell of sets of patches there (HemicubeSettings::joint).
/// Where there are several ranks, each makes the rows of some of the points, and all get the rows of all.
/// @param visibility  see make_point_visibility_engine(); the rank's own
/// @param mesh        N patches
/// @param points      that `visibility` is of
/// @param settings    rule of F0, shadow rays a pair
/// @param enclosure   as the scene says
/// @param weights     how much each patch's light matters, N, for the choice of shadow rays; empty: all alike
/// @param sink        gets the rows, block by block in any order; not from several threads at once
/// @param progress    called after every batch of rows; may be empty
/// @param options     how
/// @throws Cancelled; InvalidArgument if `weights` or clusters do not fit
void compute_point_rows(VisibilityProvider& visibility, const PatchMesh& mesh,
                        std::span<const SurfacePoint> points, const VisibilityWeightedSettings& settings,
                        Enclosure enclosure, std::span<const double> weights, const PointRowSink& sink,
                        const Progress& progress = {}, const PointRowOptions& options = {});

} // namespace hemi
