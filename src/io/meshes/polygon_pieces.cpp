#include "io/meshes/polygon_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hemi::io {

namespace {

double extent(std::span<const Vec3> polygon) {
    Bounds bounds;
    for (const Vec3& point : polygon) {
        bounds.add(point);
    }
    return bounds.diagonal();
}

/// Sum of the angles that a walk along the edges turns by, about `normal`; the largest turn the wrong way.
struct Turning {
    double total = 0.0;
    double backwards = 0.0;
};

Turning turning(std::span<const Vec3> polygon, const Vec3& normal) {
    Turning result;
    const std::size_t n = polygon.size();
    for (std::size_t k = 0; k < n; ++k) {
        const Vec3 in = polygon[k] - polygon[(k + n - 1) % n];
        const Vec3 out = polygon[(k + 1) % n] - polygon[k];
        const double angle = std::atan2(glm::dot(glm::cross(in, out), normal), glm::dot(in, out));
        result.total += angle;
        result.backwards = std::max(result.backwards, -angle);
    }
    return result;
}

} // namespace

bool has_no_area(std::span<const Vec3> polygon) {
    // No looser than polygon_defect(), so that what that refuses for its area can be left out.
    double magnitude = 0.0;
    for (const Vec3& point : polygon) {
        magnitude = std::max({magnitude, std::abs(point.x), std::abs(point.y), std::abs(point.z)});
    }
    const double size = extent(polygon);
    const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * magnitude;
    return !(glm::length(area_vector(polygon)) > size * std::max(rounding, 1e-9 * size));
}

std::optional<std::string> many_corners_defect(std::span<const Vec3> polygon) {
    if (has_no_area(polygon)) {
        return "zero area";
    }
    const Vec3 normal = glm::normalize(area_vector(polygon));
    const double size = extent(polygon);
    for (const Vec3& point : polygon) {
        if (std::abs(glm::dot(point - polygon[0], normal)) > 1e-5 * size) {
            return "not planar";
        }
    }
    const Turning turn = turning(polygon, normal);
    constexpr double slack = 1e-5;
    if (turn.backwards > slack || std::abs(turn.total - 2.0 * std::numbers::pi) > slack) {
        return "not convex";
    }
    return std::nullopt;
}

void cut_into_pieces(std::span<const Vec3> polygon, std::vector<PolygonPiece>& pieces) {
    const auto add = [&pieces](const PolygonPiece& piece) {
        if (!has_no_area({piece.points.data(), piece.count})) {
            pieces.push_back(piece);
        }
    };
    std::size_t low = 0;
    std::size_t high = polygon.size() - 1;
    for (; high - low >= 3; ++low, --high) {
        add({{polygon[high], polygon[low], polygon[low + 1], polygon[high - 1]}, 4});
    }
    if (high - low == 2) {
        add({{polygon[high], polygon[low], polygon[low + 1], Vec3(0.0)}, 3});
    }
}

} // namespace hemi::io
