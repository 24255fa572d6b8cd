#include "engine/hemicube/grid_map.hpp"

namespace hemi {

GridMap make_grid_map(const DrawList& list, std::uint32_t polygon) {
    const DrawPolygon& drawn = list.polygons[polygon];
    GridMap map;
    double largest = 0.0;
    for (std::uint32_t t = 0; t < drawn.triangle_count; ++t) {
        const auto corner = [&](std::size_t k) -> const OutlineCorner& {
            return list.corners[drawn.first_corner + list.triangles[drawn.first_triangle + t][k]];
        };
        const Vec3& origin = list.vertices[corner(0).vertex];
        const Vec3 a = list.vertices[corner(1).vertex] - origin;
        const Vec3 b = list.vertices[corner(2).vertex] - origin;
        const Vec3 cross = glm::cross(a, b);
        const double square = glm::dot(cross, cross);
        if (square <= largest) {
            continue;
        }
        largest = square;
        // Of the function with values 0, 1, 0 at the corners, and of the one with 0, 0, 1.
        const Vec3 to_a = glm::cross(b, cross) / square;
        const Vec3 to_b = glm::cross(cross, a) / square;
        const double u = static_cast<double>(corner(0).grid_u);
        const double v = static_cast<double>(corner(0).grid_v);
        map = {origin,
               (static_cast<double>(corner(1).grid_u) - u) * to_a +
                   (static_cast<double>(corner(2).grid_u) - u) * to_b,
               (static_cast<double>(corner(1).grid_v) - v) * to_a +
                   (static_cast<double>(corner(2).grid_v) - v) * to_b,
               u, v};
    }
    return map;
}

} // namespace hemi
