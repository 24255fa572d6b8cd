#pragma once

#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solution.hpp"

#include <optional>
#include <vector>

namespace hemi {

/// How much is looked at to estimate what the patches' size does.
struct PatchSizeSample {
    double effort = 1.0; ///< times the usual number of patches in the sample
    bool groups = true;  ///< whether errors of groups are wanted
};

/// What a radiosity is off by because patches have a size, estimated.
///
/// A sample of patches, more of them where the radiosity changes fast, is cut in four. The light of the
/// solution is gathered at each quarter by a row of its own: f(s) = B_i + rho (G(s) - mean of G over i). The
/// iterated solution converges twice as fast as the solution itself, so it stands for the exact field. As a
/// constant a patch errs by f - B_i; four means leave out a quarter of the variance of a linear field, which
/// is added. As a picture shows it, it errs by f less the interpolated vertex values; where these were
/// gathered (Solution::vertex_radiosity), f also has the light that comes of the radiosity's variation within
/// the patches, which a gather leaves out. Patches of the sample count by the inverse of their probability.
///
/// The mean irradiance of a group errs by the sum of A (G(s) - G_i) (h_i + rho_i z(s)) over all s in patches
/// i, over the group's area. h is 1 on the group and else 0; z is the importance of light that leaves s for
/// the group: by an adjoint solution a group, gathered with the same rows. To what the sample shows its own
/// standard error is added. Patches that reflect nothing are not in the sample: of a group of such patches
/// only what wrong light from others does is known.
///
/// What comes straight from sun and sky is found for each quarter as for a patch. A quarter that the edge of
/// a shadow of the sun crosses counts as two even parts, unless the sun is wider than a degree; where patches
/// are as small as half-shadows are wide, that is too much.
///
/// Where far patches stand in clusters (FormFactorMatrix::clusters()), only the sample and what is near it is
/// cut, and the quarters' rows have clusters, too; errors of groups are not estimated then, and the observer
/// is told.
///
/// Not included: errors of form factors; what the errors of other patches change in a patch's mean, which is
/// of second order; whatever four rows do not see, such as light that falls through a gap between them.
/// Quarters under other geometry do not count; of those that something stands on partly, the rest does.
/// Memory: up to 768 rows (times the sample's effort) over 4 N patches, 13 bytes an entry, and 8 bytes a
/// patch, channel and group of up to 64; with clusters less than 1 kB a patch. Source: I. H. Sloan,
/// "Improvement by iteration for compact operator equations", Mathematics of Computation 30, 1976; M. F.
/// Cohen et al., "An Efficient Radiosity Approach for Realistic Image Synthesis", IEEE CG&A 6, 1986 (patches
/// as sources, their parts as receivers); B. Smits, J. Arvo, D. Salesin, "An Importance-Driven Radiosity
/// Algorithm", SIGGRAPH 1992.
/// @param scene     what the mesh was made of; gives reflectances
/// @param mesh      N patches
/// @param factors   N rows, those that the solution rests on
/// @param solution  radiosity, exitance and back-face shares of the mesh
/// @param settings  sample points and texels of the quarters' rows, which are unoccluded factors times
///   visibility whatever the preset; device, workers and the limit of memory
/// @param observer  gets progress and may cancel; gets a warning where the memory does not allow it
/// @param sample    how much is looked at
/// @return nothing where nothing is reflected, or where memory is short
/// @throws InvalidArgument if the solution is of another mesh; as make_visibility_engine(); Cancelled
[[nodiscard]] std::optional<PatchSizeError>
estimate_patch_size_error(const Scene& scene, const PatchMesh& mesh, const FormFactors& factors,
                          const Solution& solution, const FactorSettings& settings,
                          Observer& observer = no_observer(), const PatchSizeSample& sample = {});

/// Bytes that estimate_patch_size_error() takes at most.
/// @param mesh      whose rows are without clusters
/// @param sample    as there; without errors of groups it takes less
/// @param channels  of the solution
[[nodiscard]] std::uint64_t patch_size_error_bytes(const PatchMesh& mesh, const PatchSizeSample& sample,
                                                   std::uint32_t channels);

/// The same where the solution must not be lost: what cannot be estimated is told to the observer as a
/// warning.
/// @return nothing then, too
/// @throws Cancelled
[[nodiscard]] std::optional<PatchSizeError>
try_estimate_patch_size_error(const Scene& scene, const PatchMesh& mesh, const FormFactors& factors,
                              const Solution& solution, const FactorSettings& settings, Observer& observer);

/// All of what a solution is off by, from estimates of its parts, which are taken to be independent.
struct SolutionError {
    FieldError vertices;        ///< of the interpolated vertex values that pictures show
    FieldError field;           ///< of one constant for each patch
    std::vector<double> groups; ///< of the mean irradiance of every group, relative to it; see GroupError
    double patch_size = 0.0;    ///< the part of `vertices.rms` that the patches' size brings
    double factors = 0.0;       ///< the part of the form factors
    double solver = 0.0;        ///< about what the solver left, at worst
};
/// @return nothing where an estimate is missing that it needs, or where reflectance times row sum reaches 1
[[nodiscard]] std::optional<SolutionError> solution_error(const Solution& solution);

} // namespace hemi
