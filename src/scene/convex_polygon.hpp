#pragma once

#include "hemi/core/geometry.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// Corners of a plane convex polygon, counter-clockwise about its normal.
using Polygon = std::vector<Vec3>;

/// A straight line between two points.
struct Segment {
    Vec3 from;
    Vec3 to;
};

/// Of its corners, and `margin` more on every side.
[[nodiscard]] Bounds bounds_of(std::span<const Vec3> polygon, double margin = 0.0);

/// Whether a point of a polygon's plane lies in it or within `slack` of it.
[[nodiscard]] bool contains(std::span<const Vec3> polygon, const Vec3& normal, const Vec3& point,
                            double slack);

/// The part of a segment in a polygon's plane that lies in it.
/// @return nothing where no more than twice `slack` does, or where it runs along the polygon's border
[[nodiscard]] std::optional<Segment> within(std::span<const Vec3> polygon, const Vec3& normal,
                                            const Segment& segment, double slack);

/// Whether two polygons of one plane have more in common than a strip as wide as `slack`.
[[nodiscard]] bool overlap(std::span<const Vec3> polygon, const Vec3& normal, std::span<const Vec3> other,
                           double slack);

/// A convex polygon that is cut along segments in its plane.
class DividedPolygon {
public:
    /// @param slack  parts that are no wider do not count
    DividedPolygon(Polygon polygon, const Vec3& normal, double slack);

    /// Cuts those parts in two that the segment runs through, along its whole line.
    void cut(const Segment& segment);
    /// From the left of the first cuts to their right.
    [[nodiscard]] std::vector<Polygon> parts() const;

private:
    /// A part, or two: those on the left and on the right of a line.
    struct Node {
        Polygon corners;
        Bounds around;
        std::uint32_t left = 0; ///< of two parts; 0: it is one
        std::uint32_t right = 0;
    };

    void add(Polygon corners);
    void cut_part(std::uint32_t part, const Segment& segment);

    std::vector<Node> nodes_; ///< the whole polygon first
    Vec3 normal_;
    double slack_;
};

/// The polygon without corners that lie within `slack` of the line between their neighbours.
[[nodiscard]] Polygon without_straight_corners(const Polygon& polygon, double slack);

/// Whether a polygon is wider than `slack`.
[[nodiscard]] bool is_wide(std::span<const Vec3> polygon, double slack);

} // namespace hemi
