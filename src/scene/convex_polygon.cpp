#include "scene/convex_polygon.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

namespace hemi {

namespace {

/// Distance of a point to the left of the line from `from` to `to`, seen from the tip of the normal.
double left_of(const Vec3& normal, const Vec3& from, const Vec3& to, const Vec3& point) {
    return glm::dot(glm::cross(normal, glm::normalize(to - from)), point - from);
}

/// The part of a polygon on the left of a line, and that on its right; corners within `slack` of it are on
/// both.
std::pair<Polygon, Polygon> split(const Polygon& polygon, const Vec3& normal, const Segment& line,
                                  double slack) {
    std::vector<double> left;
    for (const Vec3& corner : polygon) {
        left.push_back(left_of(normal, line.from, line.to, corner));
    }
    std::pair<Polygon, Polygon> halves;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const std::size_t next = (k + 1) % polygon.size();
        if (left[k] >= -slack) {
            halves.first.push_back(polygon[k]);
        }
        if (left[k] <= slack) {
            halves.second.push_back(polygon[k]);
        }
        if (std::min(left[k], left[next]) < -slack && std::max(left[k], left[next]) > slack) {
            // From the lower end, so that both polygons at an edge find the same bits.
            const std::size_t low = left[k] < left[next] ? k : next;
            const std::size_t high = low == k ? next : k;
            const Vec3 point =
                polygon[low] + left[low] / (left[low] - left[high]) * (polygon[high] - polygon[low]);
            halves.first.push_back(point);
            halves.second.push_back(point);
        }
    }
    return halves;
}

double perimeter(std::span<const Vec3> polygon) {
    double sum = 0.0;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        sum += glm::distance(polygon[k], polygon[(k + 1) % polygon.size()]);
    }
    return sum;
}

} // namespace

Bounds bounds_of(std::span<const Vec3> polygon, double margin) {
    Bounds bounds;
    for (const Vec3& corner : polygon) {
        bounds.add(corner);
    }
    bounds.lower -= margin;
    bounds.upper += margin;
    return bounds;
}

bool contains(std::span<const Vec3> polygon, const Vec3& normal, const Vec3& point, double slack) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        if (left_of(normal, polygon[k], polygon[(k + 1) % polygon.size()], point) < -slack) {
            return false;
        }
    }
    return true;
}

std::optional<Segment> within(std::span<const Vec3> polygon, const Vec3& normal, const Segment& segment,
                              double slack) {
    double from = 0.0;
    double to = 1.0;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec3& corner = polygon[k];
        const Vec3& next = polygon[(k + 1) % polygon.size()];
        const double first = left_of(normal, corner, next, segment.from);
        const double last = left_of(normal, corner, next, segment.to);
        if (first <= slack && last <= slack) {
            return std::nullopt; // outside, or along this edge
        }
        const double crossing = first / (first - last);
        if (first < -slack) {
            from = std::max(from, crossing);
        } else if (last < -slack) {
            to = std::min(to, crossing);
        }
    }
    if ((to - from) * glm::distance(segment.from, segment.to) <= 2.0 * slack) {
        return std::nullopt;
    }
    const Vec3 direction = segment.to - segment.from;
    return Segment{segment.from + from * direction, segment.from + to * direction};
}

bool overlap(std::span<const Vec3> polygon, const Vec3& normal, std::span<const Vec3> other, double slack) {
    Polygon common(other.begin(), other.end());
    if (glm::dot(area_vector(other), normal) < 0.0) {
        std::reverse(common.begin(), common.end());
    }
    for (std::size_t k = 0; k < polygon.size() && common.size() > 2; ++k) {
        common = split(common, normal, {polygon[k], polygon[(k + 1) % polygon.size()]}, slack).first;
    }
    return common.size() > 2 && is_wide(common, slack);
}

DividedPolygon::DividedPolygon(Polygon polygon, const Vec3& normal, double slack)
    : normal_(normal), slack_(slack) {
    add(std::move(polygon));
}

void DividedPolygon::add(Polygon corners) {
    Node node;
    node.around = bounds_of(corners, 2.0 * slack_);
    node.corners = std::move(corners);
    nodes_.push_back(std::move(node));
}

void DividedPolygon::cut(const Segment& segment) {
    const Bounds along = bounds_of(std::array{segment.from, segment.to});
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
        const std::uint32_t at = open.back();
        open.pop_back();
        if (!overlap(nodes_[at].around, along)) {
            continue;
        }
        if (nodes_[at].left == 0) {
            cut_part(at, segment);
        } else {
            open.push_back(nodes_[at].right);
            open.push_back(nodes_[at].left);
        }
    }
}

void DividedPolygon::cut_part(std::uint32_t part, const Segment& segment) {
    if (!within(nodes_[part].corners, normal_, segment, slack_)) {
        return;
    }
    auto [left, right] = split(nodes_[part].corners, normal_, segment, slack_);
    if (left.size() > 2 && right.size() > 2 && is_wide(left, slack_) && is_wide(right, slack_)) {
        nodes_[part].corners.clear();
        nodes_[part].left = static_cast<std::uint32_t>(nodes_.size());
        nodes_[part].right = nodes_[part].left + 1;
        add(std::move(left));
        add(std::move(right));
    }
}

std::vector<Polygon> DividedPolygon::parts() const {
    std::vector<Polygon> result;
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
        const Node& node = nodes_[open.back()];
        open.pop_back();
        if (node.left == 0) {
            result.push_back(node.corners);
        } else {
            open.push_back(node.right);
            open.push_back(node.left);
        }
    }
    return result;
}

Polygon without_straight_corners(const Polygon& polygon, double slack) {
    Polygon result = polygon;
    for (std::size_t k = 0; k < result.size() && result.size() > 3;) {
        const Vec3& before = result[(k + result.size() - 1) % result.size()];
        const Vec3& after = result[(k + 1) % result.size()];
        const Vec3 line = after - before;
        const double length = glm::length(line);
        const double off = length > 0.0 ? glm::length(glm::cross(line, result[k] - before)) / length : 0.0;
        if (off <= slack) {
            result.erase(result.begin() + static_cast<std::ptrdiff_t>(k));
        } else {
            ++k;
        }
    }
    return result;
}

bool is_wide(std::span<const Vec3> polygon, double slack) {
    return glm::length(area_vector(polygon)) > 0.5 * slack * perimeter(polygon);
}

} // namespace hemi
