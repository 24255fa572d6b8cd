#pragma once

#include "hemi/pipeline/radiosity.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solution.hpp"

#include <span>
#include <vector>

namespace hemi {

/// What light does at a group of patches, all channels together by their weights: means over its area, in the
/// exitances' unit, and powers, in that unit times the square of the scene's. Of a group without patches the
/// means are not numbers.
struct GroupLight {
    double area = 0.0;       ///< scene units squared
    double exitance = 0.0;   ///< of its own
    double irradiance = 0.0; ///< not a number where a patch of the group reflects nothing and none was found
    double radiosity = 0.0;  ///< what leaves: its own, and what is reflected
    double least = 0.0;      ///< of its patches' radiosities
    double most = 0.0;       ///< likewise
    double received = 0.0;   ///< power that arrives; not a number where the irradiance is none
    double leaving = 0.0;    ///< power that leaves
};

/// Of every group of the mesh; a last one of all patches.
/// @param mesh      N patches
/// @param values    of the patches
/// @param solution  of the mesh; with its irradiance, where that was found: else it is what was reflected, by
///   the reflectance
/// @param weights   what each channel counts, channels, such as flux_weights(); empty: 1
/// @throws InvalidArgument for values, weights or a solution of another mesh
[[nodiscard]] std::vector<GroupLight> group_light(const PatchMesh& mesh, const PatchValues& values,
                                                  const Solution& solution,
                                                  std::span<const double> weights = {});

} // namespace hemi
