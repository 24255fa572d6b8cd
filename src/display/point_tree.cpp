#include "display/point_tree.hpp"

#include <algorithm>
#include <numeric>

namespace hemi {

namespace {

constexpr std::size_t leaf_size = 8;

} // namespace

struct PointTree::Query {
    Vec3 start;
    Vec3 along;
    double length_squared;
    double tolerance;
    std::vector<std::uint32_t>& found;
};

PointTree::PointTree(std::span<const Vec3> points)
    : points_(points), order_(points.size()), axes_(points.size(), 0) {
    std::iota(order_.begin(), order_.end(), 0U);
    build(0, order_.size());
}

void PointTree::build(std::size_t first, std::size_t last) {
    if (last - first <= leaf_size) {
        return;
    }
    Bounds bounds;
    for (std::size_t i = first; i < last; ++i) {
        bounds.add(points_[order_[i]]);
    }
    const Vec3 size = bounds.upper - bounds.lower;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const std::size_t middle = first + (last - first) / 2;
    const auto at = [this](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(first), at(middle), at(last), [&](std::uint32_t a, std::uint32_t b) {
        const double x = points_[a][axis];
        const double y = points_[b][axis];
        return x < y || (x == y && a < b);
    });
    axes_[middle] = static_cast<std::uint8_t>(axis);
    build(first, middle);
    build(middle + 1, last);
}

void PointTree::near_segment(const Vec3& a, const Vec3& b, double tolerance,
                             std::vector<std::uint32_t>& found) const {
    const Vec3 along = b - a;
    const Query query{a, along, glm::dot(along, along), tolerance, found};
    visit(query, 0, order_.size(), 0.0, 1.0);
}

void PointTree::visit(const Query& query, std::size_t first, std::size_t last, double from, double to) const {
    const auto test = [&](std::uint32_t point) {
        const Vec3 offset = points_[point] - query.start;
        const double place =
            query.length_squared > 0.0 ? glm::dot(offset, query.along) / query.length_squared : 0.0;
        const Vec3 gap = offset - std::clamp(place, 0.0, 1.0) * query.along;
        if (glm::dot(gap, gap) <= query.tolerance * query.tolerance) {
            query.found.push_back(point);
        }
    };
    if (last - first <= leaf_size) {
        for (std::size_t i = first; i < last; ++i) {
            test(order_[i]);
        }
        return;
    }
    const std::size_t middle = first + (last - first) / 2;
    const int axis = axes_[middle];
    const double split = points_[order_[middle]][axis] - query.start[axis];
    const double slope = query.along[axis];
    // The part of the segment on each side of the split, with the tolerance added to both.
    const auto side = [&](double sign, std::size_t begin, std::size_t end) {
        const double limit = sign * split + query.tolerance;
        const double rise = sign * slope;
        double a = from;
        double b = to;
        if (rise > 0.0) {
            b = std::min(b, limit / rise);
        } else if (rise < 0.0) {
            a = std::max(a, limit / rise);
        } else if (limit < 0.0) {
            return;
        }
        if (a <= b) {
            visit(query, begin, end, a, b);
        }
    };
    side(1.0, first, middle);
    if (std::abs(from * slope - split) <= query.tolerance ||
        std::abs(to * slope - split) <= query.tolerance ||
        (from * slope - split) * (to * slope - split) <= 0.0) {
        test(order_[middle]);
    }
    side(-1.0, middle + 1, last);
}

} // namespace hemi
