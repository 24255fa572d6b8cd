#pragma once

#include "hemi/scene/scene.hpp"

#include <string>
#include <vector>

namespace hemi {

/// Unit of a scene's exitances and radiosities: W/m² or lm/m².
[[nodiscard]] inline std::string flux_density_unit(const Scene& scene) {
    return scene.photometric ? "lm/m²" : "W/m²";
}

/// Unit of a scene's irradiances: W/m² or lx.
[[nodiscard]] inline std::string irradiance_unit(const Scene& scene) {
    return scene.photometric ? "lx" : "W/m²";
}

/// What each channel counts in fluxes of all of them together: in lumens and red, green and blue the shares
/// of luminance, 0.2126, 0.7152 and 0.0722, so that a flux that is the same in all of them is that many
/// lumens; else 1. Source of the shares: IEC 61966-2-1.
[[nodiscard]] inline std::vector<double> flux_weights(const Scene& scene) {
    const std::vector<std::string> colours{"red", "green", "blue"};
    if (scene.photometric && scene.channels == colours) {
        return {0.2126, 0.7152, 0.0722};
    }
    return std::vector<double>(scene.channels.size(), 1.0);
}

} // namespace hemi
