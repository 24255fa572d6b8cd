#include "display/picture_mesh.hpp"

#include "display/vertex_colours_detail.hpp"

#include "hemi/core/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

namespace hemi {

namespace {

/// Radiosity that fills most of the display's range: filmic tone mapping makes 0.67 of it, linear 0.6.
constexpr double bright_level = 0.6;
/// Share of the lit area that is darker than what is brought to that level; what is above may clip, so that
/// spots of light near a small lamp do not darken all the rest.
constexpr double bright_share = 0.9;

double luminance(const float* rgb) {
    return 0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
           0.0722 * static_cast<double>(rgb[2]);
}

/// Luminance below which `share` of the area lies; 0 if nothing is lit.
double area_percentile(std::vector<std::pair<double, double>> luminance_and_area, double share) {
    std::sort(luminance_and_area.begin(), luminance_and_area.end());
    double total = 0.0;
    for (const auto& entry : luminance_and_area) {
        total += entry.second;
    }
    double below = 0.0;
    for (const auto& [value, area] : luminance_and_area) {
        below += area;
        if (below >= share * total) {
            return value;
        }
    }
    return 0.0;
}

} // namespace

PictureMesh make_picture_mesh(const PatchMesh& mesh, std::uint32_t channels,
                              std::span<const double> radiosity, std::span<const double> blocked,
                              std::array<std::uint32_t, 3> show, std::span<const float> vertices) {
    return make_picture_mesh(mesh, SmoothSurfaces(mesh), channels, radiosity, blocked, show, vertices);
}

PictureMesh make_picture_mesh(const PatchMesh& mesh, const SmoothSurfaces& surfaces, std::uint32_t channels,
                              std::span<const double> radiosity, std::span<const double> blocked,
                              std::array<std::uint32_t, 3> show, std::span<const float> vertices) {
    if (radiosity.size() != std::size_t{mesh.size()} * channels) {
        throw InvalidArgument(fmt::format("make_picture_mesh: {} values for {} patches of {} channels",
                                          radiosity.size(), mesh.size(), channels));
    }
    if (!vertices.empty() && vertices.size() != radiosity.size() * 4) {
        throw InvalidArgument(
            fmt::format("make_picture_mesh: {} values at corners of {} patches of {} channels",
                        vertices.size(), mesh.size(), channels));
    }
    std::vector<double> shown;
    shown.reserve(std::size_t{mesh.size()} * 3);
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        for (const std::uint32_t channel : show) {
            if (channel >= channels) {
                throw InvalidArgument(fmt::format("make_picture_mesh: channel {} is shown, but there are {}",
                                                  channel, channels));
            }
            shown.push_back(radiosity[std::size_t{patch} * channels + channel]);
        }
    }

    PictureMesh picture;
    picture.bounds = mesh.bounds();
    picture.origin = mesh.bounds().centre();
    if (vertices.empty()) {
        picture.corners = corner_values(mesh, surfaces, 3, shown, blocked);
    } else {
        picture.corners.reserve(std::size_t{mesh.size()} * 12);
        for (std::size_t corner = 0; corner < std::size_t{mesh.size()} * 4; ++corner) {
            for (const std::uint32_t channel : show) {
                picture.corners.push_back(vertices[corner * channels + channel]);
            }
        }
    }
    picture.positions.reserve(picture.corners.size());
    picture.groups.reserve(mesh.size());
    picture.patches.reserve(shown.size());
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        picture.groups.push_back(mesh.group(patch));
        const auto ring = surfaces.corners(patch);
        // Welded positions, so that neighbours share every bit of their corners and no background shows
        // between them.
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 point = surfaces.position(ring[std::min(k, ring.size() - 1)]) - picture.origin;
            for (int axis = 0; axis < 3; ++axis) {
                picture.positions.push_back(static_cast<float>(point[axis]));
            }
        }
        float* corners = picture.corners.data() + std::size_t{patch} * 12;
        if (ring.size() == 3) {
            std::copy_n(corners + 6, 3, corners + 9);
        }
        // The visible part of a covered patch is lit as its surroundings are, not as its covered eye.
        for (std::size_t c = 0; c < 3; ++c) {
            float value = static_cast<float>(shown[std::size_t{patch} * 3 + c]);
            if (is_covered(blocked, patch)) {
                value = 0.0F;
                for (std::size_t k = 0; k < ring.size(); ++k) {
                    value += corners[k * 3 + c];
                }
                value /= static_cast<float>(ring.size());
            }
            picture.patches.push_back(value);
        }
    }
    return picture;
}

PictureMesh with_images(PictureMesh picture, const PatchMesh& mesh) {
    if (!mesh.symmetry()) {
        return picture;
    }
    const std::size_t patches = mesh.size();
    const SceneImages images = images_of(*mesh.symmetry());
    picture.positions.reserve(patches * 12 * images.all.size());
    picture.corners.reserve(patches * 12 * images.all.size());
    for (std::size_t image = 1; image < images.all.size(); ++image) {
        const Isometry& place = images.all[image];
        const bool mirrors = place.mirrors();
        for (std::size_t patch = 0; patch < patches; ++patch) {
            const float* const last = picture.positions.data() + patch * 12 + 9;
            const bool triangle = std::equal(last, last + 3, last - 3);
            for (std::size_t k = 0; k < 4; ++k) {
                const std::size_t turned =
                    triangle ? (std::array<std::size_t, 4>{0, 2, 1, 1})[k] : (4 - k) % 4;
                const std::size_t from = (patch * 4 + (mirrors ? turned : k)) * 3;
                const Vec3 here(picture.positions[from], picture.positions[from + 1],
                                picture.positions[from + 2]);
                const Vec3 there = place(here + picture.origin) - picture.origin;
                for (std::size_t c = 0; c < 3; ++c) {
                    picture.positions.push_back(static_cast<float>(there[static_cast<int>(c)]));
                    picture.corners.push_back(picture.corners[from + c]);
                }
                picture.bounds.add(there + picture.origin);
            }
            for (std::size_t c = 0; c < 3; ++c) {
                picture.patches.push_back(picture.patches[patch * 3 + c]);
            }
            picture.groups.push_back(picture.groups[patch]);
        }
    }
    return picture;
}

std::vector<double> even_light(const PatchMesh& mesh, std::span<const double> reflectance,
                               std::uint32_t channels, UpAxis up) {
    constexpr double darkest = 0.2; // of surfaces that reflect nothing
    constexpr double least = 0.1;   // of those that face away from the brighter side
    if (reflectance.size() != std::size_t{mesh.size()} * channels) {
        throw InvalidArgument(fmt::format("even_light: {} reflectances for {} patches of {} channels",
                                          reflectance.size(), mesh.size(), channels));
    }
    const Vec3 from = glm::normalize(turned_upright({0.35, -0.5, 0.8}, up));
    std::vector<double> light(reflectance.begin(), reflectance.end());
    for (std::size_t k = 0; k < light.size(); ++k) {
        const double turned =
            0.5 + 0.5 * glm::dot(mesh.normal(static_cast<std::uint32_t>(k / channels)), from);
        light[k] = (darkest + (1.0 - darkest) * light[k]) * (least + (1.0 - least) * turned * turned);
    }
    return light;
}

double automatic_exposure(const PatchMesh& mesh, const PictureMesh& picture, std::span<const double> blocked,
                          std::span<const double> exitance, std::uint32_t channels) {
    std::vector<std::pair<double, double>> lit; // surfaces that only reflect
    std::vector<std::pair<double, double>> lamps;
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        const double value = luminance(picture.patches.data() + std::size_t{patch} * 3);
        if (is_covered(blocked, patch) || !(value > 0.0)) {
            continue;
        }
        const auto own =
            exitance.empty() ? exitance : exitance.subspan(std::size_t{patch} * channels, channels);
        const bool lamp = std::any_of(own.begin(), own.end(), [](double e) { return e > 0.0; });
        (lamp ? lamps : lit).emplace_back(value, mesh.areas()[patch]);
    }
    double level = area_percentile(std::move(lit), bright_share);
    if (!(level > 0.0)) {
        level = area_percentile(std::move(lamps), bright_share);
    }
    return level > 0.0 ? bright_level / level : 1.0;
}

Camera default_camera(const Bounds& bounds, UpAxis up) {
    Camera camera;
    camera.fov = 40.0;
    camera.target = bounds.empty() ? Vec3(0.0) : bounds.centre();
    const double radius = bounds.diagonal() > 0.0 ? 0.5 * bounds.diagonal() : 1.0;
    const double distance = radius / std::sin(0.5 * camera.fov * std::numbers::pi / 180.0);
    camera.eye = camera.target + distance * turned_upright(glm::normalize(Vec3(0.5, -0.8, 0.45)), up);
    camera.up = turned_upright({0.0, 0.0, 1.0}, up);
    return camera;
}

} // namespace hemi
