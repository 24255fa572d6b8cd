#pragma once

#include "engine/hemicube/view_builder.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"

#include <cstdint>
#include <memory>
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
    /// @param slots  hemicubes a batch; reduced to what the driver's largest texture holds.
    ItemBuffers(const gl::Context& context, std::uint32_t resolution, std::uint32_t slots);

    [[nodiscard]] std::uint32_t slots() const noexcept { return slots_; }
    /// Batches that can be under way at once (1 on the CPU).
    [[nodiscard]] std::uint32_t depth() const noexcept { return static_cast<std::uint32_t>(targets_.size()); }

    /// Starts drawing `used` hemicubes. At most depth() batches may be under way.
    void begin(const DrawStream& stream, std::uint32_t used);
    /// Waits for the oldest batch. Its ids: 3·resolution² for each hemicube, valid until the next begin() or
    /// finish().
    [[nodiscard]] const std::uint32_t* finish();
    /// Forgets the batches under way.
    void discard() noexcept;
    /// Nothing bound, as in OpenGL's default state, for others that draw with the context. Ids of finish()
    /// are gone afterwards.
    void restore_defaults() noexcept;

private:
    struct Target {
        gl::Texture2D ids;
        gl::Texture2D depth;
        gl::Framebuffer framebuffer;
        gl::Buffer pixels; ///< read-back, on a GPU
        gl::Buffer vertices;
        GLsync fence = nullptr;
        std::uint32_t used = 0;
    };
    void unmap() noexcept;
    void prepare_target(Target& target, std::uint32_t index) const;

    std::uint32_t resolution_;
    std::uint32_t slots_;
    bool software_;
    float grain_ = 0.0f; ///< of the rasteriser's vertices, texels
    gl::Program affine_;
    gl::Program bilinear_;
    gl::VertexArray layout_;
    std::vector<Target> targets_;
    std::size_t oldest_ = 0;
    std::size_t under_way_ = 0;
    std::vector<std::uint32_t> ids_; ///< read-back, in software
    const std::uint32_t* mapped_ = nullptr;
    std::size_t mapped_target_ = 0;
};

} // namespace hemi
