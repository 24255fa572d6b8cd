#include "engine/rasteriser/side_sets.hpp"

#include <algorithm>
#include <vector>

namespace hemi {

namespace {

/// Patches that one side of a polygon shows, ascending, each once.
std::vector<std::uint32_t> patches_of_side(const DrawList& list, const DrawPolygon& polygon, bool back) {
    const std::uint32_t first = back ? polygon.back_id : polygon.front_id;
    std::vector<std::uint32_t> patches;
    if (first == item_blocked) {
        return patches;
    }
    const std::uint32_t count = polygon.grid.u * polygon.grid.v << polygon.split;
    for (std::uint32_t id = first; id < first + count; ++id) {
        if (list.item_of_id[id] >= item_first_patch) {
            patches.push_back(list.item_of_id[id] - item_first_patch);
        }
    }
    std::sort(patches.begin(), patches.end());
    patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
    return patches;
}

} // namespace

SideSets::SideSets(const RasterScene& scene)
    : sides_(2 * static_cast<std::uint32_t>(scene.list.polygons.size())) {
    const auto end_set = [this] {
        sets_.first.push_back(static_cast<std::uint32_t>(sets_.patches.size()));
        sets_.first_members.push_back(static_cast<std::uint32_t>(sets_.members.size()));
    };
    end_set();
    for (const DrawPolygon& polygon : scene.list.polygons) {
        for (const bool back : {false, true}) {
            const std::vector<std::uint32_t> patches = patches_of_side(scene.list, polygon, back);
            sets_.patches.insert(sets_.patches.end(), patches.begin(), patches.end());
            end_set();
        }
    }
    for (std::uint32_t part = 0; part < scene.parts(); ++part) {
        for (const std::uint32_t polygon : scene.polygons_of(part)) {
            for (const bool back : {false, true}) {
                if (any(of_side(polygon, back))) {
                    sets_.members.push_back(of_side(polygon, back));
                }
            }
        }
        end_set();
    }
}

} // namespace hemi
