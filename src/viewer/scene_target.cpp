#include "viewer/scene_target.hpp"

#include "gl/context.hpp"

#include <algorithm>

namespace hemi::viewer {

void SceneTarget::resize(std::array<std::uint32_t, 2> size) {
    if (size == size_) {
        return;
    }
    size_ = size;
    texture_ = gl::Texture2D();
    glTextureStorage2D(texture_.get(), 1, GL_RGBA8, static_cast<GLsizei>(size[0]),
                       static_cast<GLsizei>(size[1]));
    gl::label(GL_TEXTURE, texture_.get(), "window picture");
    glNamedFramebufferTexture(framebuffer_.get(), GL_COLOR_ATTACHMENT0, texture_.get(), 0);
    gl::check_errors("making the window's picture");
}

void SceneTarget::copy_to(GLuint target, std::uint32_t height) const {
    const auto width = static_cast<GLint>(size_[0]);
    const auto rows = static_cast<GLint>(size_[1]);
    const auto bottom = static_cast<GLint>(height) - rows;
    glBlitNamedFramebuffer(framebuffer_.get(), target, 0, 0, width, rows, 0, bottom, width, bottom + rows,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

std::vector<std::uint8_t> SceneTarget::pixels() const {
    const std::size_t row = std::size_t{size_[0]} * 3;
    std::vector<std::uint8_t> flipped(row * size_[1]);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.get());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, static_cast<GLsizei>(size_[0]), static_cast<GLsizei>(size_[1]), GL_RGB,
                 GL_UNSIGNED_BYTE, flipped.data());
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    std::vector<std::uint8_t> result(flipped.size());
    for (std::uint32_t y = 0; y < size_[1]; ++y) {
        std::copy_n(flipped.begin() + static_cast<std::ptrdiff_t>((size_[1] - 1 - y) * row), row,
                    result.begin() + static_cast<std::ptrdiff_t>(y * row));
    }
    return result;
}

} // namespace hemi::viewer
