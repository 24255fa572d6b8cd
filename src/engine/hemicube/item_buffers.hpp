#pragma once

#include "engine/hemicube/hemicube_drawer.hpp"
#include "engine/rasteriser/texel_tiles.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "hemi/engine/delta_form_factors.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// Draws batches of hemicubes into an atlas of draw ids (see draw_list.hpp) and reads them back.
///
/// The atlas is one column, `resolution` wide: every hemicube is a contiguous block of 3·resolution rows (top
/// face, then four sides of resolution / 2 rows). Ids are 32-bit integers, depth is reversed and infinite in
/// 32-bit float. Needs its context current on the calling thread, in OpenGL's default state but for what it
/// binds.
class ItemBuffers {
public:
    /// @param slots        hemicubes a batch; reduced to what the driver's largest texture holds.
    /// @param covered_ids  draw ids, where what covers texels is counted too, hidden or not; else 0.
    ItemBuffers(const gl::Context& context, std::uint32_t resolution, std::uint32_t slots,
                std::size_t covered_ids);

    [[nodiscard]] const Atlas& atlas() const noexcept { return atlas_; }
    /// Rows of tallies that a batch has; 0 where nothing is counted.
    [[nodiscard]] std::uint32_t rows() const noexcept { return rows_; }
    /// Batches that can be under way at once (1 on the CPU).
    [[nodiscard]] std::uint32_t depth() const noexcept { return static_cast<std::uint32_t>(targets_.size()); }
    /// The table of weights for hemicubes of the batch that begins next, uploaded if it is not there; none
    /// where all tables hold other weights of this batch.
    /// @param key  stands for the weights
    [[nodiscard]] std::optional<std::uint32_t> table(std::uint64_t key, const DeltaFormFactors& weights);

    /// What the texels of a hemicube count for.
    struct Counting {
        std::uint32_t table; ///< of weights
        std::uint32_t row;   ///< of tallies
    };
    /// Starts drawing `used` hemicubes. At most depth() batches may be under way.
    /// @param counting  of each, where texels are counted
    void begin(HemicubeDrawer& drawer, std::uint32_t used, std::span<const Counting> counting);

    struct Batch {
        const std::uint32_t* ids;  ///< 3·resolution² for each hemicube
        const TexelTally* tallies; ///< for each row, one for each draw id; null where nothing is counted
    };
    /// Waits for the oldest batch. Valid until the next begin() or finish().
    [[nodiscard]] Batch finish();
    /// Forgets the batches under way.
    void discard() noexcept;
    /// Nothing bound, as in OpenGL's default state, for others that draw with the context. What finish() gave
    /// is gone afterwards.
    void restore_defaults() noexcept;

private:
    struct Target {
        gl::Texture2D ids;
        gl::Texture2D depth;
        gl::Framebuffer framebuffer;
        gl::Buffer tallies;
        gl::Buffer ids_read; ///< read-back, on a GPU
        gl::Buffer tallies_read;
        GLsync fence = nullptr;
        std::uint32_t used = 0;
        std::uint32_t rows = 0;
    };
    struct Table {
        std::uint64_t key;
        bool used; ///< by the batch that begins next
    };
    void unmap() noexcept;
    void prepare_target(Target& target, std::uint32_t index) const;
    void prepare_tables();
    [[nodiscard]] GLsizeiptr tally_bytes(const Target& target) const;
    void bind_counting(const Target& target, std::span<const Counting> counting);
    [[nodiscard]] std::size_t texels() const {
        return std::size_t{3} * atlas_.resolution * atlas_.resolution;
    }

    Atlas atlas_;
    std::size_t covered_ids_;
    std::uint32_t rows_ = 0;
    bool software_;
    std::vector<Target> targets_;
    std::size_t oldest_ = 0;
    std::size_t under_way_ = 0;
    gl::Buffer counting_block_;
    gl::Buffer weights_;
    std::vector<Table> tables_;
    std::size_t most_tables_ = 0;
    std::size_t next_table_ = 0;
    std::vector<std::uint32_t> scratch_;
    std::vector<std::uint32_t> ids_; ///< read-back, in software
    std::vector<TexelTally> tallies_;
    const Target* mapped_ = nullptr;
};

} // namespace hemi
