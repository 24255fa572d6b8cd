#pragma once

#include "gl/objects.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace hemi::viewer {

/// An image in the window's context that is drawn to and copied from: the picture is kept in one while only
/// panels change.
class SceneTarget {
public:
    /// Its content is lost where the size changes.
    void resize(std::array<std::uint32_t, 2> size);
    [[nodiscard]] std::array<std::uint32_t, 2> size() const { return size_; }
    [[nodiscard]] GLuint framebuffer() const { return framebuffer_.get(); }

    /// Copies its pixels to the upper left of `target`, which is `height` pixels high.
    void copy_to(GLuint target, std::uint32_t height) const;
    /// Three bytes a pixel, rows from the top.
    [[nodiscard]] std::vector<std::uint8_t> pixels() const;

private:
    std::array<std::uint32_t, 2> size_{0, 0};
    gl::Texture2D texture_;
    gl::Framebuffer framebuffer_;
};

} // namespace hemi::viewer
