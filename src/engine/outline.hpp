#pragma once

#include "hemi/core/geometry.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Corner of a polygon's outline: a welded vertex, and where it lies in the polygon's own plane coordinates.
struct OutlinePoint {
    std::uint32_t vertex;
    double u;
    double v;
};
using Outline = std::vector<OutlinePoint>;

/// Makes outlines watertight: where a corner of one polygon lies on an edge of another (a T-junction), that
/// vertex is inserted into the edge. Edges that two polygons share end to end are left alone.
/// @param tolerance  how far off an edge a vertex may lie.
void insert_touching_vertices(std::vector<Outline>& outlines, std::span<const Vec3> positions,
                              double tolerance);

/// Triangles (positions in the outline) of a convex outline that may have corners along its edges. Every
/// corner is in a triangle of positive area, so that no crack opens.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangulate(const Outline& outline);

} // namespace hemi
