#pragma once

#include "hemi/core/geometry.hpp"

#include <array>
#include <cstddef>
#include <span>

namespace hemi {

/// A plane that counts from one of its points, so that distance from the origin costs no digits.
struct Plane {
    Vec3 at;
    Vec3 normal;
};

/// A convex polygon: a patch, or what a plane leaves of it. Six corners are the most that four can become
/// where rounding decides on which side they are.
struct ConvexPolygon {
    std::array<Vec3, 6> points;
    std::size_t count = 0;

    ConvexPolygon() = default;
    explicit ConvexPolygon(std::span<const Vec3> corners) {
        for (const Vec3& corner : corners) {
            add(corner);
        }
    }
    void add(const Vec3& point) { points[count++] = point; }
    [[nodiscard]] std::span<const Vec3> span() const { return {points.data(), count}; }

    /// Quadrilaterals and triangles that make up the polygon: itself, or triangles about the first corner.
    [[nodiscard]] std::size_t pieces() const { return count > 4 ? count - 2 : 1; }
    [[nodiscard]] ConvexPolygon piece(std::size_t index) const {
        if (count <= 4) {
            return *this;
        }
        ConvexPolygon triangle;
        triangle.add(points[0]);
        triangle.add(points[index + 1]);
        triangle.add(points[index + 2]);
        return triangle;
    }
};

/// The part of a polygon of three or four corners in front of a plane; fewer than three corners: nothing.
[[nodiscard]] inline ConvexPolygon clip(std::span<const Vec3> polygon, const Plane& plane) {
    ConvexPolygon front;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec3& here = polygon[k];
        const Vec3& next = polygon[(k + 1) % polygon.size()];
        const double height = glm::dot(here - plane.at, plane.normal);
        const double next_height = glm::dot(next - plane.at, plane.normal);
        if (height >= 0.0) {
            front.add(here);
        }
        if ((height < 0.0 && next_height > 0.0) || (height > 0.0 && next_height < 0.0)) {
            front.add(here + (height / (height - next_height)) * (next - here));
        }
    }
    return front;
}

/// The bilinear map of [-1, 1]² onto a planar quadrilateral, or onto a triangle whose third corner then
/// counts twice, and its Jacobian: area = 4 times the one in the middle.
struct BilinearMap {
    Vec3 middle, along_s, along_t, twist;
    double jacobian, jacobian_s, jacobian_t;

    /// @param polygon  3 or 4 corners, counter-clockwise about `normal`.
    BilinearMap(std::span<const Vec3> polygon, const Vec3& normal) {
        const Vec3& a = polygon[0];
        const Vec3& b = polygon[1];
        const Vec3& c = polygon[2];
        const Vec3& d = polygon[polygon.size() - 1];
        middle = 0.25 * ((a + c) + (b + d));
        along_s = 0.25 * ((b - a) + (c - d));
        along_t = 0.25 * ((d - a) + (c - b));
        twist = 0.25 * ((a - b) + (c - d));
        jacobian = glm::dot(normal, glm::cross(along_s, along_t));
        jacobian_s = glm::dot(normal, glm::cross(along_s, twist));
        jacobian_t = glm::dot(normal, glm::cross(twist, along_t));
    }

    [[nodiscard]] Vec3 point(double s, double t) const {
        return middle + s * along_s + t * along_t + (s * t) * twist;
    }
    [[nodiscard]] double jacobian_at(double s, double t) const {
        return jacobian + s * jacobian_s + t * jacobian_t;
    }
};

} // namespace hemi
