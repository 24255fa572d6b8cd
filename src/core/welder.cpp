#include "core/welder.hpp"

#include <algorithm>

namespace hemi {

namespace {
constexpr std::uint32_t none = 0xFFFFFFFFu;
}

std::size_t Welder::chain(const Key& key) const noexcept {
    std::uint64_t hash = 0x9E3779B97F4A7C15u;
    for (const std::int64_t value : {key.x, key.y, key.z}) {
        hash = (hash ^ static_cast<std::uint64_t>(value)) * 0xBF58476D1CE4E5B9u;
        hash ^= hash >> 29;
    }
    return hash & (heads_.size() - 1);
}

Welder::Key Welder::cell_of(const Vec3& point) const noexcept {
    const Vec3 cell = glm::floor(point / cell_);
    return {static_cast<std::int64_t>(cell.x), static_cast<std::int64_t>(cell.y),
            static_cast<std::int64_t>(cell.z)};
}

void Welder::link(std::uint32_t index) {
    std::uint32_t& head = heads_[chain(cell_of(points_[index]))];
    next_[index] = head;
    head = index;
}

void Welder::make_more_chains() {
    heads_.assign(std::max<std::size_t>(64, 2 * heads_.size()), none);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
        link(i);
    }
}

std::uint32_t Welder::add(const Vec3& point) {
    if (2 * (points_.size() + 1) > heads_.size()) {
        make_more_chains();
    }
    // Cells are many tolerances wide: only a point near a cell's face needs a look next door.
    const Key low = cell_of(point - Vec3(tolerance_));
    const Key high = cell_of(point + Vec3(tolerance_));
    for (std::int64_t x = low.x; x <= high.x; ++x) {
        for (std::int64_t y = low.y; y <= high.y; ++y) {
            for (std::int64_t z = low.z; z <= high.z; ++z) {
                for (std::uint32_t i = heads_[chain({x, y, z})]; i != none; i = next_[i]) {
                    const Vec3 gap = points_[i] - point;
                    if (glm::dot(gap, gap) <= tolerance_ * tolerance_) {
                        return i;
                    }
                }
            }
        }
    }
    const auto index = static_cast<std::uint32_t>(points_.size());
    points_.push_back(point);
    next_.push_back(none);
    link(index);
    return index;
}

} // namespace hemi
