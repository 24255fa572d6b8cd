#pragma once

#include "hemi/scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
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

/// Shares of luminance of the channels red, green and blue, 0.2126, 0.7152 and 0.0722, in any order; 0 of
/// others. Source: IEC 61966-2-1.
/// @return a value a channel; empty where one of the three is missing
[[nodiscard]] inline std::vector<double> luminance_weights(std::span<const std::string> channels) {
    constexpr std::array<std::pair<const char*, double>, 3> shares{
        {{"red", 0.2126}, {"green", 0.7152}, {"blue", 0.0722}}};
    std::vector<double> weights(channels.size(), 0.0);
    for (const auto& [name, share] : shares) {
        const auto found = std::find(channels.begin(), channels.end(), name);
        if (found == channels.end()) {
            return {};
        }
        weights[static_cast<std::size_t>(found - channels.begin())] = share;
    }
    return weights;
}

/// What each channel counts in fluxes of all of them together: in lumens and red, green and blue the shares
/// of luminance, so that a flux that is the same in all of them is that many lumens; else 1.
[[nodiscard]] inline std::vector<double> flux_weights(const Scene& scene) {
    std::vector<double> weights =
        scene.photometric ? luminance_weights(scene.channels) : std::vector<double>();
    return weights.empty() ? std::vector<double>(scene.channels.size(), 1.0) : weights;
}

} // namespace hemi
