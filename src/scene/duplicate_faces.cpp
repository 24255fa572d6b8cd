#include "scene/duplicate_faces.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>

namespace hemi {

namespace {

using Point = std::array<double, 3>;

/// A face, whichever of its corners comes first: corners in one order, turned round where that makes the
/// order ascend. Faces are convex, so that of faces with the same corners the order is the same.
struct Shape {
    std::array<Point, 4> corners{};
    std::uint32_t count = 0;
    std::uint32_t side = 0; ///< 0, or 1 where it was turned round, or 2: two-sided

    [[nodiscard]] auto key() const { return std::tie(corners, count, side); }
};

Shape shape_of(const Surface& surface) {
    Shape shape;
    shape.count = surface.vertex_count;
    const auto end = shape.corners.begin() + shape.count;
    for (std::uint32_t k = 0; k < shape.count; ++k) {
        const Vec3& point = surface.vertices[k];
        shape.corners[k] = {point.x + 0.0, point.y + 0.0, point.z + 0.0}; // zero of either sign is one place
    }
    std::rotate(shape.corners.begin(), std::min_element(shape.corners.begin(), end), end);
    if (shape.corners[shape.count - 1] < shape.corners[1]) {
        std::reverse(shape.corners.begin() + 1, end);
        shape.side = 1;
    }
    shape.side = surface.two_sided ? 2 : shape.side;
    return shape;
}

std::uint64_t hash_of(const Shape& shape) {
    std::uint64_t hash = shape.side;
    for (const Point& corner : shape.corners) {
        for (const double value : corner) {
            hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x9E3779B97F4A7C15u;
            hash ^= hash >> 29;
        }
    }
    return hash;
}

struct Face {
    std::uint64_t hash;
    std::uint32_t surface;
};

} // namespace

std::vector<std::uint32_t> next_duplicates(const Scene& scene) {
    std::vector<Face> faces;
    faces.reserve(scene.surfaces.size());
    for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
        faces.push_back({hash_of(shape_of(scene.surfaces[s])), s});
    }
    const auto compare = [&scene](const Face& a, const Face& b) {
        if (a.hash != b.hash) {
            return a.hash < b.hash;
        }
        const Shape one = shape_of(scene.surfaces[a.surface]);
        const Shape other = shape_of(scene.surfaces[b.surface]);
        return one.key() != other.key() ? one.key() < other.key() : a.surface < b.surface;
    };
    std::sort(faces.begin(), faces.end(), compare);
    std::vector<std::uint32_t> next(scene.surfaces.size(), no_duplicate);
    for (std::size_t k = 1; k < faces.size(); ++k) {
        const Face& face = faces[k - 1];
        if (face.hash == faces[k].hash && shape_of(scene.surfaces[face.surface]).key() ==
                                              shape_of(scene.surfaces[faces[k].surface]).key()) {
            next[face.surface] = faces[k].surface;
        }
    }
    return next;
}

} // namespace hemi
