#pragma once

#include "engine/hemicube/draw_list.hpp"
#include "hemi/core/geometry.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

/// A triangle of a drawn polygon.
struct DrawTriangle {
    std::uint32_t polygon;                 ///< into DrawList::polygons
    std::array<std::uint32_t, 3> vertices; ///< into DrawList::vertices
    Vec3 centre;
};

/// Appends the triangles of a polygon.
void add_triangles(const DrawList& list, std::uint32_t polygon, std::vector<DrawTriangle>& triangles);

/// The vertices of some triangles, each once, ascending.
[[nodiscard]] std::vector<std::uint32_t> vertices_of(std::span<const DrawTriangle> triangles);

/// Orders triangles so that those near one another follow one another, and halves them along the longest side
/// of their box until there are at most `most` of them that also `fits`.
/// @param fits   of a span of triangles
/// @param visit  gets every cluster, a span of triangles, in order
template <class Fits, class Visit>
void for_each_cluster(std::span<DrawTriangle> triangles, std::size_t most, const Fits& fits,
                      const Visit& visit) {
    if (triangles.empty()) {
        return;
    }
    if (triangles.size() == 1 || (triangles.size() <= most && fits(triangles))) {
        visit(triangles);
        return;
    }
    Bounds bounds;
    for (const DrawTriangle& triangle : triangles) {
        bounds.add(triangle.centre);
    }
    const Vec3 extent = bounds.upper - bounds.lower;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    // Halves that fill clusters, where there are several.
    std::size_t half = triangles.size() / 2;
    if (triangles.size() > most) {
        half = std::max(most, (half + most / 2) / most * most);
    }
    half = half < triangles.size() ? half : triangles.size() / 2;
    std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half),
                     triangles.end(), [axis](const DrawTriangle& a, const DrawTriangle& b) {
                         return std::pair(a.centre[axis], a.polygon) < std::pair(b.centre[axis], b.polygon);
                     });
    for_each_cluster(triangles.first(half), most, fits, visit);
    for_each_cluster(triangles.subspan(half), most, fits, visit);
}

} // namespace hemi
