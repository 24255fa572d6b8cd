#pragma once

#include "hemi/core/geometry.hpp"

#include <algorithm>
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

/// How far off an edge a vertex may lie and still touch it: what text files of six digits or so round away,
/// but little of the edge itself, so that small detail in a large scene is left alone.
class TouchingTolerance {
public:
    /// @param diagonal  of the scene. @param rounding  length below which coordinates are rounding.
    TouchingTolerance(double diagonal, double rounding) : largest_(5e-7 * diagonal), least_(rounding) {}

    [[nodiscard]] double at(double edge_length) const {
        return std::max(least_, std::min(largest_, 1e-5 * edge_length));
    }
    [[nodiscard]] double largest() const { return std::max(least_, largest_); }

private:
    double largest_;
    double least_;
};

/// Makes outlines watertight: where a corner of one polygon lies on an edge of another (a T-junction), that
/// vertex is inserted into the edge.
void insert_touching_vertices(std::vector<Outline>& outlines, std::span<const Vec3> positions,
                              const TouchingTolerance& tolerance);

/// Triangles (positions in the outline) of a convex outline that may have corners along its edges. Every
/// corner is in a triangle of positive area, so that no crack opens.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangulate(const Outline& outline);

} // namespace hemi
