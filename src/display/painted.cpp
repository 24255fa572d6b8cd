#include "display/painted.hpp"

#include <cmath>

namespace hemi {

PictureMesh painted(const PictureMesh& base, std::span<const std::array<float, 3>> colours) {
    PictureMesh result = base;
    result.environment = {};
    for (std::size_t i = 0; i < colours.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            result.patches[i * 3 + c] = colours[i][c];
            for (std::size_t k = 0; k < 4; ++k) {
                result.corners[(i * 4 + k) * 3 + c] = colours[i][c];
            }
        }
    }
    return result;
}

std::vector<std::array<float, 3>> plain_colours(const PatchMesh& mesh) {
    const Vec3 from = glm::normalize(Vec3(0.4, -0.7, 0.6));
    std::vector<std::array<float, 3>> colours;
    colours.reserve(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const auto grey = static_cast<float>(0.45 + 0.25 * glm::dot(mesh.normal(i), from));
        colours.push_back({grey, grey, grey});
    }
    return colours;
}

std::vector<std::array<float, 3>> value_colours(std::span<const double> values, const ColourScale& scale,
                                                const PatchMesh& mesh) {
    constexpr float none_level = 0.25F;
    std::vector<std::array<float, 3>> colours = plain_colours(mesh);
    for (std::size_t i = 0; i < colours.size(); ++i) {
        if (std::isnan(values[i])) {
            for (float& channel : colours[i]) {
                channel *= none_level;
            }
        } else {
            colours[i] = scale_colour(scale.position(values[i]), scale.map);
        }
    }
    return colours;
}

} // namespace hemi
