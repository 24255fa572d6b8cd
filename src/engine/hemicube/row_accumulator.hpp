#pragma once

#include "engine/hemicube/draw_list.hpp"
#include "engine/rasteriser/texel_tiles.hpp"
#include "hemi/engine/delta_form_factors.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Sums the delta form factors of item buffers by patch and makes a row of F of them. Integer sums: the
/// order does not matter. Memory: 12 bytes a patch.
class RowAccumulator {
public:
    /// @param item_of_id  draw id -> item; must outlive this.
    RowAccumulator(std::span<const std::uint32_t> item_of_id, std::uint32_t patches);

    /// Adds one hemicube: 3·resolution rows of `resolution` draw ids. The weights of all hemicubes of a row
    /// must not sum to more than DeltaFormFactors::total.
    void add(const std::uint32_t* ids, const DeltaFormFactors& weights);

    /// The same of draw ids in the order of TexelTiles.
    void add_tiles(std::span<const std::uint32_t> ids, const TileWeights& weights);

    /// The row so far, and starts the next one. The view is valid until the next call.
    /// Values are rounded to float32 so that their sum with e and b is 1 to about 1e-9.
    [[nodiscard]] RowView take();

private:
    template <bool identity>
    void add_rows(const std::uint32_t* ids, const DeltaFormFactors& weights);
    template <bool identity>
    void add_all_tiles(std::span<const std::uint32_t> ids, const TileWeights& weights);

    std::span<const std::uint32_t> item_of_id_;
    bool identity_;                     ///< draw ids are items: no look-up is needed
    std::vector<std::uint32_t> sums_;   ///< per item; padded to whole groups of 512
    std::vector<std::uint8_t> touched_; ///< per 64 items: whether anything was added to them
    std::uint32_t total_ = 0;           ///< of the weights so far
    std::vector<std::uint32_t> columns_;
    std::vector<float> values_;
};

} // namespace hemi
