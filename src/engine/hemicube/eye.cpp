#include "engine/hemicube/eye.hpp"

#include "core/gauss_rule.hpp"
#include "core/splitmix.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/scene/near_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

namespace hemi {

namespace {

constexpr std::uint32_t max_eyes_a_side = 8;

// Patches up to this aspect ratio have as many points as were asked for, in rows; longer ones have points for
// their length, spread without rows, up to max_more_eye_points times as many.
constexpr double max_compact_aspect = 2.0 + 1e-9;

/// Point of a rule on [0, 1]; the weights sum to 1.
struct EdgePoint {
    double at;
    double weight;
};

std::vector<EdgePoint> edge_points(std::uint32_t k) {
    const GaussRule rule = gauss_rule(k);
    std::vector<EdgePoint> points;
    for (std::size_t n = 0; n < k; ++n) {
        points.push_back({0.5 * (1.0 + rule.points[n]), 0.5 * rule.weights[n]});
    }
    return points;
}

struct TrianglePoint {
    double b, c; ///< barycentric coordinates of corners 1 and 2
    double weight;
};

/// Symmetric rules of degree 1, 2, 4 and 6; above, the rule of the square folded onto the triangle.
/// Source: D. A. Dunavant, "High degree efficient symmetrical Gaussian quadrature rules for the triangle",
/// International Journal for Numerical Methods in Engineering 21, 1985.
std::vector<TrianglePoint> triangle_points(std::uint32_t k) {
    std::vector<TrianglePoint> points;
    const auto three = [&](double b, double weight) {
        const double a = 1.0 - 2.0 * b;
        points.insert(points.end(), {{b, b, weight}, {a, b, weight}, {b, a, weight}});
    };
    const auto six = [&](double a, double b, double weight) {
        const double c = 1.0 - a - b;
        points.insert(
            points.end(),
            {{a, b, weight}, {b, a, weight}, {a, c, weight}, {c, a, weight}, {b, c, weight}, {c, b, weight}});
    };
    switch (k) {
    case 1:
        return {{1.0 / 3.0, 1.0 / 3.0, 1.0}};
    case 2:
        three(1.0 / 6.0, 1.0 / 3.0);
        return points;
    case 3:
        three(0.445948490915965, 0.223381589678011);
        three(0.091576213509771, 0.109951743655322);
        return points;
    case 4:
        three(0.249286745170910, 0.116786275726379);
        three(0.063089014491502, 0.050844906370207);
        six(0.053145049844817, 0.310352451033784, 0.082851075618374);
        return points;
    default:
        for (const EdgePoint& u : edge_points(k)) {
            for (const EdgePoint& v : edge_points(k)) {
                points.push_back({u.at * (1.0 - v.at), u.at * v.at, 2.0 * u.at * u.weight * v.weight});
            }
        }
        return points;
    }
}

EyePoint eye_at_centre(const PatchMesh& mesh, std::uint32_t patch) {
    EyePoint eye;
    eye.position = mesh.centres()[patch];
    eye.normal = mesh.normal(patch);
    eye.surface = mesh.surface_of()[patch];
    return eye;
}

/// Point (u, v) of a quadrilateral, bilinear, and how much area a step in u and v spans there.
std::pair<Vec3, double> at_parameters(const PatchCorners& corners, double u, double v) {
    const auto& p = corners.points;
    const Vec3 along_u = (1.0 - v) * (p[1] - p[0]) + v * (p[2] - p[3]);
    const Vec3 along_v = (1.0 - u) * (p[3] - p[0]) + u * (p[2] - p[1]);
    return {p[0] + u * (p[1] - p[0]) + v * along_v, glm::length(glm::cross(along_u, along_v))};
}

/// Makes the shares of the points from `first` on sum to 1.
void normalise_shares(std::vector<EyePoint>& points, std::size_t first) {
    double sum = 0.0;
    for (std::size_t at = first; at < points.size(); ++at) {
        sum += points[at].share;
    }
    for (std::size_t at = first; at < points.size(); ++at) {
        points[at].share /= sum;
    }
}

/// Length over width: of a quadrilateral the means of opposite edges, of a triangle its middle edge over the
/// height above that, as of the rectangle that a right triangle is half of.
double aspect_of(const PatchCorners& corners, double area) {
    const auto& p = corners.points;
    if (corners.count == 3) {
        std::array<double, 3> edges{glm::distance(p[0], p[1]), glm::distance(p[1], p[2]),
                                    glm::distance(p[2], p[0])};
        std::sort(edges.begin(), edges.end());
        return edges[1] * edges[1] / (2.0 * area);
    }
    const double u = glm::distance(p[0], p[1]) + glm::distance(p[3], p[2]);
    const double v = glm::distance(p[0], p[3]) + glm::distance(p[1], p[2]);
    return std::max(u, v) / std::min(u, v);
}

/// The same patch with its corners in such an order that the first coordinate of a point of the lattice below
/// runs along it: from the sharpest corner of a triangle, along the longer edges of a quadrilateral.
void turn_lengthwise(PatchCorners& corners) {
    auto& p = corners.points;
    if (corners.count == 3) {
        std::size_t sharpest = 0; // opposite the shortest edge
        double shortest = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < 3; ++k) {
            const double edge = glm::distance(p[(k + 1) % 3], p[(k + 2) % 3]);
            if (edge < shortest) {
                shortest = edge;
                sharpest = k;
            }
        }
        std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(sharpest), p.begin() + 3);
    } else if (glm::distance(p[0], p[1]) + glm::distance(p[3], p[2]) >
               glm::distance(p[0], p[3]) + glm::distance(p[1], p[2])) {
        std::rotate(p.begin(), p.begin() + 1, p.begin() + 4);
    }
}

/// Appends `count` points of a Fibonacci lattice. Where something near cuts the view off along a line,
/// rows and columns of points would all cross it at once; and along a needle there are `count` places.
void add_spread_points(const PatchMesh& mesh, std::uint32_t patch, std::uint32_t count, double aspect,
                       std::vector<EyePoint>& points) {
    PatchCorners corners = mesh.corners(patch);
    if (aspect > max_compact_aspect) {
        turn_lengthwise(corners);
    }
    const auto& p = corners.points;
    EyePoint eye = eye_at_centre(mesh, patch);
    const std::size_t first = points.size();
    for (; eye.index < count; ++eye.index) {
        const double v = (eye.index + 0.5) / count;
        const double turns = eye.index * (std::numbers::phi - 1.0) + 0.5;
        const double u = turns - std::floor(turns);
        if (corners.count == 3) {
            const double root = std::sqrt(v);
            eye.position = p[0] + root * ((1.0 - u) * (p[1] - p[0]) + u * (p[2] - p[0]));
            eye.share = 1.0;
        } else {
            std::tie(eye.position, eye.share) = at_parameters(corners, u, v);
        }
        points.push_back(eye);
    }
    normalise_shares(points, first);
}

/// Appends the k x k points (or those of the triangle's rule) of a patch.
void add_gauss_points(const PatchMesh& mesh, std::uint32_t patch, std::uint32_t k,
                      std::vector<EyePoint>& points) {
    EyePoint eye = eye_at_centre(mesh, patch);
    if (k == 1) {
        points.push_back(eye);
        return;
    }
    const PatchCorners corners = mesh.corners(patch);
    const auto& p = corners.points;
    if (corners.count == 3) {
        for (const TrianglePoint& point : triangle_points(k)) {
            eye.position = p[0] + point.b * (p[1] - p[0]) + point.c * (p[2] - p[0]);
            eye.share = point.weight;
            points.push_back(eye);
            ++eye.index;
        }
        return;
    }
    const std::size_t first = points.size();
    const std::vector<EdgePoint> on_edges = edge_points(k);
    for (const EdgePoint& v : on_edges) {
        for (const EdgePoint& u : on_edges) {
            std::tie(eye.position, eye.share) = at_parameters(corners, u.at, v.at);
            eye.share *= u.weight * v.weight;
            points.push_back(eye);
            ++eye.index;
        }
    }
    normalise_shares(points, first);
}

} // namespace

void check_eye_points(std::uint32_t count) {
    for (std::uint32_t k = 1; k <= max_eyes_a_side; ++k) {
        if (k * k == count) {
            return;
        }
    }
    throw InvalidArgument(fmt::format("{} eye points a patch; it must be 1, 4, 9, 16 … or {}", count,
                                      max_eyes_a_side * max_eyes_a_side));
}

EyePoints make_eye_points(const PatchMesh& mesh, std::uint32_t count, std::uint32_t near_count) {
    check_eye_points(count);
    check_eye_points(near_count);
    const auto side = [](std::uint32_t square) {
        return static_cast<std::uint32_t>(std::lround(std::sqrt(square)));
    };
    std::vector<std::uint32_t> near_sides(mesh.size(), 0); // 0: nothing is near
    if (near_count > 1) {
        for (const NearSurface& near : find_near_surfaces(mesh)) {
            const double k = std::ceil(0.5 / std::max(near.gap, 0.01));
            near_sides[near.patch] =
                std::max(side(count), std::min(side(near_count), static_cast<std::uint32_t>(k)));
        }
    }
    EyePoints eyes;
    eyes.points.reserve(std::size_t{mesh.size()} * count);
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        eyes.first.push_back(static_cast<std::uint32_t>(eyes.points.size()));
        const double aspect = aspect_of(mesh.corners(patch), mesh.areas()[patch]);
        const bool needle = count > 1 && aspect > max_compact_aspect;
        const auto more = needle ? static_cast<std::uint32_t>(std::min<double>(
                                       max_more_eye_points, std::ceil(aspect / max_compact_aspect)))
                                 : 1u;
        if (needle || near_sides[patch] > 1) {
            const std::uint32_t compact = std::max(near_sides[patch] * near_sides[patch], count * more);
            add_spread_points(mesh, patch, compact, aspect, eyes.points);
        } else {
            add_gauss_points(mesh, patch, side(count), eyes.points);
        }
    }
    eyes.first.push_back(static_cast<std::uint32_t>(eyes.points.size()));
    return eyes;
}

EyeFrame::EyeFrame(const Vec3& normal, std::uint32_t patch, std::uint32_t eye, std::uint64_t seed)
    : z(normal) {
    // The axis least along the normal gives a well-conditioned tangent.
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
        if (std::abs(normal[k]) < std::abs(normal[axis])) {
            axis = k;
        }
    }
    Vec3 other(0.0);
    other[axis] = 1.0;
    const Vec3 tangent = glm::normalize(glm::cross(other, normal));
    const Vec3 bitangent = glm::cross(normal, tangent);
    const std::uint64_t hash = splitmix(splitmix(seed) ^ patch ^ std::uint64_t{eye} << 32);
    const double angle = static_cast<double>(hash >> 11) * 0x1p-53 * 2.0 * std::numbers::pi;
    x = std::cos(angle) * tangent + std::sin(angle) * bitangent;
    y = glm::cross(z, x);
}

Vec3 face_direction(int face, double right, double up) {
    switch (face) {
    case 0:
        return {right, up, 1.0};
    case 1:
        return {1.0, right, up};
    case 2:
        return {-right, 1.0, up};
    case 3:
        return {-1.0, -right, up};
    default:
        return {right, -1.0, up};
    }
}

} // namespace hemi
