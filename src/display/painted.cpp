#include "display/painted.hpp"

#include "display/vertex_colours_detail.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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
            colours[i] = scale.colour_at(scale.position(values[i]));
        }
    }
    return colours;
}

void put_iso_values(PictureMesh& painted, const PatchMesh& mesh, const SmoothSurfaces& surfaces,
                    std::span<const double> values, const ColourScale& scale) {
    std::vector<double> places(values.size(), 0.0);
    std::vector<double> left_out(values.size(), 0.0); // what has no value lends its neighbours none
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isnan(values[i])) {
            left_out[i] = 1.0;
        } else {
            places[i] = scale.place(values[i]);
        }
    }
    const std::vector<float> at_corners = corner_values(mesh, surfaces, 1, places, left_out);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool triangle = surfaces.corners(static_cast<std::uint32_t>(i)).size() == 3;
        for (std::size_t k = 0; k < 4; ++k) {
            painted.corners[(i * 4 + k) * 3] =
                std::isnan(values[i]) ? std::numeric_limits<float>::quiet_NaN()
                                      : at_corners[i * 4 + (triangle ? std::min(k, std::size_t{2}) : k)];
        }
    }
}

std::vector<float> iso_positions(const ColourScale& scale) {
    std::vector<float> positions;
    if (scale.lines) {
        for (const double level : scale.levels()) {
            positions.push_back(static_cast<float>(scale.place(level)));
        }
    }
    return positions;
}

} // namespace hemi
