#pragma once

#include "hemi/core/geometry.hpp"

#include <span>

namespace hemi {

/// How contour integrals are done. Lengths are in the polygons' own units.
struct ContourRule {
    /// Wanted accuracy of the integral over one pair of edges, relative to the product of their lengths.
    double tolerance = 1e-9;
    /// Distance below which edges touch, or are parallel: what rounding can do to them.
    double rounding = 0.0;
    /// If not 0: a Gauss rule of this many points, whatever the tolerance, for all pairs of edges that
    /// neither touch nor are near and parallel.
    std::size_t fixed_order = 0;
};

/// A_i F(i, j) = 1/(2 pi) ∮∮ ln r da·db of two polygons, each counter-clockwise about its normal and entirely
/// in front of the other.
///
/// Digits are lost with the square of distance over size: for near polygons, with coordinates of about 1 or
/// less.
[[nodiscard]] double contour_integral(std::span<const Vec3> a, std::span<const Vec3> b,
                                      const ContourRule& rule);

} // namespace hemi
