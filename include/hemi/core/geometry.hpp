#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace hemi {

/// A point or direction in scene units, double precision.
using Vec3 = glm::dvec3;

/// Axis-aligned bounds; empty (lower > upper) until a point is added.
struct Bounds {
    Vec3 lower{std::numeric_limits<double>::infinity()};  ///< smallest coordinates
    Vec3 upper{-std::numeric_limits<double>::infinity()}; ///< largest coordinates

    /// Grows until `point` is in it.
    void add(const Vec3& point) {
        lower = glm::min(lower, point);
        upper = glm::max(upper, point);
    }
    /// Whether no point was added.
    [[nodiscard]] bool empty() const { return lower.x > upper.x; }
    /// Length of the diagonal; 0 when empty.
    [[nodiscard]] double diagonal() const { return empty() ? 0.0 : glm::length(upper - lower); }
    /// Middle of the diagonal; not a number when empty.
    [[nodiscard]] Vec3 centre() const { return 0.5 * (lower + upper); }
};

/// Whether two boxes have a point in common.
[[nodiscard]] inline bool overlap(const Bounds& a, const Bounds& b) {
    for (int axis = 0; axis < 3; ++axis) {
        if (a.lower[axis] > b.upper[axis] || b.lower[axis] > a.upper[axis]) {
            return false;
        }
    }
    return true;
}

/// Area times unit normal of a closed polygon (Newell's method): half the sum of cross products of its
/// corners, taken relative to the first one so that distance from the origin costs no digits.
[[nodiscard]] Vec3 area_vector(std::span<const Vec3> polygon);

/// Centroid of a planar polygon's area (not the mean of its corners).
[[nodiscard]] Vec3 area_centroid(std::span<const Vec3> polygon);

/// Distance from `point` to the nearest point of a planar convex polygon.
[[nodiscard]] double distance_to_polygon(const Vec3& point, std::span<const Vec3> polygon);

} // namespace hemi
