#include "support/polygon_factors.hpp"

#include "core/gauss_rule.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace hemi::test {

Plane plane_of(std::span<const Vec3> polygon) {
    const Vec3 normal = glm::normalize(area_vector(polygon));
    return {normal, glm::dot(normal, area_centroid(polygon))};
}

ConvexPolygon::ConvexPolygon(std::span<const Vec3> corners) : count_(corners.size()) {
    std::copy(corners.begin(), corners.end(), corners_.begin());
}

void ConvexPolygon::clip(const Plane& plane) {
    std::array<double, 28> height{};
    bool cut = false;
    for (std::size_t k = 0; k < count_; ++k) {
        height[k] = plane.height(corners_[k]);
        cut = cut || height[k] < 0.0;
    }
    if (!cut) {
        return;
    }
    std::array<Vec3, 28> kept{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < count_; ++k) {
        const std::size_t next = k + 1 < count_ ? k + 1 : 0;
        if (height[k] >= 0.0) {
            kept.at(count++) = corners_[k];
        }
        if ((height[k] > 0.0 && height[next] < 0.0) || (height[k] < 0.0 && height[next] > 0.0)) {
            const double t = height[k] / (height[k] - height[next]);
            kept.at(count++) = corners_[k] + t * (corners_[next] - corners_[k]);
        }
    }
    std::copy_n(kept.begin(), count, corners_.begin());
    count_ = count < 3 ? 0 : count;
}

double point_factor(const Vec3& point, const Vec3& normal, const ConvexPolygon& polygon) {
    const auto corners = polygon.corners();
    double sum = 0.0;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const Vec3 a = corners[k] - point;
        const Vec3 b = corners[k + 1 < corners.size() ? k + 1 : 0] - point;
        const Vec3 across = glm::cross(a, b);
        const double sine = glm::length(across);
        if (sine > 0.0) {
            sum += std::atan2(sine, glm::dot(a, b)) / sine * glm::dot(normal, across);
        }
    }
    return -sum / (2.0 * std::numbers::pi);
}

namespace {

struct Node {
    double at;
    double weight;
};

/// Gauss–Legendre on [0, 1].
std::vector<Node> gauss_nodes(std::size_t n) {
    const GaussRule rule = gauss_rule(n);
    std::vector<Node> nodes;
    for (std::size_t k = 0; k < n; ++k) {
        nodes.push_back({0.5 * (1.0 + rule.points[k]), 0.5 * rule.weights[k]});
    }
    return nodes;
}

/// The same, crowded towards both ends: smooth there whatever the integrand's logarithms.
std::vector<Node> graded_nodes(std::size_t n) {
    std::vector<Node> nodes = gauss_nodes(n);
    for (Node& node : nodes) {
        const double s = node.at;
        node.at = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        node.weight *= 30.0 * s * s * (1.0 - s) * (1.0 - s);
    }
    return nodes;
}

struct Edge {
    Vec3 start{0.0};
    Vec3 direction{0.0}; ///< unit
    double length = 0.0;
};

std::vector<Edge> edges_of(const ConvexPolygon& polygon) {
    const auto corners = polygon.corners();
    std::vector<Edge> edges;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const Vec3 along = corners[(k + 1) % corners.size()] - corners[k];
        const double length = glm::length(along);
        if (length > 0.0) {
            edges.push_back({corners[k], along / length, length});
        }
    }
    return edges;
}

/// Integral of ln r from a point to the points of an edge.
double log_distance(const Vec3& point, const Edge& edge) {
    const double foot = glm::dot(point - edge.start, edge.direction);
    const double height = glm::length(point - edge.start - foot * edge.direction);
    const auto primitive = [height](double s) {
        const double squared = s * s + height * height;
        if (squared == 0.0) {
            return 0.0;
        }
        return 0.5 * s * std::log(squared) - s + (height > 0.0 ? height * std::atan(s / height) : 0.0);
    };
    return primitive(edge.length - foot) - primitive(-foot);
}

/// Double integral of ln r over two edges. The first is cut where the second begins, ends or comes nearest.
double log_distance(const Edge& a, const Edge& b) {
    static const std::vector<Node> nodes = graded_nodes(32);
    std::array<double, 5> cuts{0.0, 1.0, 1.0, 1.0, 1.0};
    std::size_t count = 1;
    const auto add = [&](double length) {
        const double t = length / a.length;
        if (t > 1e-9 && t < 1.0 - 1e-9) {
            cuts.at(count++) = t;
        }
    };
    add(glm::dot(b.start - a.start, a.direction));
    add(glm::dot(b.start + b.length * b.direction - a.start, a.direction));
    const double cosine = glm::dot(a.direction, b.direction);
    if (1.0 - cosine * cosine > 1e-6) {
        const Vec3 apart = b.start - a.start;
        add((glm::dot(apart, a.direction) - cosine * glm::dot(apart, b.direction)) / (1.0 - cosine * cosine));
    }
    std::sort(cuts.begin(), cuts.begin() + static_cast<std::ptrdiff_t>(count));
    double sum = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
        const double width = cuts.at(k + 1) - cuts[k];
        for (const Node& node : nodes) {
            const double t = cuts[k] + width * node.at;
            sum += width * node.weight * log_distance(a.start + t * a.length * a.direction, b);
        }
    }
    return a.length * sum;
}

double size_of(std::span<const Vec3> polygon) {
    Bounds bounds;
    for (const Vec3& corner : polygon) {
        bounds.add(corner);
    }
    return bounds.diagonal();
}

} // namespace

std::vector<QuadraturePoint> gauss_points(std::span<const Vec3> polygon, std::size_t n) {
    if (polygon.size() < 3 || polygon.size() > 4) {
        throw std::invalid_argument("gauss_points: a triangle or a quadrilateral");
    }
    const std::vector<Node> nodes = gauss_nodes(n);
    const Vec3& p0 = polygon[0];
    const Vec3& p1 = polygon[1];
    const Vec3& p2 = polygon[2];
    const Vec3& p3 = polygon.back(); // of a triangle: corner 2 again
    std::vector<QuadraturePoint> points;
    double area = 0.0;
    for (const Node& u : nodes) {
        for (const Node& v : nodes) {
            const Vec3 along_u = (1.0 - v.at) * (p1 - p0) + v.at * (p2 - p3);
            const Vec3 along_v = (1.0 - u.at) * (p3 - p0) + u.at * (p2 - p1);
            const double weight = u.weight * v.weight * glm::length(glm::cross(along_u, along_v));
            points.push_back(
                {p0 + u.at * (p1 - p0) + v.at * ((1.0 - u.at) * (p3 - p0) + u.at * (p2 - p1)), weight});
            area += weight;
        }
    }
    for (QuadraturePoint& point : points) {
        point.weight /= area;
    }
    return points;
}

double exchange_area(std::span<const Vec3> i, std::span<const Vec3> j) {
    const Plane plane_i = plane_of(i);
    const Plane plane_j = plane_of(j);
    ConvexPolygon from(i);
    ConvexPolygon to(j);
    from.clip(plane_j);
    to.clip(plane_i);
    const auto in_front = [](const ConvexPolygon& polygon, const Plane& plane, double size) {
        const auto corners = polygon.corners();
        return std::any_of(corners.begin(), corners.end(),
                           [&](const Vec3& corner) { return plane.height(corner) > 1e-12 * size; });
    };
    if (from.empty() || to.empty() || !in_front(from, plane_j, size_of(j)) ||
        !in_front(to, plane_i, size_of(i))) {
        return 0.0;
    }
    const double apart = glm::length(area_centroid(i) - area_centroid(j));
    if (i.size() == from.corners().size() && i.size() <= 4 &&
        apart > 5.0 * std::max(size_of(i), size_of(j))) {
        double sum = 0.0;
        for (const QuadraturePoint& point : gauss_points(from.corners(), 4)) {
            sum += point.weight * point_factor(point.position, plane_i.normal, to);
        }
        return sum * glm::length(area_vector(from.corners()));
    }
    double sum = 0.0;
    const std::vector<Edge> edges_j = edges_of(to);
    for (const Edge& a : edges_of(from)) {
        for (const Edge& b : edges_j) {
            const double cosine = glm::dot(a.direction, b.direction);
            if (std::abs(cosine) > 1e-15) {
                sum += cosine * log_distance(a, b);
            }
        }
    }
    return std::max(0.0, sum / (2.0 * std::numbers::pi));
}

} // namespace hemi::test
