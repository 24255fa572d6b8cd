#include "engine/hemicube/item_buffers.hpp"

#include "gl/reversed_depth.hpp"
#include "gl/shaders.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace hemi {

namespace {

void describe_vertices(GLuint layout) {
    const auto attribute = [layout](GLuint index, GLint count, bool integer, std::size_t offset) {
        glEnableVertexArrayAttrib(layout, index);
        glVertexArrayAttribBinding(layout, index, 0);
        const auto at = static_cast<GLuint>(offset);
        if (integer) {
            glVertexArrayAttribIFormat(layout, index, count, GL_UNSIGNED_INT, at);
        } else {
            glVertexArrayAttribFormat(layout, index, count, GL_FLOAT, GL_FALSE, at);
        }
    };
    attribute(0, 3, false, offsetof(DrawVertex, x));
    attribute(1, 2, false, offsetof(DrawVertex, grid_u));
    attribute(2, 2, false, offsetof(DrawVertex, twist_u));
    attribute(3, 3, true, offsetof(DrawVertex, first_id));
}

} // namespace

ItemBuffers::ItemBuffers(const gl::Context& context, std::uint32_t resolution, std::uint32_t slots)
    : resolution_(resolution), slots_(slots), software_(context.software()),
      affine_(gl::make_program("hemicube", gl::shaders::hemicube_vert, gl::shaders::hemicube_frag)),
      bilinear_(
          gl::make_program("hemicube quads", gl::shaders::hemicube_vert, gl::shaders::hemicube_quad_frag)) {
    GLint largest_texture = 0;
    std::array<GLint, 2> largest_viewport{};
    GLint subpixel_bits = 4;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest_texture);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, largest_viewport.data());
    glGetIntegerv(GL_SUBPIXEL_BITS, &subpixel_bits);
    grain_ = std::ldexp(1.0f, -subpixel_bits);
    const auto rows = static_cast<std::uint32_t>(std::min(largest_texture, largest_viewport[1]));
    if (3 * resolution > rows) {
        throw GlError(fmt::format("resolution {} needs a texture of {} rows; this device allows {}",
                                  resolution, 3 * resolution, rows));
    }
    slots_ = std::clamp(slots, 1u, rows / (3 * resolution));
    describe_vertices(layout_.get());
    // A GPU draws ahead while the CPU sums; large ones take much memory.
    targets_.resize(software_ ? 1 : (resolution > 1024 ? 2 : 3));
    for (std::uint32_t i = 0; i < targets_.size(); ++i) {
        prepare_target(targets_[i], i);
    }
    if (software_) {
        ids_.resize(std::size_t{3} * resolution_ * resolution_ * slots_);
    }
    gl::check_errors("item buffers");
}

void ItemBuffers::prepare_target(Target& target, std::uint32_t index) const {
    const auto width = static_cast<GLsizei>(resolution_);
    const auto height = static_cast<GLsizei>(3 * resolution_ * slots_);
    glTextureStorage2D(target.ids.get(), 1, GL_R32UI, width, height);
    glTextureParameteri(target.ids.get(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(target.ids.get(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTextureStorage2D(target.depth.get(), 1, GL_DEPTH_COMPONENT32F, width, height);
    glNamedFramebufferTexture(target.framebuffer.get(), GL_COLOR_ATTACHMENT0, target.ids.get(), 0);
    glNamedFramebufferTexture(target.framebuffer.get(), GL_DEPTH_ATTACHMENT, target.depth.get(), 0);
    if (glCheckNamedFramebufferStatus(target.framebuffer.get(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        throw GlError("item buffers: the driver refuses a framebuffer of R32UI and 32-bit float depth");
    }
    if (!software_) {
        glNamedBufferStorage(target.pixels.get(), GLsizeiptr{4} * width * height, nullptr,
                             GL_MAP_READ_BIT | GL_CLIENT_STORAGE_BIT);
    }
    gl::label(GL_TEXTURE, target.ids.get(), fmt::format("draw ids {}", index));
    gl::label(GL_TEXTURE, target.depth.get(), fmt::format("item depth {}", index));
    gl::label(GL_FRAMEBUFFER, target.framebuffer.get(), fmt::format("item atlas {}", index));
}

void ItemBuffers::begin(const DrawStream& stream, std::uint32_t used) {
    unmap();
    Target& target = targets_[(oldest_ + under_way_) % targets_.size()];
    ++under_way_;
    target.used = used;
    const auto width = static_cast<GLsizei>(resolution_);
    const auto height = static_cast<GLsizei>(3 * resolution_ * slots_);

    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.get());
    glViewport(0, 0, width, height);
    // Facing is decided on the CPU; what turns the wrong way here was flipped by rounding (see ViewBuilder).
    const gl::ReversedDepth state(GL_CW);
    const std::array<GLuint, 4> nothing{item_nothing, 0, 0, 0};
    const GLfloat infinity = 0.0f;
    glClearNamedFramebufferuiv(target.framebuffer.get(), GL_COLOR, 0, nothing.data());
    glClearNamedFramebufferfv(target.framebuffer.get(), GL_DEPTH, 0, &infinity);

    struct Part {
        const std::vector<DrawVertex>& vertices;
        const gl::Program& program;
        bool behind; ///< loses ties in depth
    };
    const std::array<Part, 3> parts{{{stream.affine, affine_, false},
                                     {stream.bilinear, bilinear_, false},
                                     {stream.blocked, affine_, true}}};
    const std::size_t total = stream.size();
    glNamedBufferData(target.vertices.get(), static_cast<GLsizeiptr>(total * sizeof(DrawVertex)), nullptr,
                      GL_STREAM_DRAW);
    glBindVertexArray(layout_.get());
    glVertexArrayVertexBuffer(layout_.get(), 0, target.vertices.get(), 0, sizeof(DrawVertex));
    // Vertices are snapped to a grain of 1/256 texel or so; along a silhouette, where a front hides a back
    // that shares its edge, either may come out nearer by its change of depth over that distance. Fronts are
    // set nearer by it and backs farther: the front wins.
    constexpr float last_places = 16.0f;
    std::size_t first = 0;
    for (const Part& part : parts) {
        if (part.vertices.empty()) {
            continue;
        }
        const auto count = part.vertices.size();
        glNamedBufferSubData(target.vertices.get(), static_cast<GLintptr>(first * sizeof(DrawVertex)),
                             static_cast<GLsizeiptr>(count * sizeof(DrawVertex)), part.vertices.data());
        state.offset(part.behind ? -grain_ : grain_, part.behind ? -last_places : 0.0f);
        glUseProgram(part.program.get());
        glDrawArrays(GL_TRIANGLES, static_cast<GLint>(first), static_cast<GLsizei>(count));
        first += count;
    }
    const auto used_rows = static_cast<GLsizei>(3 * resolution_ * used);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    if (!software_) {
        glBindBuffer(GL_PIXEL_PACK_BUFFER, target.pixels.get());
        glReadPixels(0, 0, width, used_rows, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
        glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
        target.fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
        glFlush();
    }
}

const std::uint32_t* ItemBuffers::finish() {
    // The ring moves on first: whatever fails below, this batch is over.
    const std::size_t index = oldest_;
    Target& target = targets_[index];
    oldest_ = (oldest_ + 1) % targets_.size();
    --under_way_;
    const auto width = static_cast<GLsizei>(resolution_);
    const auto rows = static_cast<GLsizei>(3 * resolution_ * target.used);
    if (software_) {
        glBindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer.get());
        glReadPixels(0, 0, width, rows, GL_RED_INTEGER, GL_UNSIGNED_INT, ids_.data());
        gl::check_errors("item buffers");
        return ids_.data();
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
    mapped_ = static_cast<const std::uint32_t*>(
        glMapNamedBufferRange(target.pixels.get(), 0, GLsizeiptr{4} * rows * width, GL_MAP_READ_BIT));
    if (mapped_ == nullptr) {
        throw GlError("item buffers: the read-back buffer cannot be mapped");
    }
    mapped_target_ = index;
    gl::check_errors("item buffers");
    return mapped_;
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
}

void ItemBuffers::unmap() noexcept {
    if (mapped_ != nullptr) {
        glUnmapNamedBuffer(targets_[mapped_target_].pixels.get());
        mapped_ = nullptr;
    }
}

} // namespace hemi
