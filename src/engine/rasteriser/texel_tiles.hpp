#pragma once

#include "engine/hemicube/eye.hpp"
#include "hemi/engine/delta_form_factors.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Where the CPU rasteriser keeps the texels of a hemicube: in tiles of 4 x 4, one cache line each, row by
/// row, face after face. Tiles at the upper and right edge of a face may have padding: texels that are drawn
/// like others, and weigh nothing.
class TexelTiles {
public:
    static constexpr std::uint32_t tile_size = 16; ///< texels

    explicit TexelTiles(std::uint32_t resolution) : resolution_(resolution), across_((resolution + 3) / 4) {
        std::uint32_t first = 0;
        for (int face = 0; face < hemicube_faces; ++face) {
            first_[static_cast<std::size_t>(face)] = first;
            first += across_ * ((height(face) + 3) / 4) * tile_size;
        }
        size_ = first;
    }

    [[nodiscard]] std::uint32_t resolution() const noexcept { return resolution_; }
    /// Tiles in a row of a face.
    [[nodiscard]] std::uint32_t across() const noexcept { return across_; }
    /// Rows of texels of a face.
    [[nodiscard]] std::uint32_t height(int face) const noexcept {
        return face == 0 ? resolution_ : resolution_ / 2;
    }
    /// First texel of a face.
    [[nodiscard]] std::uint32_t first(int face) const noexcept {
        return first_[static_cast<std::size_t>(face)];
    }
    /// Texels of all faces, padding included; a multiple of tile_size.
    [[nodiscard]] std::uint32_t size() const noexcept { return size_; }
    /// Position of texel (x, y) of a face.
    [[nodiscard]] std::uint32_t at(int face, std::uint32_t x, std::uint32_t y) const noexcept {
        return first(face) + (((y >> 2) * across_ + (x >> 2)) << 4) + ((y & 3) << 2) + (x & 3);
    }

private:
    std::uint32_t resolution_;
    std::uint32_t across_;
    std::uint32_t size_ = 0;
    std::array<std::uint32_t, hemicube_faces> first_{};
};

/// A weight in the upper and a number of texels in the lower half: both are summed at once.
using TexelTally = std::uint64_t;

/// Delta form factors in the order of TexelTiles, and their sums by tile. Padding weighs 0.
struct TileWeights {
    TileWeights(const TexelTiles& tiles, const DeltaFormFactors& weights);

    std::vector<std::uint32_t> weight;      ///< tiles.size()
    std::vector<std::uint32_t> tile_weight; ///< tiles.size() / 16
    std::vector<TexelTally> texel;          ///< weight and number 1 of every texel; both 0 for padding
    std::vector<TexelTally> tile;           ///< the same by tile
    std::uint32_t sum;                      ///< of all weights
};

/// Calls `add(id, sum)` until every texel is summed under its draw id: once for a tile of one id, else texel
/// by texel.
/// @param ids    in the order of TexelTiles
/// @param texel  what a texel counts, and `tile` the same by tile
template <class Sum, class Add>
void sum_by_id(std::span<const std::uint32_t> ids, std::span<const Sum> texel, std::span<const Sum> tile,
               const Add& add) {
    for (std::size_t first = 0; first < ids.size(); first += TexelTiles::tile_size) {
        const std::uint32_t* const id = ids.data() + first;
        std::uint32_t differing = 0;
        for (std::size_t k = 1; k < TexelTiles::tile_size; ++k) {
            differing |= id[k] ^ id[0];
        }
        if (differing == 0) {
            add(id[0], tile[first / TexelTiles::tile_size]);
            continue;
        }
        const Sum* const sums = texel.data() + first;
        for (std::size_t k = 0; k < TexelTiles::tile_size; ++k) {
            add(id[k], sums[k]);
        }
    }
}

} // namespace hemi
