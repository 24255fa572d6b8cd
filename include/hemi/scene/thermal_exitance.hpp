#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/scene/scene.hpp"

namespace hemi {

/// Turns what a scene says of temperatures into exitance, for whoever solves for light alone: surfaces of a
/// temperature get materials of their own ("steel at 900 K") that radiate eps sigma T⁴ beside what they did,
/// in every band its share; so does the environment. Nothing thermal is left: the scene is not one for
/// heat_problem() any more.
/// @param scene        is changed
/// @param diagnostics  warned of surfaces with heat fluxes or powers, whose temperatures only solve_heat()
/// finds
void radiate_by_temperature(Scene& scene, Diagnostics& diagnostics);

} // namespace hemi
