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

/// What for_each_cluster() orders triangles by.
[[nodiscard]] inline std::pair<Vec3, std::uint32_t> place_of(const DrawTriangle& triangle) {
    return {triangle.centre, triangle.polygon};
}

/// Orders things so that those near one another follow one another, and halves them along the longest side of
/// the box of their centres until there are at most `most` of them that also `fits`.
/// @param place  the centre of a thing, and a number that decides between equal ones
/// @param fits   of a span of things
/// @param visit  gets every cluster, a span of things, in order
template <class Thing, class Place, class Fits, class Visit>
void for_each_cluster(std::span<Thing> things, std::size_t most, const Place& place, const Fits& fits,
                      const Visit& visit) {
    if (things.empty()) {
        return;
    }
    if (things.size() == 1 || (things.size() <= most && fits(things))) {
        visit(things);
        return;
    }
    Bounds bounds;
    for (const Thing& thing : things) {
        bounds.add(place(thing).first);
    }
    const Vec3 extent = bounds.upper - bounds.lower;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    // Halves that fill clusters, where there are several.
    std::size_t half = things.size() / 2;
    if (things.size() > most) {
        half = std::max(most, (half + most / 2) / most * most);
    }
    half = half < things.size() ? half : things.size() / 2;
    std::nth_element(things.begin(), things.begin() + static_cast<std::ptrdiff_t>(half), things.end(),
                     [&place, axis](const Thing& a, const Thing& b) {
                         const auto [centre_a, number_a] = place(a);
                         const auto [centre_b, number_b] = place(b);
                         return std::pair(centre_a[axis], number_a) < std::pair(centre_b[axis], number_b);
                     });
    for_each_cluster(things.first(half), most, place, fits, visit);
    for_each_cluster(things.subspan(half), most, place, fits, visit);
}

} // namespace hemi
