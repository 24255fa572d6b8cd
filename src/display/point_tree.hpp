#pragma once

#include "hemi/core/geometry.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Balanced k-d tree over points, for finding those on a line segment. It adapts to any mix of scales, where
/// a grid's cell would have to suit both the longest edge and the finest mesh.
class PointTree {
public:
    /// @param points  must outlive the tree. Memory: 5 bytes a point.
    explicit PointTree(std::span<const Vec3> points);

    /// Appends to `found` the indices of the points within `tolerance` of the segment a-b, in tree order.
    void near_segment(const Vec3& a, const Vec3& b, double tolerance,
                      std::vector<std::uint32_t>& found) const;

private:
    struct Query;
    void build(std::size_t first, std::size_t last);
    void visit(const Query& query, std::size_t first, std::size_t last, double from, double to) const;

    std::span<const Vec3> points_;
    std::vector<std::uint32_t> order_; ///< the middle of every range splits it
    std::vector<std::uint8_t> axes_;   ///< axis by which the point at the same place of order_ splits
};

} // namespace hemi
