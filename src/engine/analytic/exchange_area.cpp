#include "hemi/engine/exchange_area.hpp"

#include "core/gauss_rule.hpp"
#include "engine/analytic/contour_integral.hpp"
#include "engine/analytic/convex_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace hemi {

namespace {

/// Points and weights of a product rule over a polygon's area.
template <std::size_t N>
struct AreaRule {
    std::array<double, N * N> x, y, z, weight;

    explicit AreaRule(const BilinearMap& map) {
        const GaussRule gauss = gauss_rule(N);
        std::size_t k = 0;
        for (std::size_t row = 0; row < N; ++row) {
            for (std::size_t column = 0; column < N; ++column, ++k) {
                const double s = gauss.points[column];
                const double t = gauss.points[row];
                const Vec3 point = map.point(s, t);
                x[k] = point.x;
                y[k] = point.y;
                z[k] = point.z;
                weight[k] = gauss.weights[column] * gauss.weights[row] * map.jacobian_at(s, t);
            }
        }
    }
};

/// The rule of four points for far patches: 2 x 2 Gauss points; for a triangle the centroid and three points
/// about it, which is exact to the same third degree, where Gauss points on a folded square are not.
/// Source of the latter: G. Strang, G. J. Fix, "An Analysis of the Finite Element Method", 1973.
AreaRule<2> far_rule(std::span<const Vec3> polygon, const Vec3& normal) {
    const BilinearMap map(polygon, normal);
    AreaRule<2> rule(map);
    if (polygon.size() != 3) {
        return rule;
    }
    const double area = 4.0 * map.jacobian;
    const Vec3 centroid = (polygon[0] + polygon[1] + polygon[2]) / 3.0;
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3 point = k < 3 ? 0.6 * centroid + 0.4 * polygon[k] : centroid;
        rule.x[k] = point.x;
        rule.y[k] = point.y;
        rule.z[k] = point.z;
        rule.weight[k] = (k < 3 ? 25.0 / 48.0 : -9.0 / 16.0) * area;
    }
    return rule;
}

/// Heights of points above a plane.
template <std::size_t N>
std::array<double, N> heights(const std::array<double, N>& x, const std::array<double, N>& y,
                              const std::array<double, N>& z, const Plane& plane) {
    std::array<double, N> result;
    for (std::size_t k = 0; k < N; ++k) {
        result[k] = plane.normal.x * (x[k] - plane.at.x) + plane.normal.y * (y[k] - plane.at.y) +
                    plane.normal.z * (z[k] - plane.at.z);
    }
    return result;
}

/// ∫∫ cos cos / (pi r²) by all pairs of points of two rules. The heights of b's points above a's plane are
/// r cos at a, whatever the point of a: one division a pair remains.
template <std::size_t N, typename Rule>
double product_rule(const Rule& a, const Plane& plane_a, const Rule& b, const Plane& plane_b) {
    std::array<double, N> weight_a = heights<N>(a.x, a.y, a.z, plane_b);
    std::array<double, N> weight_b = heights<N>(b.x, b.y, b.z, plane_a);
    for (std::size_t k = 0; k < N; ++k) {
        weight_a[k] *= a.weight[k];
        weight_b[k] *= b.weight[k];
    }
    double sum = 0.0;
    for (std::size_t k = 0; k < N; ++k) {
        std::array<double, N> terms;
        for (std::size_t l = 0; l < N; ++l) {
            const double x = b.x[l] - a.x[k];
            const double y = b.y[l] - a.y[k];
            const double z = b.z[l] - a.z[k];
            const double squared = x * x + y * y + z * z;
            terms[l] = weight_b[l] / (squared * squared);
        }
        double row = 0.0;
        for (std::size_t l = 0; l < N; ++l) {
            row += terms[l];
        }
        sum += weight_a[k] * row;
    }
    return sum / std::numbers::pi;
}

template <std::size_t N>
double product_rule(std::span<const Vec3> a, const Plane& plane_a, std::span<const Vec3> b,
                    const Plane& plane_b) {
    return product_rule<N * N>(AreaRule<N>(BilinearMap(a, plane_a.normal)), plane_a,
                               AreaRule<N>(BilinearMap(b, plane_b.normal)), plane_b);
}

/// What rounding of the corners can do to lengths, wherever the scene lies.
double coordinate_rounding(const Bounds& bounds) {
    double magnitude = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        magnitude = std::max({magnitude, std::abs(bounds.lower[axis]), std::abs(bounds.upper[axis])});
    }
    return 16.0 * std::numeric_limits<double>::epsilon() * magnitude;
}

/// Distances of bounding spheres, in diameters of the larger one, from which product rules of n x n points
/// on either side do.
struct Reach {
    std::size_t points;
    double distance;
};
constexpr std::array<Reach, 3> standard_reach{{{2, 5.5}, {3, 1.6}, {4, 0.6}}};
constexpr std::array<Reach, 4> exact_reach{{{2, 80.0}, {3, 12.0}, {4, 4.5}, {6, 1.7}}};

double product_rule(std::size_t points, std::span<const Vec3> a, const Plane& plane_a,
                    std::span<const Vec3> b, const Plane& plane_b) {
    switch (points) {
    case 2:
        return product_rule<2>(a, plane_a, b, plane_b);
    case 3:
        return product_rule<3>(a, plane_a, b, plane_b);
    case 4:
        return product_rule<4>(a, plane_a, b, plane_b);
    default:
        return product_rule<6>(a, plane_a, b, plane_b);
    }
}

} // namespace

double point_factor(const Vec3& at, const Vec3& normal, std::span<const Vec3> polygon) {
    if (glm::dot(area_vector(polygon), at - polygon[0]) <= 0.0) {
        return 0.0;
    }
    const ConvexPolygon front = clip(polygon, {at, normal});
    double sum = 0.0;
    for (std::size_t k = 0; k < front.count; ++k) {
        const Vec3 a = front.points[k] - at;
        const Vec3 b = front.points[(k + 1) % front.count] - at;
        const Vec3 cross = glm::cross(a, b);
        const double sine = glm::length(cross);
        if (sine > 0.0) {
            sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(normal, cross) / sine;
        }
    }
    // Seen from the front, a polygon that is counter-clockwise about its normal runs clockwise.
    return std::max(0.0, -sum / (2.0 * std::numbers::pi));
}

double solid_angle(const Vec3& at, std::span<const Vec3> polygon) {
    if (polygon.size() < 3 || glm::dot(area_vector(polygon), at - polygon[0]) <= 0.0) {
        return 0.0;
    }
    // Seen from the front the triple product is negative.
    const Vec3 a = polygon[0] - at;
    const double length_a = glm::length(a);
    double sum = 0.0;
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
        const Vec3 b = polygon[k] - at;
        const Vec3 c = polygon[k + 1] - at;
        const double length_b = glm::length(b);
        const double length_c = glm::length(c);
        const double below = length_a * length_b * length_c + glm::dot(a, b) * length_c +
                             glm::dot(a, c) * length_b + glm::dot(b, c) * length_a;
        sum += 2.0 * std::atan2(-glm::dot(a, glm::cross(b, c)), below);
    }
    return std::max(0.0, sum);
}

ExchangeAreas::ExchangeAreas(const PatchMesh& mesh, ExchangeRule rule)
    : rule_(rule), origin_(mesh.bounds().centre()), rounding_(coordinate_rounding(mesh.bounds())),
      far_(rule == ExchangeRule::standard ? standard_reach[0].distance : exact_reach[0].distance),
      patches_(mesh.size()) {
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        PatchCorners corners = mesh.corners(i);
        Vec3 sum(0.0);
        for (std::uint32_t k = 0; k < corners.count; ++k) {
            corners.points[k] -= origin_;
            sum += corners.points[k];
        }
        Patch& patch = patches_[i];
        patch.corners = corners.count;
        patch.surface = mesh.surface_of()[i];
        patch.normal = mesh.normal(i);
        patch.area = mesh.areas()[i];
        patch.centre = sum / static_cast<double>(corners.count);
        patch.radius = 0.0;
        for (const Vec3& corner : corners.polygon()) {
            patch.radius = std::max(patch.radius, glm::length(corner - patch.centre));
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3& corner = corners.points[std::min<std::size_t>(k, corners.count - 1)];
            patch.corner_x[k] = corner.x;
            patch.corner_y[k] = corner.y;
            patch.corner_z[k] = corner.z;
        }
        const AreaRule<2> points = far_rule(corners.polygon(), patch.normal);
        patch.x = points.x;
        patch.y = points.y;
        patch.z = points.z;
        patch.weight = points.weight;
    }
}

double ExchangeAreas::operator()(std::uint32_t i, std::uint32_t j) const {
    const Patch& a = patches_[std::min(i, j)];
    const Patch& b = patches_[std::max(i, j)];
    if (a.surface == b.surface) {
        return 0.0;
    }
    const Vec3 offset = b.centre - a.centre;
    const double height_b = glm::dot(offset, a.normal);
    const double height_a = -glm::dot(offset, b.normal);
    if (height_b <= -b.radius || height_a <= -a.radius) {
        return 0.0;
    }
    const Plane plane_a{a.centre, a.normal};
    const Plane plane_b{b.centre, b.normal};
    bool clip = false;
    // Spheres decide for most pairs.
    if (height_b < b.radius || height_a < a.radius) {
        const auto [lowest_b, highest_b] =
            std::ranges::minmax(heights<4>(b.corner_x, b.corner_y, b.corner_z, plane_a));
        const auto [lowest_a, highest_a] =
            std::ranges::minmax(heights<4>(a.corner_x, a.corner_y, a.corner_z, plane_b));
        if (highest_b <= rounding_ || highest_a <= rounding_) {
            return 0.0;
        }
        clip = lowest_a < -rounding_ || lowest_b < -rounding_;
    }
    const double gap = glm::length(offset) - a.radius - b.radius;
    const double distance = gap / (2.0 * std::max(a.radius, b.radius));
    if (!clip && distance >= far_) {
        return product_rule<4>(a, plane_a, b, plane_b);
    }
    return near_area(a, b, clip, distance);
}

double ExchangeAreas::at_point(const Vec3& at, const Vec3& normal, std::uint32_t j) const {
    const Patch& patch = patches_[j];
    const Vec3 eye = at - origin_;
    const Vec3 offset = patch.centre - eye;
    const double above = glm::dot(offset, normal);
    const double in_front = -glm::dot(offset, patch.normal);
    if (above <= -patch.radius || in_front <= rounding_) {
        return 0.0;
    }
    const double gap = glm::length(offset) - patch.radius;
    if (above >= patch.radius && gap >= 2.0 * patch.radius * far_) {
        double sum = 0.0;
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 way = Vec3(patch.x[k], patch.y[k], patch.z[k]) - eye;
            const double squared = glm::dot(way, way);
            sum += patch.weight[k] * glm::dot(way, normal) / (squared * squared);
        }
        return sum * in_front / std::numbers::pi;
    }
    const std::array<Vec3, 4> corners = corners_of(patch);
    return point_factor(eye, normal, std::span(corners).first(patch.corners));
}

double ExchangeAreas::solid_angle_at(const Vec3& at, std::uint32_t j) const {
    const Patch& patch = patches_[j];
    const Vec3 eye = at - origin_;
    if (glm::dot(eye - patch.centre, patch.normal) <= rounding_) {
        return 0.0;
    }
    const std::array<Vec3, 4> corners = corners_of(patch);
    return solid_angle(eye, std::span(corners).first(patch.corners));
}

std::array<Vec3, 4> ExchangeAreas::corners_of(const Patch& patch) {
    std::array<Vec3, 4> corners;
    for (std::size_t k = 0; k < patch.corners; ++k) {
        corners[k] = Vec3(patch.corner_x[k], patch.corner_y[k], patch.corner_z[k]);
    }
    return corners;
}

double ExchangeAreas::near_area(const Patch& a, const Patch& b, bool clipped, double distance) const {
    // Coordinates of about 1 about the pair, in powers of two, so that the scene's units cost no bits.
    const Vec3 middle = 0.5 * (a.centre + b.centre);
    const double size = std::max(a.radius, b.radius) * std::max(1.0, distance);
    const double unit = std::ldexp(1.0, std::ilogb(size));
    const auto local = [&](const Patch& patch) {
        ConvexPolygon polygon;
        for (std::size_t k = 0; k < patch.corners; ++k) {
            polygon.add((Vec3(patch.corner_x[k], patch.corner_y[k], patch.corner_z[k]) - middle) / unit);
        }
        return polygon;
    };
    const Plane plane_a{(a.centre - middle) / unit, a.normal};
    const Plane plane_b{(b.centre - middle) / unit, b.normal};
    ConvexPolygon polygon_a = local(a);
    ConvexPolygon polygon_b = local(b);
    if (clipped) {
        polygon_a = clip(polygon_a.span(), plane_b);
        polygon_b = clip(polygon_b.span(), plane_a);
        if (polygon_a.count < 3 || polygon_b.count < 3) {
            return 0.0;
        }
    }

    const auto reaches = rule_ == ExchangeRule::standard ? std::span<const Reach>(standard_reach)
                                                         : std::span<const Reach>(exact_reach);
    for (const Reach& reach : reaches) {
        if (distance < reach.distance) {
            continue;
        }
        double sum = 0.0;
        for (std::size_t k = 0; k < polygon_a.pieces(); ++k) {
            for (std::size_t l = 0; l < polygon_b.pieces(); ++l) {
                sum += product_rule(reach.points, polygon_a.piece(k).span(), plane_a,
                                    polygon_b.piece(l).span(), plane_b);
            }
        }
        return std::max(0.0, sum) * unit * unit;
    }

    const double smaller = std::min(a.area, b.area) / (unit * unit);
    ContourRule rule;
    rule.tolerance = (rule_ == ExchangeRule::standard ? 1e-6 : 1e-13) * std::min(1.0, smaller);
    rule.rounding = std::max(2.0 * rounding_ / unit, 1e-14);
    return std::max(0.0, contour_integral(polygon_a.span(), polygon_b.span(), rule)) * unit * unit;
}

} // namespace hemi
