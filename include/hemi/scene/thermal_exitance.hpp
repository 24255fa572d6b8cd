#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include <span>
#include <vector>

namespace hemi {

/// Turns what a scene says of temperatures into exitance, for whoever solves for light alone: surfaces of a
/// temperature get materials of their own ("steel at 900 K") that radiate eps sigma T⁴ beside what they did,
/// in every band its share; so does the environment. Nothing thermal is left: the scene is not one for
/// heat_problem() any more.
/// @param scene        is changed
/// @param diagnostics  warned of surfaces with heat fluxes or powers, whose temperatures only solve_heat()
/// finds
void radiate_by_temperature(Scene& scene, Diagnostics& diagnostics);

/// Reflectance of every patch, at its temperature where its material has emissivities by temperature: as
/// patch_values() has values.
/// @param mesh         N patches
/// @param materials    those of the scene, by the surfaces' index; all with the same number of channels
/// @param temperature  K, N values, those that are no numbers unknown; or none: all are unknown
[[nodiscard]] std::vector<double> reflectances_at(const PatchMesh& mesh, std::span<const Material> materials,
                                                  std::span<const double> temperature);

} // namespace hemi
