#pragma once

#include "hemi/pipeline/heat.hpp"
#include "viewer/look.hpp"
#include "viewer/viewer.hpp"

#include <string>
#include <vector>

namespace hemi::viewer {

/// The heat of a scene as it stands.
struct Heat {
    Solution solution;             ///< as heat_as_solution() has it; empty where there is a problem
    std::vector<GroupHeat> groups; ///< and all of them together
    std::string problem;           ///< why there is none
};

/// Of every condition of the scene's heat the group that has it, "walls" or "walls, ..." where several have.
[[nodiscard]] std::vector<std::string> condition_names(const ViewerInput& input);

/// Gives patches whose temperature or reflectance is no longer that of the scene the exitance of the new one.
/// @param light  of the materials, with conditions; is changed
void radiate_by_conditions(const ViewerInput& input, Light& light);

/// Solves for heat with materials as they are: emissivities are what is not reflected.
/// @param input     with form factors and heat
/// @param light     of the materials
/// @param observer  may cancel
/// @throws Cancelled
[[nodiscard]] Heat find_heat(const ViewerInput& input, const Light& light, Observer& observer);

} // namespace hemi::viewer
