#include "pipeline/visible_radiosity.hpp"

#include "display/vertex_colours_detail.hpp"
#include "hemi/scene/near_surface.hpp"

namespace hemi {

std::vector<double> visible_radiosity(const PatchMesh& mesh, const SmoothSurfaces& surfaces,
                                      std::span<const std::uint32_t> near, std::uint32_t channels,
                                      std::span<const double> radiosity, std::span<const double> exitance,
                                      std::span<const double> blocked) {
    std::vector<double> result(radiosity.begin(), radiosity.end());
    std::vector<std::uint32_t> covered;
    for (const std::uint32_t patch : near) {
        if (is_covered(blocked, patch)) {
            covered.push_back(patch);
            continue;
        }
        for (std::uint32_t c = 0; c < channels && !blocked.empty(); ++c) {
            const std::size_t at = std::size_t{patch} * channels + c;
            result[at] = exitance[at] + (radiosity[at] - exitance[at]) / (1.0 - blocked[patch]);
        }
    }
    if (covered.empty()) {
        return result;
    }
    const std::vector<float> corners = corner_values(mesh, surfaces, channels, result, blocked);
    for (const std::uint32_t patch : covered) {
        const std::size_t count = surfaces.corners(patch).size();
        for (std::uint32_t c = 0; c < channels; ++c) {
            double sum = 0.0;
            for (std::size_t k = 0; k < count; ++k) {
                sum += static_cast<double>(corners[(std::size_t{patch} * 4 + k) * channels + c]);
            }
            result[std::size_t{patch} * channels + c] = sum / static_cast<double>(count);
        }
    }
    return result;
}

std::vector<std::uint32_t> patches_near_surfaces(const PatchMesh& mesh) {
    std::vector<std::uint32_t> patches;
    for (const NearSurface& near : find_near_surfaces(mesh)) {
        patches.push_back(near.patch);
    }
    return patches;
}

} // namespace hemi
