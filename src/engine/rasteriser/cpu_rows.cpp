#include "engine/rasteriser/cpu_rows.hpp"

#include "engine/hemicube/row_accumulator.hpp"
#include "engine/hemicube/visibility_accumulator.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

namespace hemi {

struct CpuRows::State {
    State(const EngineGeometry& the_geometry, const RasterScene& scene, const HemicubeSettings& the_settings,
          RowQuantity quantity, const SideSets* the_sets)
        : geometry(the_geometry), settings(the_settings), sets(the_sets),
          delta(the_settings.resolution, the_geometry.measure), tiles(the_settings.resolution),
          rasteriser(make_rasteriser(scene, tiles)) {
        if (quantity == RowQuantity::visibility) {
            visibility.emplace(geometry.list, geometry.patches);
            coverage.emplace(geometry.list.item_of_id.size());
        } else {
            accumulator.emplace(geometry.list.item_of_id, geometry.patches);
        }
    }

    [[nodiscard]] EyeFrame frame(std::uint32_t patch, std::uint32_t eye) const {
        return {geometry.eyes.of(patch)[eye].normal, patch, eye, settings.seed};
    }

    /// Weights for an eye point that stands for `share` of its patch; a rule has few different shares, but
    /// for their last bits, which DeltaFormFactors does not see.
    const TileWeights& weights_for(double share) {
        const auto key = static_cast<std::uint64_t>(share * 0x1p32);
        const auto found =
            std::find_if(kept.begin(), kept.end(), [key](const auto& entry) { return entry.first == key; });
        if (found != kept.end()) {
            return found->second;
        }
        constexpr std::size_t most_bytes = std::size_t{8} << 20; // a thread
        constexpr std::size_t bytes_a_texel = sizeof(std::uint32_t) + sizeof(TexelTally);
        if (kept.size() >= std::clamp<std::size_t>(most_bytes / (tiles.size() * bytes_a_texel), 2, 64)) {
            kept.pop_front();
        }
        return kept.emplace_back(key, TileWeights(tiles, share >= 1.0 ? delta : delta.scaled(share))).second;
    }

    const EngineGeometry& geometry;
    HemicubeSettings settings;
    const SideSets* sets;
    DeltaFormFactors delta;
    TexelTiles tiles;
    std::unique_ptr<Rasteriser> rasteriser;
    std::deque<std::pair<std::uint64_t, TileWeights>> kept;
    std::optional<RowAccumulator> accumulator;       ///< of form factors
    std::optional<VisibilityAccumulator> visibility; ///< or of visibility
    std::optional<Coverage> coverage;                ///< with it
};

CpuRows::CpuRows(const EngineGeometry& geometry, const RasterScene& scene, const HemicubeSettings& settings,
                 RowQuantity quantity, const SideSets* sets)
    : state_(std::make_unique<State>(geometry, scene, settings, quantity, sets)) {}

CpuRows::~CpuRows() = default;

RawRow CpuRows::row(std::uint32_t patch) {
    State& state = *state_;
    const auto eyes = state.geometry.eyes.of(patch);
    // What one eye does not see, another may.
    const SideSets* const sets = eyes.size() == 1 ? state.sets : nullptr;
    if (state.coverage) {
        state.coverage->skip_hidden = sets != nullptr;
    }
    for (std::uint32_t eye = 0; eye < eyes.size(); ++eye) {
        const TileWeights& weights = state.weights_for(eyes[eye].share);
        const EyeFrame frame = state.frame(patch, eye);
        if (state.visibility) {
            state.rasteriser->draw(eyes[eye], frame, &weights, &*state.coverage);
            state.visibility->add_tiles(state.rasteriser->ids(), weights);
        } else {
            state.rasteriser->draw(eyes[eye], frame, nullptr, nullptr);
            state.accumulator->add_tiles(state.rasteriser->ids(), weights);
        }
    }
    if (state.visibility) {
        return raw_row(state.visibility->take(*state.coverage, sets));
    }
    return state.accumulator->take();
}

std::vector<std::uint32_t> CpuRows::items(std::uint32_t patch, std::uint32_t eye) {
    State& state = *state_;
    state.rasteriser->draw(state.geometry.eyes.of(patch)[eye], state.frame(patch, eye), nullptr, nullptr);
    const std::span<const std::uint32_t> ids = state.rasteriser->ids();
    std::vector<std::uint32_t> items;
    for (int face = 0; face < hemicube_faces; ++face) {
        for (std::uint32_t y = 0; y < state.tiles.height(face); ++y) {
            for (std::uint32_t x = 0; x < state.tiles.resolution(); ++x) {
                items.push_back(state.geometry.list.item_of_id[ids[state.tiles.at(face, x, y)]]);
            }
        }
    }
    return items;
}

} // namespace hemi
