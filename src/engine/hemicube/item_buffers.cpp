#include "engine/hemicube/item_buffers.hpp"

#include "engine/hemicube/draw_list.hpp"
#include "gl/reversed_depth.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace hemi {

namespace {

// Bindings in hemicube.frag.
constexpr GLuint counting_block = 1;
constexpr GLuint weights_block = 2;
constexpr GLuint covered_block = 3;
constexpr std::uint32_t most_slots = 64; ///< of its block Counting

/// Block Counting of hemicube.frag.
struct CountingBlock {
    std::uint32_t width = 0;
    std::uint32_t draw_ids = 0;
    std::array<std::uint32_t, 2> unused{};
    std::array<std::array<std::uint32_t, 4>, most_slots> hemicubes{};
};

GLint integer(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
}

} // namespace

ItemBuffers::ItemBuffers(const gl::Context& context, std::uint32_t resolution, std::uint32_t slots,
                         std::size_t covered_ids)
    : atlas_{resolution, slots, std::ldexp(1.0f, -integer(GL_SUBPIXEL_BITS))}, covered_ids_(covered_ids),
      software_(context.software()) {
    std::array<GLint, 2> largest_viewport{};
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, largest_viewport.data());
    const auto rows = static_cast<std::uint32_t>(std::min(integer(GL_MAX_TEXTURE_SIZE), largest_viewport[1]));
    if (3 * resolution > rows) {
        throw GlError(fmt::format("resolution {} needs a texture of {} rows; this device allows {}",
                                  resolution, 3 * resolution, rows));
    }
    atlas_.slots = std::clamp(slots, 1u, std::min(most_slots, rows / (3 * resolution)));
    if (covered_ids_ > 0) {
        prepare_tables();
    }
    // A GPU draws ahead while the CPU sums; large ones take much memory.
    targets_.resize(software_ ? 1 : (resolution > 1024 ? 2 : 3));
    for (std::uint32_t i = 0; i < targets_.size(); ++i) {
        prepare_target(targets_[i], i);
    }
    if (software_) {
        ids_.resize(texels() * atlas_.slots);
        tallies_.resize(covered_ids_ * rows_);
    }
    gl::check_errors("item buffers");
}

void ItemBuffers::prepare_tables() {
    constexpr std::size_t most_bytes = std::size_t{64} << 20; // of a buffer
    GLint64 largest_block = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &largest_block);
    const std::size_t row_bytes = covered_ids_ * sizeof(TexelTally);
    const std::size_t table_bytes = texels() * sizeof(std::uint32_t);
    if (static_cast<GLint64>(std::max(row_bytes, table_bytes)) > largest_block) {
        throw GlError(fmt::format("{} patches at resolution {}: more than this device can count in",
                                  covered_ids_, atlas_.resolution));
    }
    rows_ = static_cast<std::uint32_t>(std::clamp<std::size_t>(most_bytes / row_bytes, 1, atlas_.slots));
    most_tables_ = std::clamp<std::size_t>(most_bytes / table_bytes, 1, 32);
    glNamedBufferStorage(weights_.get(), static_cast<GLsizeiptr>(most_tables_ * table_bytes), nullptr,
                         GL_DYNAMIC_STORAGE_BIT);
    gl::label(GL_BUFFER, weights_.get(), "weights of texels");
}

void ItemBuffers::prepare_target(Target& target, std::uint32_t index) const {
    const auto width = static_cast<GLsizei>(atlas_.resolution);
    const auto height = static_cast<GLsizei>(3 * atlas_.resolution * atlas_.slots);
    glTextureStorage2D(target.ids.get(), 1, GL_R32UI, width, height);
    glTextureParameteri(target.ids.get(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(target.ids.get(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTextureStorage2D(target.depth.get(), 1, GL_DEPTH_COMPONENT32F, width, height);
    glNamedFramebufferTexture(target.framebuffer.get(), GL_COLOR_ATTACHMENT0, target.ids.get(), 0);
    glNamedFramebufferTexture(target.framebuffer.get(), GL_DEPTH_ATTACHMENT, target.depth.get(), 0);
    if (glCheckNamedFramebufferStatus(target.framebuffer.get(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        throw GlError("item buffers: the driver refuses a framebuffer of R32UI and 32-bit float depth");
    }
    constexpr GLbitfield read = GL_MAP_READ_BIT | GL_CLIENT_STORAGE_BIT;
    if (!software_) {
        glNamedBufferStorage(target.ids_read.get(), GLsizeiptr{4} * width * height, nullptr, read);
    }
    if (rows_ > 0) {
        const auto bytes = static_cast<GLsizeiptr>(sizeof(TexelTally) * covered_ids_ * rows_);
        glNamedBufferStorage(target.tallies.get(), bytes, nullptr, 0);
        if (!software_) {
            glNamedBufferStorage(target.tallies_read.get(), bytes, nullptr, read);
        }
        gl::label(GL_BUFFER, target.tallies.get(), fmt::format("covered texels {}", index));
    }
    gl::label(GL_TEXTURE, target.ids.get(), fmt::format("draw ids {}", index));
    gl::label(GL_TEXTURE, target.depth.get(), fmt::format("item depth {}", index));
    gl::label(GL_FRAMEBUFFER, target.framebuffer.get(), fmt::format("item atlas {}", index));
}

std::optional<std::uint32_t> ItemBuffers::table(std::uint64_t key, const DeltaFormFactors& weights) {
    const auto found =
        std::find_if(tables_.begin(), tables_.end(), [key](const Table& table) { return table.key == key; });
    if (found != tables_.end()) {
        found->used = true;
        return static_cast<std::uint32_t>(found - tables_.begin());
    }
    std::size_t index = tables_.size();
    if (index < most_tables_) {
        tables_.push_back({key, true});
    } else {
        // The one that was filled first among those that may be replaced.
        std::size_t tried = 0;
        while (tried < tables_.size() && tables_[next_table_].used) {
            next_table_ = (next_table_ + 1) % tables_.size();
            ++tried;
        }
        if (tried == tables_.size()) {
            return std::nullopt;
        }
        index = next_table_;
        next_table_ = (next_table_ + 1) % tables_.size();
        tables_[index] = {key, true};
    }
    scratch_.clear();
    for (std::uint32_t y = 0; y < weights.rows(); ++y) {
        const auto prefix = weights.prefix_row(y);
        for (std::uint32_t x = 0; x < atlas_.resolution; ++x) {
            scratch_.push_back(prefix[x + 1] - prefix[x]);
        }
    }
    const auto bytes = static_cast<GLsizeiptr>(scratch_.size() * sizeof(std::uint32_t));
    glNamedBufferSubData(weights_.get(), static_cast<GLintptr>(index) * bytes, bytes, scratch_.data());
    return static_cast<std::uint32_t>(index);
}

void ItemBuffers::begin(HemicubeDrawer& drawer, std::uint32_t used, std::span<const Counting> counting) {
    unmap();
    Target& target = targets_[(oldest_ + under_way_) % targets_.size()];
    ++under_way_;
    target.used = used;
    target.rows = counting.empty() ? 0 : counting.back().row + 1;
    if (target.rows > 0) {
        bind_counting(target, counting);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.get());
    const std::array<GLuint, 4> nothing{item_nothing, 0, 0, 0};
    const GLfloat infinity = 0.0f;
    glClearNamedFramebufferuiv(target.framebuffer.get(), GL_COLOR, 0, nothing.data());
    glClearNamedFramebufferfv(target.framebuffer.get(), GL_DEPTH, 0, &infinity);
    {
        const gl::ReversedDepth state(GL_CW);
        drawer.draw();
    }
    if (target.rows > 0) {
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    }
    if (!software_) {
        glPixelStorei(GL_PACK_ALIGNMENT, 4);
        glBindBuffer(GL_PIXEL_PACK_BUFFER, target.ids_read.get());
        glReadPixels(0, 0, static_cast<GLsizei>(atlas_.resolution),
                     static_cast<GLsizei>(3 * atlas_.resolution * used), GL_RED_INTEGER, GL_UNSIGNED_INT,
                     nullptr);
        glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
        if (target.rows > 0) {
            glCopyNamedBufferSubData(target.tallies.get(), target.tallies_read.get(), 0, 0,
                                     tally_bytes(target));
        }
        target.fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
        glFlush();
    }
}

void ItemBuffers::bind_counting(const Target& target, std::span<const Counting> counting) {
    CountingBlock block;
    block.width = atlas_.resolution;
    block.draw_ids = static_cast<std::uint32_t>(covered_ids_);
    for (std::size_t slot = 0; slot < counting.size(); ++slot) {
        block.hemicubes[slot] = {counting[slot].table, counting[slot].row, 0, 0};
    }
    for (Table& table : tables_) {
        table.used = false;
    }
    glNamedBufferData(counting_block_.get(), sizeof(block), &block, GL_STREAM_DRAW);
    const std::uint32_t zero = 0;
    glClearNamedBufferSubData(target.tallies.get(), GL_R32UI, 0, tally_bytes(target), GL_RED_INTEGER,
                              GL_UNSIGNED_INT, &zero);
    glBindBufferBase(GL_UNIFORM_BUFFER, counting_block, counting_block_.get());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, weights_block, weights_.get());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, covered_block, target.tallies.get());
}

GLsizeiptr ItemBuffers::tally_bytes(const Target& target) const {
    return static_cast<GLsizeiptr>(sizeof(TexelTally) * covered_ids_ * target.rows);
}

ItemBuffers::Batch ItemBuffers::finish() {
    // The ring moves on first: whatever fails below, this batch is over.
    Target& target = targets_[oldest_];
    oldest_ = (oldest_ + 1) % targets_.size();
    --under_way_;
    const auto width = static_cast<GLsizei>(atlas_.resolution);
    const auto atlas_rows = static_cast<GLsizei>(3 * atlas_.resolution * target.used);
    const GLsizeiptr tallies = tally_bytes(target);
    if (software_) {
        glBindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer.get());
        glPixelStorei(GL_PACK_ALIGNMENT, 4);
        glReadPixels(0, 0, width, atlas_rows, GL_RED_INTEGER, GL_UNSIGNED_INT, ids_.data());
        if (tallies > 0) {
            glGetNamedBufferSubData(target.tallies.get(), 0, tallies, tallies_.data());
        }
        gl::check_errors("item buffers");
        return {ids_.data(), tallies_.data()};
    }
    unmap();
    constexpr GLuint64 ten_seconds = 10'000'000'000u;
    const GLsync fence = std::exchange(target.fence, nullptr);
    GLenum state = GL_TIMEOUT_EXPIRED;
    while (state == GL_TIMEOUT_EXPIRED) {
        state = glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, ten_seconds);
    }
    glDeleteSync(fence);
    if (state == GL_WAIT_FAILED) {
        throw GlError("item buffers: waiting for the GPU failed");
    }
    mapped_ = &target;
    Batch batch{};
    batch.ids = static_cast<const std::uint32_t*>(
        glMapNamedBufferRange(target.ids_read.get(), 0, GLsizeiptr{4} * atlas_rows * width, GL_MAP_READ_BIT));
    if (tallies > 0) {
        batch.tallies = static_cast<const TexelTally*>(
            glMapNamedBufferRange(target.tallies_read.get(), 0, tallies, GL_MAP_READ_BIT));
    }
    if (batch.ids == nullptr || (tallies > 0 && batch.tallies == nullptr)) {
        throw GlError("item buffers: the read-back buffer cannot be mapped");
    }
    gl::check_errors("item buffers");
    return batch;
}

void ItemBuffers::discard() noexcept {
    while (under_way_ > 0) {
        Target& target = targets_[oldest_];
        if (target.fence != nullptr) {
            glDeleteSync(std::exchange(target.fence, nullptr));
        }
        oldest_ = (oldest_ + 1) % targets_.size();
        --under_way_;
    }
}

void ItemBuffers::restore_defaults() noexcept {
    unmap();
    glUseProgram(0);
    glBindVertexArray(0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    for (const GLuint block : {0u, counting_block}) {
        glBindBufferBase(GL_UNIFORM_BUFFER, block, 0);
    }
    for (const GLuint block : {0u, 1u, weights_block, covered_block}) {
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, block, 0);
    }
}

void ItemBuffers::unmap() noexcept {
    if (mapped_ != nullptr) {
        glUnmapNamedBuffer(mapped_->ids_read.get());
        if (mapped_->rows > 0) {
            glUnmapNamedBuffer(mapped_->tallies_read.get());
        }
        mapped_ = nullptr;
    }
}

} // namespace hemi
