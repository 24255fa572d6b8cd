#include "io/scenes/up_axis.hpp"

#include <cmath>

namespace hemi::io {

namespace {

constexpr double across = 0.9998; // cosine of the angle to an axis, about one degree
constexpr double majority = 1.05; // times the other's area: a cube has none
constexpr double flat = 0.67;     // of the other extent

} // namespace

UpAxis up_by_faces(const Scene& scene) {
    double across_y = 0.0;
    double across_z = 0.0;
    for (const Surface& surface : scene.surfaces) {
        const Vec3 area = area_vector(surface.polygon());
        const double size = glm::length(area);
        across_y += std::abs(area.y) > across * size ? size : 0.0;
        across_z += std::abs(area.z) > across * size ? size : 0.0;
    }
    if (across_y > majority * across_z || across_z > majority * across_y) {
        return across_y > across_z ? UpAxis::y : UpAxis::z;
    }
    const Bounds bounds = scene.bounds();
    const Vec3 size = bounds.upper - bounds.lower;
    return size.y < flat * size.z ? UpAxis::y : UpAxis::z;
}

} // namespace hemi::io
