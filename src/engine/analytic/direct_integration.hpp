#pragma once

#include "hemi/core/geometry.hpp"

#include <optional>
#include <span>

namespace hemi {

/// A_i F(i, j) of two rectangles in parallel or perpendicular planes whose edges are parallel or
/// perpendicular to each other: closed forms C-13 and C-15 of J. R. Howell's catalogue. Nothing for other
/// pairs, and for those farther apart than 12 times their shortest edge: the closed forms lose
/// eps·(distance/size)⁴.
/// @param a,b  corners counter-clockwise about the unit normals.
[[nodiscard]] std::optional<double> rectangle_exchange(std::span<const Vec3> a, const Vec3& normal_a,
                                                       std::span<const Vec3> b, const Vec3& normal_b);

/// A_i F(i, j) of any two planar convex polygons: Lambert's point factor of `b`, integrated over the part of
/// `a` in front of it by Gauss rules of 2 x 2 and 3 x 3 points on cells that are quartered until both agree.
/// Agreement wanted: 1e-6 of the result, or 1e-8 of a's area.
[[nodiscard]] double adaptive_exchange(std::span<const Vec3> a, const Vec3& normal_a, std::span<const Vec3> b,
                                       const Vec3& normal_b);

} // namespace hemi
