#include "pipeline/patch_locator.hpp"

#include <limits>
#include <vector>

namespace hemi {

namespace {

// Patches look the same way where the cosine between their normals is above this.
constexpr double facing_alike = 0.9;

std::vector<Bounds> bounds_of_patches(const PatchMesh& mesh) {
    std::vector<Bounds> bounds(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchCorners corners = mesh.corners(i);
        for (const Vec3& point : corners.polygon()) {
            bounds[i].add(point);
        }
    }
    return bounds;
}

/// Of a point with respect to edges a and b: (x, y) with a·x + b·y nearest to it.
std::array<double, 2> components(const Vec3& a, const Vec3& b, const Vec3& point) {
    const double aa = glm::dot(a, a);
    const double ab = glm::dot(a, b);
    const double bb = glm::dot(b, b);
    const double determinant = aa * bb - ab * ab;
    if (!(determinant > 0.0)) {
        return {0.0, 0.0};
    }
    const double pa = glm::dot(point, a);
    const double pb = glm::dot(point, b);
    return {(pa * bb - pb * ab) / determinant, (pb * aa - pa * ab) / determinant};
}

} // namespace

PatchLocator::PatchLocator(const PatchMesh& mesh)
    : mesh_(&mesh), tolerance_(mesh.rounding() + 1e-6 * mesh.bounds().diagonal()),
      tree_(bounds_of_patches(mesh)) {}

std::optional<std::uint32_t> PatchLocator::find(const SurfacePoint& point) const {
    std::optional<std::uint32_t> found;
    double least = std::numeric_limits<double>::infinity();
    const Vec3 margin(tolerance_);
    tree_.overlapping({point.position - margin, point.position + margin}, [&](std::uint32_t patch) {
        if (glm::dot(mesh_->normal(patch), point.normal) < facing_alike) {
            return;
        }
        const PatchCorners corners = mesh_->corners(patch);
        const double way = glm::distance(mesh_->centres()[patch], point.position);
        if (distance_to_polygon(point.position, corners.polygon()) <= tolerance_ && way < least) {
            least = way;
            found = patch;
        }
    });
    return found;
}

std::array<double, 4> PatchLocator::weights(std::uint32_t patch, const Vec3& point) const {
    const PatchCorners corners = mesh_->corners(patch);
    const auto& p = corners.points;
    if (corners.count == 3) {
        const auto [a, b] = components(p[1] - p[0], p[2] - p[0], point - p[0]);
        return {1.0 - a - b, a, b, 0.0};
    }
    // Newton's method from the middle; of a parallelogram the first step is exact.
    double a = 0.5;
    double b = 0.5;
    constexpr int steps = 8;
    for (int step = 0; step < steps; ++step) {
        const Vec3 along = (1.0 - b) * (p[1] - p[0]) + b * (p[2] - p[3]);
        const Vec3 across = (1.0 - a) * (p[3] - p[0]) + a * (p[2] - p[1]);
        const Vec3 at = (1.0 - b) * ((1.0 - a) * p[0] + a * p[1]) + b * ((1.0 - a) * p[3] + a * p[2]);
        const auto [more_a, more_b] = components(along, across, point - at);
        a = glm::clamp(a + more_a, 0.0, 1.0);
        b = glm::clamp(b + more_b, 0.0, 1.0);
    }
    return {(1.0 - a) * (1.0 - b), a * (1.0 - b), a * b, (1.0 - a) * b};
}

} // namespace hemi
