#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/engine/row_provider.hpp"
#include "hemi/matrix/provenance.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace hemi {

/// Settings that change the rows.
struct BaselineSettings {
    Method method = Method::direct; ///< how F is found; not hemicube
    std::uint32_t rays = 16384;     ///< montecarlo: rays a patch; powers of two are best
    std::uint32_t resolution = 256; ///< hemisphere: grid cells along the disc's diameter
    std::uint64_t seed = 0;         ///< montecarlo, hemisphere
};

/// Patches above which baseline methods are refused: they would take hours.
inline constexpr std::uint32_t max_baseline_patches = 4000;

/// Rows by one of the field's other methods, to measure the hemicube against, on all cores; the same bits
/// whatever their number. None is meant to be fast.
///
/// direct: double area integration. Closed forms for rectangles that are parallel or perpendicular to each
/// other (Howell's C-13 and C-15), otherwise Lambert's point factor integrated adaptively over the row's
/// patch, to 1e-6. Unoccluded. Source: J. R. Howell, "A Catalog of Radiation Heat Transfer Configuration
/// Factors"; G. N. Walton, NISTIR 6925, 2002.
///
/// contour: both contours by Stokes' theorem: one integral in closed form, the other by one Gauss rule of 10
/// points; edges that touch or coincide, and near parallel ones, in closed form. Unoccluded. Loses digits
/// where edges that are neither parallel nor touching come near each other. Source: E. M. Sparrow, J. Heat
/// Transfer 85, 1963; S. Mazumder, M. Ravishankar, Int. J. Heat Mass Transfer 55, 2012.
///
/// montecarlo: rays from Sobol points of the patch in cosine-weighted Sobol directions, with occlusion; back
/// faces block. The error falls as rays^-0.6 to rays^-0.7. Source: T. J. V. Malley, "A Shading Method for
/// Computer Generated Images", 1988 (directions); J. R. Howell, "The Monte Carlo Method in Radiative Heat
/// Transfer", J. Heat Transfer 120, 1998.
///
/// hemisphere: Nusselt's unit sphere about the centroid, projected to its base. A ray through every cell
/// centre of a square grid on the unit disc, turned by an angle hashed from patch and seed; with occlusion;
/// back faces block. One point a patch, as the plain hemicube. Source: W. Nusselt, "Graphische Bestimmung des
/// Winkelverhältnisses bei der Wärmestrahlung", 1928.
///
/// Where the method knows occlusion, environment and blocked shares are counted as the factors are. direct
/// and contour know none: the environment has what is missing to 1, and nothing is blocked; rows whose view
/// is obstructed then sum to more than 1.
/// @param mesh      must outlive the provider
/// @param settings  method and how much of it
/// @throws InvalidArgument for more than max_baseline_patches patches, or no rays, more than 2^31 of them,
///   or a resolution outside 1 to 16384.
[[nodiscard]] std::unique_ptr<RowProvider> make_baseline(const PatchMesh& mesh,
                                                         const BaselineSettings& settings);

/// Factors from a surface element at `point` with unit normal `normal` to every patch.
///
/// Without occlusion, Lambert's closed form. With it, that form times the share of the patch that the point
/// sees, weighted as the factor is, from 16 x 16 points of the patch; a surface in whose plane the element
/// lies does not hide.
/// @throws InvalidArgument if `normal` is not of unit length.
[[nodiscard]] std::vector<double> point_factors(const PatchMesh& mesh, const Vec3& point, const Vec3& normal,
                                                bool occlusion);

} // namespace hemi
