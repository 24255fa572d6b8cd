#include "engine/rasteriser/texel_tiles.hpp"

namespace hemi {

TileWeights::TileWeights(const TexelTiles& tiles, const DeltaFormFactors& weights)
    : weight(tiles.size(), 0), tile_weight(tiles.size() / TexelTiles::tile_size, 0), texel(tiles.size(), 0),
      tile(tiles.size() / TexelTiles::tile_size, 0), sum(weights.sum()) {
    std::uint32_t row = 0;
    for (int face = 0; face < hemicube_faces; ++face) {
        for (std::uint32_t y = 0; y < tiles.height(face); ++y, ++row) {
            for (std::uint32_t x = 0; x < tiles.resolution(); ++x) {
                const std::uint32_t at = tiles.at(face, x, y);
                const std::size_t in_tile = at / TexelTiles::tile_size;
                weight[at] = weights.weight(row, x);
                tile_weight[in_tile] += weight[at];
                texel[at] = TexelTally{weight[at]} << 32 | 1u;
                tile[in_tile] += texel[at];
            }
        }
    }
}

} // namespace hemi
