#include "display/visible_point.hpp"

#include "hemi/core/geometry.hpp"

#include <limits>

namespace hemi {

std::optional<VisiblePoint> visible_point(const PatchMesh& mesh, const Vec3& origin, const Vec3& direction,
                                          bool backs, const PictureCut& cut) {
    double nearest = std::numeric_limits<double>::infinity();
    VisiblePoint result{};
    for (std::uint32_t s = 0; s < mesh.surfaces().size(); ++s) {
        const Surface& surface = mesh.surfaces()[s];
        const Vec3& normal = mesh.surface_normal(s);
        const double slope = glm::dot(direction, normal);
        if (slope == 0.0 || (slope > 0.0 && !surface.two_sided && !backs) ||
            cut.of_group(surface.group) != Visibility::shown) {
            continue;
        }
        const double along = glm::dot(surface.vertices[0] - origin, normal) / slope;
        if (!(along > 0.0 && along < nearest)) {
            continue;
        }
        const Vec3 point = origin + along * direction;
        bool inside = cut.keeps(point);
        for (std::size_t k = 0; k < surface.vertex_count && inside; ++k) {
            const Vec3& from = surface.vertices[k];
            const Vec3& to = surface.vertices[(k + 1) % surface.vertex_count];
            inside = glm::dot(glm::cross(to - from, point - from), normal) >= 0.0;
        }
        if (inside) {
            nearest = along;
            result = {point, s, slope > 0.0 && surface.two_sided};
        }
    }
    if (nearest == std::numeric_limits<double>::infinity()) {
        return std::nullopt;
    }
    return result;
}

std::uint32_t patch_at(const PatchMesh& mesh, const VisiblePoint& point) {
    const std::uint32_t count = mesh.patches_per_side(point.surface);
    const std::uint32_t first = mesh.first_patch(point.surface) + (point.back ? count : 0);
    std::uint32_t found = first;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t patch = first; patch < first + count && least > 0.0; ++patch) {
        const double distance = distance_to_polygon(point.position, mesh.corners(patch).polygon());
        if (distance < least) {
            least = distance;
            found = patch;
        }
    }
    return found;
}

} // namespace hemi
