#pragma once

#include "hemi/core/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

namespace hemi {

/// Finds boxes that overlap a box or lie along a ray: a binary tree over boxes split at the median of their
/// centres. Memory: about 60 bytes a box.
class BoxTree {
public:
    explicit BoxTree(std::span<const Bounds> boxes)
        : boxes_(boxes.begin(), boxes.end()), order_(boxes.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
        if (!boxes_.empty()) {
            split(0, static_cast<std::uint32_t>(boxes_.size()));
        }
    }

    /// Calls `visit(index)` for every box that overlaps `bounds`, in no particular order.
    template <typename Visit>
    void overlapping(const Bounds& bounds, const Visit& visit) const {
        std::uint32_t at = 0;
        while (at < nodes_.size()) { // depth first; a node that is missed is skipped with all below it
            const Node& node = nodes_[at];
            if (!overlap(node.bounds, bounds)) {
                at = node.after;
                continue;
            }
            for (std::uint32_t k = node.first; k < node.end; ++k) {
                if (overlap(boxes_[order_[k]], bounds)) {
                    visit(order_[k]);
                }
            }
            ++at;
        }
    }

    /// Calls `visit(index)` for every box that a ray passes through, in no particular order.
    /// @param direction  of any length but 0
    template <typename Visit>
    void along(const Vec3& origin, const Vec3& direction, const Visit& visit) const {
        std::uint32_t at = 0;
        while (at < nodes_.size()) {
            const Node& node = nodes_[at];
            if (!passes(node.bounds, origin, direction)) {
                at = node.after;
                continue;
            }
            for (std::uint32_t k = node.first; k < node.end; ++k) {
                if (passes(boxes_[order_[k]], origin, direction)) {
                    visit(order_[k]);
                }
            }
            ++at;
        }
    }

private:
    struct Node {
        Bounds bounds;
        std::uint32_t first = 0, end = 0; ///< boxes of a leaf
        std::uint32_t after = 0;          ///< the node that follows all below this one
    };

    static bool passes(const Bounds& box, const Vec3& origin, const Vec3& direction) {
        double from = 0.0;
        double to = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            if (direction[axis] == 0.0) {
                if (origin[axis] < box.lower[axis] || origin[axis] > box.upper[axis]) {
                    return false;
                }
                continue;
            }
            const double a = (box.lower[axis] - origin[axis]) / direction[axis];
            const double b = (box.upper[axis] - origin[axis]) / direction[axis];
            from = std::max(from, std::min(a, b));
            to = std::min(to, std::max(a, b));
        }
        constexpr double rounding = 1e-12; // a flat box has no inside
        return from <= to + rounding * std::abs(to);
    }

    void split(std::uint32_t first, std::uint32_t end) {
        constexpr std::uint32_t leaf = 4;
        const auto node = static_cast<std::uint32_t>(nodes_.size());
        nodes_.emplace_back();
        Bounds centres;
        for (std::uint32_t k = first; k < end; ++k) {
            const Bounds& box = boxes_[order_[k]];
            nodes_[node].bounds.add(box.lower);
            nodes_[node].bounds.add(box.upper);
            centres.add(box.centre());
        }
        if (end - first <= leaf) {
            nodes_[node].first = first;
            nodes_[node].end = end;
        } else {
            const Vec3 extent = centres.upper - centres.lower;
            const int axis =
                extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
            const std::uint32_t middle = first + (end - first) / 2;
            std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + end,
                             [&](std::uint32_t a, std::uint32_t b) {
                                 return boxes_[a].centre()[axis] < boxes_[b].centre()[axis];
                             });
            split(first, middle);
            split(middle, end);
        }
        nodes_[node].after = static_cast<std::uint32_t>(nodes_.size());
    }

    std::vector<Bounds> boxes_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_; ///< in depth-first order
};

} // namespace hemi
