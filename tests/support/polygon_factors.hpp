#pragma once

#include "hemi/core/geometry.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

/// Form factors of polygons without occlusion, by means that owe nothing to the engines: the yardsticks below
/// occluded_reference.hpp.
namespace hemi::test {

/// Half-space height >= 0. `normal` is a unit vector.
struct Plane {
    Vec3 normal{0.0};
    double offset = 0.0;

    [[nodiscard]] double height(const Vec3& point) const { return glm::dot(normal, point) - offset; }
};
/// The plane of a polygon, its front above.
[[nodiscard]] Plane plane_of(std::span<const Vec3> polygon);

/// A planar convex polygon that can be clipped in place; empty when nothing is left.
class ConvexPolygon {
public:
    ConvexPolygon() = default;
    explicit ConvexPolygon(std::span<const Vec3> corners);

    [[nodiscard]] std::span<const Vec3> corners() const { return {corners_.data(), count_}; }
    [[nodiscard]] bool empty() const { return count_ < 3; }
    /// Keeps what is above the plane.
    void clip(const Plane& plane);

private:
    std::array<Vec3, 28> corners_{};
    std::size_t count_ = 0;
};

/// Share of what leaves a point of a surface that arrives at a polygon in front of it which turns its front
/// to the point. Source: J. H. Lambert, "Photometria", 1760, as a sum over edges.
[[nodiscard]] double point_factor(const Vec3& point, const Vec3& normal, const ConvexPolygon& polygon);

struct QuadraturePoint {
    Vec3 position{0.0};
    double weight = 0.0; ///< of the polygon's area; all weights sum to 1
};
/// n x n Gauss points of a triangle or quadrilateral, n at most 32.
[[nodiscard]] std::vector<QuadraturePoint> gauss_points(std::span<const Vec3> polygon, std::size_t n);

/// A_i F(i, j) of two convex polygons, unoccluded, of the parts that lie in front of each other: the double
/// contour integral, closed form inside, Gauss graded towards touching corners outside; point_factor() for
/// polygons that are far apart. About 1e-10 of the factor.
[[nodiscard]] double exchange_area(std::span<const Vec3> i, std::span<const Vec3> j);

} // namespace hemi::test
