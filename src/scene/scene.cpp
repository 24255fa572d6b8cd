#include "hemi/scene/scene.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemi {

namespace {

/// A scene that is no more than this many roundings of its coordinates across is lost in them.
constexpr double roundings_across = 200.0;

double rounding_at(double magnitude) {
    return 16.0 * std::numeric_limits<double>::epsilon() * magnitude;
}

bool finite(const Vec3& point) {
    return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
}

void validate(const Material& material, std::size_t channels, bool thermal) {
    if (material.reflectance.size() != channels || material.exitance.size() != channels) {
        throw InputError(
            fmt::format("material \"{}\": {} reflectances and {} exitances; the scene has {} channels",
                        material.name, material.reflectance.size(), material.exitance.size(), channels));
    }
    for (const double value : material.reflectance) {
        if (!(value >= 0.0 && (value < 1.0 || (thermal && value == 1.0)))) {
            throw InputError(fmt::format("material \"{}\": reflectance {}; must be at least 0 and {} 1",
                                         material.name, value, thermal ? "at most" : "below"));
        }
    }
    for (const double value : material.exitance) {
        if (!(value >= 0.0) || !std::isfinite(value)) {
            throw InputError(fmt::format("material \"{}\": exitance {}; must be finite and not negative",
                                         material.name, value));
        }
    }
}

} // namespace

double emissivity_at(std::span<const std::array<double, 2>> table, double kelvin) {
    const auto above = std::find_if(table.begin(), table.end(), [kelvin](const std::array<double, 2>& entry) {
        return entry[0] > kelvin;
    });
    if (above == table.begin()) {
        return (*above)[1];
    }
    const auto& [low, from] = *(above - 1);
    if (above == table.end()) {
        return from;
    }
    return from + ((*above)[1] - from) * (kelvin - low) / ((*above)[0] - low);
}

std::vector<std::uint32_t> face_numbers(std::span<const Surface> surfaces) {
    std::vector<std::uint32_t> numbers;
    numbers.reserve(surfaces.size());
    std::uint32_t next = 0;
    for (const Surface& surface : surfaces) {
        numbers.push_back(surface.continues && next > 0 ? next - 1 : next);
        next = numbers.back() + (surface.joins ? 2 : 1);
    }
    return numbers;
}

std::uint32_t Scene::group_index(const std::string& group_name) {
    const auto found = std::find(groups.begin(), groups.end(), group_name);
    if (found != groups.end()) {
        return static_cast<std::uint32_t>(found - groups.begin());
    }
    groups.push_back(group_name);
    return static_cast<std::uint32_t>(groups.size() - 1);
}

Bounds Scene::bounds() const {
    Bounds bounds;
    for (const Surface& surface : surfaces) {
        for (const Vec3& vertex : surface.polygon()) {
            bounds.add(vertex);
        }
    }
    return bounds;
}

void validate(const Scene& scene) {
    if (scene.surfaces.empty()) {
        throw InputError("the scene has no surfaces; it needs at least one");
    }
    if (scene.channels.empty()) {
        throw InputError("the scene has no channels; it needs at least one");
    }
    for (const Material& material : scene.materials) {
        validate(material, scene.channels.size(), scene.thermal.has_value());
    }
    if (!scene.environment.empty() && scene.environment.size() != scene.channels.size()) {
        throw InputError(fmt::format("environment: {} exitances; the scene has {} channels",
                                     scene.environment.size(), scene.channels.size()));
    }
    const auto check_light = [&scene](const char* name, const std::vector<double>& values, double most) {
        if (values.size() != scene.channels.size()) {
            throw InputError(fmt::format("{}: {} values; the scene has {} channels", name, values.size(),
                                         scene.channels.size()));
        }
        for (const double value : values) {
            if (!(value >= 0.0 && value <= most)) {
                throw InputError(fmt::format("{}: {}; must be finite and not negative{}", name, value,
                                             most == 1.0 ? ", and at most 1" : ""));
            }
        }
    };
    constexpr double finite_values = std::numeric_limits<double>::max();
    if (scene.sun) {
        check_light("sun", scene.sun->irradiance, finite_values);
        if (!(std::abs(glm::length(scene.sun->direction) - 1.0) <= 1e-9)) {
            throw InputError(
                fmt::format("sun: a direction of length {}; must be 1", glm::length(scene.sun->direction)));
        }
        constexpr double most = 90.0;
        if (!(scene.sun->diameter >= 0.0 && scene.sun->diameter <= most)) {
            throw InputError(
                fmt::format("sun: diameter {}; must be in [0, {}] degrees", scene.sun->diameter, most));
        }
    }
    if (scene.sky) {
        check_light("sky", scene.sky->horizontal, finite_values);
        check_light("ground", scene.sky->ground, 1.0);
    }
    for (const double value : scene.environment) {
        if (!(value >= 0.0) || !std::isfinite(value)) {
            throw InputError(fmt::format("environment: exitance {}; must be finite and not negative", value));
        }
    }
    if (scene.patch_size && !(*scene.patch_size > 0.0 && std::isfinite(*scene.patch_size))) {
        throw InputError(fmt::format("patch_size {}; must be a positive length", *scene.patch_size));
    }
    for (std::size_t s = 0; s < scene.surfaces.size(); ++s) {
        const Surface& surface = scene.surfaces[s];
        if (surface.group >= scene.groups.size() || surface.material >= scene.materials.size()) {
            throw InputError(fmt::format("surface {}: group {} of {} or material {} of {} does not exist", s,
                                         surface.group, scene.groups.size(), surface.material,
                                         scene.materials.size()));
        }
        if (surface.heat != no_heat && (!scene.thermal || surface.heat >= scene.thermal->conditions.size())) {
            throw InputError(fmt::format("surface {}: heat condition {} does not exist", s, surface.heat));
        }
        if (const auto defect = polygon_defect(surface.polygon())) {
            throw InputError(
                fmt::format("surface {} (group \"{}\"): {}", s, scene.groups[surface.group], *defect));
        }
        if (surface.patches && (surface.patches->u == 0 || surface.patches->v == 0 ||
                                (surface.vertex_count == 3 && surface.patches->u != surface.patches->v))) {
            throw InputError(
                fmt::format("surface {} (group \"{}\"): patches [{}, {}]; must be at least 1, and "
                            "equal for a triangle",
                            s, scene.groups[surface.group], surface.patches->u, surface.patches->v));
        }
    }
    const Bounds bounds = scene.bounds();
    double magnitude = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        magnitude = std::max({magnitude, std::abs(bounds.lower[axis]), std::abs(bounds.upper[axis])});
    }
    if (!(bounds.diagonal() > roundings_across * rounding_at(magnitude))) {
        throw InputError(
            fmt::format("the scene is {:.3g} across at coordinates of up to {:.3g}, where double "
                        "precision holds too few digits of it; move it towards the origin",
                        bounds.diagonal(), magnitude));
    }
    check_symmetry(scene);
}

std::optional<std::string> polygon_defect(std::span<const Vec3> polygon) {
    if (polygon.size() < 3 || polygon.size() > 4) {
        return fmt::format("{} vertices; a patch needs 3 or 4", polygon.size());
    }
    double magnitude = 0.0;
    double longest = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        if (!finite(polygon[i])) {
            return fmt::format("vertex {} is not finite", i);
        }
        magnitude =
            std::max({magnitude, std::abs(polygon[i].x), std::abs(polygon[i].y), std::abs(polygon[i].z)});
        longest = std::max(longest, glm::length(polygon[(i + 1) % polygon.size()] - polygon[i]));
    }
    // The square of an area must neither overflow nor lose digits.
    if (magnitude > 1e70) {
        return fmt::format("coordinate of magnitude {}; must be below 1e70", magnitude);
    }
    if (longest > 0.0 && longest < 1e-70) {
        return fmt::format("longest edge {}; must be above 1e-70", longest);
    }
    const Vec3 area = area_vector(polygon);
    const double rounding = rounding_at(magnitude);
    if (!(longest > rounding) || !(glm::length(area) > longest * std::max(rounding, 1e-9 * longest))) {
        return std::string("zero area");
    }
    const Vec3 normal = glm::normalize(area);
    const Vec3 centre = area_centroid(polygon);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const double off = std::abs(glm::dot(polygon[i] - centre, normal));
        if (off > 1e-5 * longest + rounding) {
            return fmt::format(
                "not planar: vertex {} is {:.3g} off the plane, {:.2g} of the longest edge; split "
                "it into triangles",
                i, off, off / longest);
        }
    }
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3& corner = polygon[i];
        const Vec3 before = corner - polygon[(i + polygon.size() - 1) % polygon.size()];
        const Vec3 after = polygon[(i + 1) % polygon.size()] - corner;
        const double turn = glm::dot(glm::cross(before, after), normal);
        if (turn < -1e-9 * longest * longest - rounding * longest) {
            return fmt::format("not convex at vertex {}; split it into convex polygons", i);
        }
        if (!(glm::length(after) > rounding)) {
            return fmt::format("vertices {} and {} coincide", i, (i + 1) % polygon.size());
        }
    }
    return std::nullopt;
}

} // namespace hemi
