#pragma once

#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solution.hpp"

#include <span>
#include <vector>

namespace hemi {

/// Mean square error of interpolated values over the square of a patch's bend, see vertex_bends(). A field
/// that is quadratic over a rectangle, a x² + b y² in units of its sides, has a bend of (a + b) / 6; bilinear
/// interpolation errs by that on the mean over each quarter, and by (a + b)² / 36 + (a² + b²) / 180 in the
/// mean square. Taken for a and b that vary independently about 0.
constexpr double square_error_of_bend = 1.2;

/// How far the mean of a patch's gathered corner values is above what the patch has on the mean where nothing
/// stands on it: by this the radiosity bends within the patch, and what is interpolated between the corners
/// errs on the mean.
/// @param mesh      N patches
/// @param solution  of the mesh, with Solution::vertex_radiosity
/// @param visible   see visible_radiosity()
/// @return channel c of patch i at [i·channels + c]
[[nodiscard]] std::vector<double> vertex_bends(const PatchMesh& mesh, const Solution& solution,
                                               std::span<const double> visible);

} // namespace hemi
