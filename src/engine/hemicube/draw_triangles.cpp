#include "engine/hemicube/draw_triangles.hpp"

namespace hemi {

void add_triangles(const DrawList& list, std::uint32_t polygon, std::vector<DrawTriangle>& triangles) {
    const DrawPolygon& drawn = list.polygons[polygon];
    for (std::uint32_t t = 0; t < drawn.triangle_count; ++t) {
        DrawTriangle& triangle = triangles.emplace_back(DrawTriangle{polygon, {}, Vec3(0.0)});
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t corner = list.triangles[drawn.first_triangle + t][k];
            triangle.vertices[k] = list.corners[drawn.first_corner + corner].vertex;
            triangle.centre += list.vertices[triangle.vertices[k]] / 3.0;
        }
    }
}

std::vector<std::uint32_t> vertices_of(std::span<const DrawTriangle> triangles) {
    std::vector<std::uint32_t> vertices;
    for (const DrawTriangle& triangle : triangles) {
        vertices.insert(vertices.end(), triangle.vertices.begin(), triangle.vertices.end());
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

} // namespace hemi
