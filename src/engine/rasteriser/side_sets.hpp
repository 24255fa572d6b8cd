#pragma once

#include "engine/rasteriser/raster_scene.hpp"
#include "hemi/engine/visibility_provider.hpp"

#include <cstdint>

namespace hemi {

/// The sets of patches of which the CPU rasteriser may tell as a whole: the sides of all drawn polygons, two
/// a polygon, and after them the parts of its scene, both sides of all their polygons.
class SideSets {
public:
    explicit SideSets(const RasterScene& scene);

    [[nodiscard]] const PatchSets& sets() const noexcept { return sets_; }
    /// The set of a side of a polygon.
    [[nodiscard]] static std::uint32_t of_side(std::uint32_t polygon, bool back) {
        return 2 * polygon + (back ? 1 : 0);
    }
    /// The set of a part of the scene.
    [[nodiscard]] std::uint32_t of_part(std::uint32_t part) const { return sides_ + part; }
    /// Whether a set has patches.
    [[nodiscard]] bool any(std::uint32_t side) const { return !sets_.patches_of(side).empty(); }

private:
    std::uint32_t sides_;
    PatchSets sets_;
};

} // namespace hemi
