#pragma once

#include "hemi/engine/point_rows.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solution.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace hemi {

/// The radiosity of a scene at points of its surfaces, which solutions on coarser meshes are judged by.
struct RadiosityReference {
    std::vector<SurfacePoint>
        points;                    ///< on what reflects and is not covered, more where the light changes fast
    std::vector<double> areas;     ///< that every point stands for
    std::uint32_t channels = 0;    ///< of the scene
    std::vector<double> radiosity; ///< of channel c at point k at [k·channels + c]
    std::vector<double> reflected; ///< the same of what is reflected there, B - E
    std::uint32_t patches = 0;     ///< of the mesh that the light was solved on
    double own_error = 0.0;        ///< about its own, rms relative to what is reflected, the worst channel
    double seconds = 0.0;          ///< that it took
};

/// Solves the light on a fine mesh and gathers it at points by a row of factors for each, so that the
/// radiosity there converges twice as fast as that of the patches (the iterated solution), and no point
/// depends on the shape of the patch around it.
///
/// Rows are those of `fast` with half as many texels again along an edge, and with shadow rays; those of the
/// points, by which most light comes, have three times the texels of `default` along an edge and four times
/// its shadow rays. Rotations and rays are others than those of the settings. The reference's own error has
/// two parts: of the patches' size, from what the gathered light changes by when the radiosity is averaged
/// over the coarser patches, taken to go like that size to the power of 1.5, as it does where walls touch (in
/// smooth light, the square); and of the points' rows, from what the
/// light changes by at one point in four when it is gathered again with other rotations and rays.
/// @param scene     materials, environment, enclosure
/// @param mesh      finer than those that are to be judged
/// @param coarser   the finest of these, or one of about its size
/// @param settings  device, workers, memory
/// @param count     about so many points
/// @param observer  gets progress and may cancel
/// @throws InvalidArgument if nothing reflects, or for a sun or a sky, whose light the points would lack; as
/// compute_form_factors() and solve_radiosity()
/// Source: I. H. Sloan, "Improvement by iteration for compact operator equations", Mathematics of Computation
/// 30, 1976.
[[nodiscard]] RadiosityReference find_radiosity_reference(const Scene& scene, const PatchMesh& mesh,
                                                          const PatchMesh& coarser,
                                                          const FactorSettings& settings, std::uint32_t count,
                                                          Observer& observer = no_observer());

/// What a solution is off by, see SolutionError for the definitions.
struct RadiosityError {
    FieldError vertices; ///< of the interpolated vertex values that pictures show
    FieldError field;    ///< of one constant for each patch
};

/// Compares a solution with a reference at the reference's points, those left out that lie on covered patches
/// of the solution's mesh or on none.
/// @param mesh       N patches
/// @param solution   of the mesh; vertices are as gathered, or means over the patches that meet there
/// @param reference  of the same scene
/// @return nothing where no light is reflected at any of these points, or there are none
/// @throws InvalidArgument if the solution has other channels or is of another mesh
[[nodiscard]] std::optional<RadiosityError> judge_radiosity(const PatchMesh& mesh, const Solution& solution,
                                                            const RadiosityReference& reference);

} // namespace hemi
