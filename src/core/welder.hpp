#pragma once

#include "hemi/core/geometry.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hemi {

/// Gives points that are closer than a tolerance one index, and so one position with equal bits.
class Welder {
public:
    explicit Welder(double tolerance) : tolerance_(tolerance), cell_(16.0 * tolerance) {}

    /// Index of a point that was added within the tolerance of `point`, or a new one.
    std::uint32_t add(const Vec3& point);

    [[nodiscard]] const std::vector<Vec3>& points() const noexcept { return points_; }

private:
    struct Key {
        std::int64_t x, y, z;
    };

    /// Chain of the points in a cell, and in others of the same hash.
    [[nodiscard]] std::size_t chain(const Key& key) const noexcept;
    [[nodiscard]] Key cell_of(const Vec3& point) const noexcept;
    void link(std::uint32_t index);
    void make_more_chains();

    double tolerance_;
    double cell_;
    std::vector<Vec3> points_;
    std::vector<std::uint32_t> next_;  ///< in the chain, of every point
    std::vector<std::uint32_t> heads_; ///< of the chains; a power of two of them, two a point at least
};

} // namespace hemi
