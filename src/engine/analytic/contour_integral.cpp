#include "engine/analytic/contour_integral.hpp"

#include "core/gauss_rule.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace hemi {

namespace {

struct Edge {
    Vec3 start;
    Vec3 end;
    Vec3 direction; ///< unit length
    double length;

    Edge(const Vec3& from, const Vec3& to) : start(from), end(to), direction(to - from) {
        length = glm::length(direction);
        direction /= length;
    }
};

/// The nearest points of two edges, as lengths along them.
struct Approach {
    double along_a;
    double along_b;
    double distance;
};

Approach closest_approach(const Edge& a, const Edge& b) {
    const Vec3 offset = a.start - b.start;
    const double cosine = glm::dot(a.direction, b.direction);
    const double on_a = glm::dot(a.direction, offset);
    const double on_b = glm::dot(b.direction, offset);
    Approach best{0.0, 0.0, std::numeric_limits<double>::infinity()};
    const auto consider = [&](double s, double t) {
        const double distance = glm::length(offset + s * a.direction - t * b.direction);
        if (distance < best.distance) {
            best = {s, t, distance};
        }
    };
    // The ends first: the crossing of two nearly parallel lines is known to few digits only.
    consider(0.0, std::clamp(on_b, 0.0, b.length));
    consider(a.length, std::clamp(on_b + a.length * cosine, 0.0, b.length));
    consider(std::clamp(-on_a, 0.0, a.length), 0.0);
    consider(std::clamp(b.length * cosine - on_a, 0.0, a.length), b.length);
    const Vec3 cross = glm::cross(a.direction, b.direction);
    const double sine_squared = glm::dot(cross, cross);
    if (sine_squared > 0.0) {
        const double s = (cosine * on_b - on_a) / sine_squared;
        const double t = on_b + s * cosine;
        if (s > 0.0 && s < a.length && t > 0.0 && t < b.length) {
            consider(s, t);
        }
    }
    return best;
}

/// x·ln(y), 0 where x and y vanish.
double x_log(double x, double y) {
    return x * std::log(std::max(y, std::numeric_limits<double>::min()));
}

/// ∫ ln|p - q| dq over the edge.
double log_integral(const Vec3& p, const Edge& edge) {
    const Vec3 to_start = p - edge.start;
    const Vec3 to_end = p - edge.end;
    const double along = glm::dot(to_start, edge.direction);
    const double height = glm::length(glm::cross(to_start, edge.direction));
    const double angle = std::atan2(height * edge.length, glm::dot(to_start, to_end));
    return 0.5 * (x_log(edge.length - along, glm::dot(to_end, to_end)) +
                  x_log(along, glm::dot(to_start, to_start))) -
           edge.length + height * angle;
}

/// The same, integrated once more over an edge that meets the other in a point or covers part of it.
///
/// With lengths s, t measured from there, s ∂/∂s ln r + t ∂/∂t ln r = 1, so that by the divergence theorem
/// 2 ∫∫ ln r = ∮ ln r (s, t)·n - area, and only integrals along one edge remain.
double touching_integral(const Edge& a, const Edge& b, const Approach& at) {
    return 0.5 * ((a.length - at.along_a) * log_integral(a.end, b) + at.along_a * log_integral(a.start, b) +
                  (b.length - at.along_b) * log_integral(b.end, a) + at.along_b * log_integral(b.start, a) -
                  a.length * b.length);
}

/// Φ of the parallel case: Φ'' = ½ ln(x² + h²).
double parallel_term(double x, double h) {
    const double squared = x * x + h * h;
    return 0.25 * x_log((x - h) * (x + h), squared) - 0.75 * x * x + h * x * std::atan2(x, h);
}

double parallel_integral(const Edge& a, const Edge& b) {
    const Vec3 to_start = b.start - a.start;
    const Vec3 to_end = b.end - a.start;
    const double from = glm::dot(to_start, a.direction);
    const double to = glm::dot(to_end, a.direction);
    const double height = glm::length(glm::cross(0.5 * (to_start + to_end), a.direction));
    const double integral = (parallel_term(to, height) - parallel_term(to - a.length, height)) -
                            (parallel_term(from, height) - parallel_term(from - a.length, height));
    return to > from ? integral : -integral;
}

double gauss_integral(const Edge& outer, const Edge& inner, std::size_t order) {
    const GaussRule gauss = gauss_rule(order);
    const Vec3 middle = 0.5 * (outer.start + outer.end);
    const Vec3 half = 0.5 * (outer.end - outer.start);
    double sum = 0.0;
    for (std::size_t k = 0; k < order; ++k) {
        sum += gauss.weights[k] * log_integral(middle + gauss.points[k] * half, inner);
    }
    return 0.5 * outer.length * sum;
}

/// Logarithm of the sum of the half axes of the largest ellipse about an edge, with its ends as foci, in
/// which log_integral() is analytic as a function of the complex place along it. It is not where the place
/// meets an end of the inner edge, or its line: of two edges that are near each other and nearly parallel
/// that may be far from where they are nearest.
double analytic_reach(const Edge& outer, const Edge& inner) {
    const double half = 0.5 * outer.length;
    const Vec3 middle = 0.5 * (outer.start + outer.end);
    const auto reach_to = [](double along, double beside) {
        return std::acosh(std::complex<double>(along, beside)).real();
    };
    double reach = std::numeric_limits<double>::infinity();
    for (const Vec3& end : {inner.start, inner.end}) {
        const Vec3 way = (end - middle) / half;
        reach = std::min(
            reach, reach_to(glm::dot(way, outer.direction), glm::length(glm::cross(way, outer.direction))));
    }
    // Height above the inner line, as a vector, is linear along the outer edge.
    const Vec3 height = glm::cross((middle - inner.start) / half, inner.direction);
    const Vec3 slope = glm::cross(outer.direction, inner.direction);
    if (const double squared = glm::dot(slope, slope); squared > 0.0) {
        reach = std::min(reach, reach_to(-glm::dot(height, slope) / squared,
                                         glm::length(glm::cross(height, slope)) / squared));
    }
    return reach;
}

/// Gauss rules over pieces of the outer edge. As a function of the outer point, the inner integral is
/// analytic in an ellipse about the piece that just reaches the inner edge, and maybe a larger one; a rule of
/// n points then converges as (sum of its half axes)^-2n.
double graded_integral(const Edge& outer, const Edge& inner, double tolerance) {
    constexpr double order_max = 12.0;
    const double half = 0.5 * outer.length;
    const double gap = closest_approach(outer, inner).distance / half;
    const double digits = -0.5 * std::log(tolerance);
    double order = std::ceil(digits / std::asinh(gap));
    if (order > order_max) {
        order = std::min(order, std::ceil(digits / analytic_reach(outer, inner)));
    }
    // What is left at a singular point shrinks with the square of the piece.
    if (order <= order_max || tolerance >= 0.1) {
        return gauss_integral(outer, inner, static_cast<std::size_t>(std::clamp(order, 2.0, order_max)));
    }
    const Vec3 middle = 0.5 * (outer.start + outer.end);
    return graded_integral(Edge(outer.start, middle), inner, 4.0 * tolerance) +
           graded_integral(Edge(middle, outer.end), inner, 4.0 * tolerance);
}

double edge_integral(const Edge& a, const Edge& b, const ContourRule& rule) {
    // The shorter edge is the outer one: the integrand is smoother on it.
    const Edge& outer = a.length <= b.length ? a : b;
    const Edge& inner = a.length <= b.length ? b : a;
    const Approach approach = closest_approach(outer, inner);
    if (approach.distance <= rule.rounding) {
        return touching_integral(outer, inner, approach);
    }
    const double lean = glm::length(glm::cross(a.direction, b.direction)) * inner.length;
    // The closed form loses digits with the square of its largest length over the shorter edge.
    constexpr double closed_form_reach = 6.0;
    if (lean <= rule.rounding &&
        approach.distance + outer.length + inner.length <= closed_form_reach * outer.length) {
        return parallel_integral(outer, inner);
    }
    if (rule.fixed_order != 0) {
        return gauss_integral(outer, inner, rule.fixed_order);
    }
    return graded_integral(outer, inner, rule.tolerance);
}

} // namespace

double contour_integral(std::span<const Vec3> a, std::span<const Vec3> b, const ContourRule& rule) {
    // Perpendicular up to rounding.
    constexpr double perpendicular = 1e-15;
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Vec3& from = a[i];
        const Vec3& to = a[(i + 1) % a.size()];
        if (from == to) {
            continue;
        }
        const Edge edge_a(from, to);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const Vec3& start = b[j];
            const Vec3& end = b[(j + 1) % b.size()];
            if (start == end) {
                continue;
            }
            const Edge edge_b(start, end);
            const double cosine = glm::dot(edge_a.direction, edge_b.direction);
            if (std::abs(cosine) > perpendicular) {
                sum += cosine * edge_integral(edge_a, edge_b, rule);
            }
        }
    }
    return sum / (2.0 * std::numbers::pi);
}

} // namespace hemi
