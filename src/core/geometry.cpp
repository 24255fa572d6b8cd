#include "hemi/core/geometry.hpp"

#include <algorithm>

namespace hemi {

Vec3 area_vector(std::span<const Vec3> polygon) {
    Vec3 sum(0.0);
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        sum += glm::cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
    }
    return 0.5 * sum;
}

Vec3 area_centroid(std::span<const Vec3> polygon) {
    const Vec3 normal = area_vector(polygon);
    const double length = glm::length(normal);
    if (!(length > 0.0)) {
        return polygon[0];
    }
    const Vec3 unit = normal / length;
    Vec3 sum(0.0);
    double weight = 0.0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const Vec3 a = polygon[i] - polygon[0];
        const Vec3 b = polygon[i + 1] - polygon[0];
        const double area = glm::dot(glm::cross(a, b), unit);
        sum += area * (a + b);
        weight += area;
    }
    return polygon[0] + sum / (3.0 * weight);
}

double distance_to_polygon(const Vec3& point, std::span<const Vec3> polygon) {
    const Vec3 normal = glm::normalize(area_vector(polygon));
    bool inside = true;
    double nearest_squared = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3& a = polygon[i];
        const Vec3 edge = polygon[(i + 1) % polygon.size()] - a;
        const Vec3 offset = point - a;
        if (glm::dot(glm::cross(edge, offset), normal) >= 0.0) {
            continue;
        }
        inside = false;
        const double along = std::clamp(glm::dot(offset, edge) / glm::dot(edge, edge), 0.0, 1.0);
        const Vec3 gap = offset - along * edge;
        nearest_squared = std::min(nearest_squared, glm::dot(gap, gap));
    }
    if (inside) {
        return std::abs(glm::dot(point - polygon[0], normal));
    }
    return std::sqrt(nearest_squared);
}

} // namespace hemi
