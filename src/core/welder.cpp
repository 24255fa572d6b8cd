#include "core/welder.hpp"

#include <cmath>

namespace hemi {

namespace {
constexpr std::uint32_t none = 0xFFFFFFFFu;
}

std::size_t Welder::KeyHash::operator()(const Key& key) const noexcept {
    std::uint64_t hash = 0x9E3779B97F4A7C15u;
    for (const std::int64_t value : {key.x, key.y, key.z}) {
        hash = (hash ^ static_cast<std::uint64_t>(value)) * 0xBF58476D1CE4E5B9u;
        hash ^= hash >> 29;
    }
    return hash;
}

std::uint32_t Welder::add(const Vec3& point) {
    const Vec3 scaled = point / cell_;
    // Cells are four tolerances wide: only a point near a cell's face needs a look next door.
    const auto low = [](double value) { return static_cast<std::int64_t>(std::floor(value - 0.25)); };
    const auto high = [](double value) { return static_cast<std::int64_t>(std::floor(value + 0.25)); };
    for (std::int64_t x = low(scaled.x); x <= high(scaled.x); ++x) {
        for (std::int64_t y = low(scaled.y); y <= high(scaled.y); ++y) {
            for (std::int64_t z = low(scaled.z); z <= high(scaled.z); ++z) {
                const auto found = cells_.find({x, y, z});
                if (found == cells_.end()) {
                    continue;
                }
                for (std::uint32_t i = found->second; i != none; i = next_[i]) {
                    const Vec3 gap = points_[i] - point;
                    if (glm::dot(gap, gap) <= tolerance_ * tolerance_) {
                        return i;
                    }
                }
            }
        }
    }
    const auto index = static_cast<std::uint32_t>(points_.size());
    const auto floor_of = [](double value) { return static_cast<std::int64_t>(std::floor(value)); };
    const auto [place, fresh] =
        cells_.try_emplace(Key{floor_of(scaled.x), floor_of(scaled.y), floor_of(scaled.z)}, index);
    points_.push_back(point);
    next_.push_back(fresh ? none : place->second);
    place->second = index;
    return index;
}

} // namespace hemi
