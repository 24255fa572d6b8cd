#pragma once

#include "hemi/core/geometry.hpp"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace hemi {

/// Gives points that are closer than a tolerance one index, and so one position with equal bits.
class Welder {
public:
    explicit Welder(double tolerance) : tolerance_(tolerance), cell_(4.0 * tolerance) {}

    /// Index of a point that was added within the tolerance of `point`, or a new one.
    std::uint32_t add(const Vec3& point);

    [[nodiscard]] const std::vector<Vec3>& points() const noexcept { return points_; }

private:
    struct Key {
        std::int64_t x, y, z;
        bool operator==(const Key&) const = default;
    };
    struct KeyHash {
        std::size_t operator()(const Key& key) const noexcept;
    };

    double tolerance_;
    double cell_;
    std::vector<Vec3> points_;
    std::vector<std::uint32_t> next_; ///< chain of points in one cell
    std::unordered_map<Key, std::uint32_t, KeyHash> cells_;
};

} // namespace hemi
