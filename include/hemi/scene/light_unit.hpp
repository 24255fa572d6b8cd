#pragma once

#include "hemi/scene/scene.hpp"

#include <string>

namespace hemi {

/// Unit of a scene's exitances and radiosities: W/m² or lm/m².
[[nodiscard]] inline std::string flux_density_unit(const Scene& scene) {
    return scene.photometric ? "lm/m²" : "W/m²";
}

/// Unit of a scene's irradiances: W/m² or lx.
[[nodiscard]] inline std::string irradiance_unit(const Scene& scene) {
    return scene.photometric ? "lx" : "W/m²";
}

} // namespace hemi
