#pragma once

#include "gl/objects.hpp"

#include "hemi/display/picture.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace hemi {

/// Draws a PictureMesh with the current OpenGL 4.5 context, whatever made it: the same code, and on the same
/// renderer the same pixels, for a window, a screenshot and a headless picture.
///
/// Make, use and destroy it with one context current on the calling thread. Draws expect OpenGL's default
/// state and leave it behind; the caller's framebuffer binding and viewport are not kept.
/// Memory: about 250 bytes a patch on the device, and one tile of samples (at most 335 MB).
class PictureRenderer {
public:
    /// Largest width and height of a picture.
    static constexpr std::uint32_t max_size = 16384;

    /// @throws GlError if a shader does not compile.
    PictureRenderer();

    /// Replaces what is drawn. `mesh` is not needed afterwards.
    void upload(const PictureMesh& mesh);

    /// Draws the picture into the lower left of framebuffer `target` (0: the window), tile by tile where the
    /// samples do not fit into one texture.
    /// @throws InvalidArgument for a size of 0 or above max_size, samples outside 1 to 8, a camera without a
    ///   direction or with a field of view outside (0, 180), an exposure that is not finite, more than 32
    ///   lines, a cut by groups of a mesh that says of none; GlError
    void draw(const Camera& camera, const PictureSettings& settings, GLuint target);

    /// The same pixels, read back. @throws as draw()
    [[nodiscard]] Picture picture(const Camera& camera, const PictureSettings& settings);

    /// Patch seen at the centre of every pixel, row by row from the top; no_item where none is. Where backs
    /// are shown, they count; outlines of what is looked through do not.
    /// @throws as draw()
    [[nodiscard]] std::vector<std::uint32_t> items(const Camera& camera, const PictureSettings& settings);
    /// The same of one pixel, x from the left and y from the top, inside the picture.
    [[nodiscard]] std::optional<std::uint32_t> item(const Camera& camera, const PictureSettings& settings,
                                                    std::uint32_t x, std::uint32_t y);
    static constexpr std::uint32_t no_item = 0xFFFFFFFFU;

private:
    /// Pixels of the picture, from its lower left.
    struct Tile {
        std::uint32_t x;
        std::uint32_t y;
        std::uint32_t width;
        std::uint32_t height;
    };
    /// Texture and what it is big enough for.
    struct Image {
        gl::Texture2D texture;
        std::uint32_t width = 0;
        std::uint32_t height = 0;
    };

    /// Puts the patches of groups that are shown, and behind them of those that are outlined, into the
    /// indices, where these are of others.
    void select(const std::vector<Visibility>& groups);
    void upload_indices(const std::vector<Visibility>& groups);
    [[nodiscard]] std::vector<Tile> tiles(const PictureSettings& settings) const;
    void draw_samples(const Camera& camera, const PictureSettings& settings, const Tile& tile);
    void draw_mesh(const gl::Program& program, const Camera& camera, const PictureSettings& settings,
                   const Tile& tile);
    /// Of groups that are looked through.
    void draw_outlines(const Camera& camera, const PictureSettings& settings, const Tile& tile);
    /// Sets what picture.vert wants of a program.
    void use(const gl::Program& program, const Camera& camera, const PictureSettings& settings,
             const Tile& tile);
    /// Items of a part of the picture, rows from the bottom: patch and 1, or 0.
    [[nodiscard]] std::vector<std::uint32_t> draw_items(const Camera& camera, const PictureSettings& settings,
                                                        const Tile& tile);
    void resolve(const PictureSettings& settings, const Tile& tile, GLuint target, std::uint32_t x,
                 std::uint32_t y);
    /// At least so large.
    void make_sample_target(std::uint32_t width, std::uint32_t height);

    gl::Program picture_program_;
    gl::Program resolve_program_;
    gl::Program item_program_;
    gl::Program outline_program_;
    gl::VertexArray vertex_array_;
    gl::VertexArray no_vertices_;
    gl::Buffer vertices_;
    gl::Buffer indices_;
    std::vector<std::uint8_t> corner_counts_;         ///< of every patch
    std::vector<std::uint32_t> groups_;               ///< likewise; empty: not known
    std::optional<std::vector<Visibility>> selected_; ///< what indices are of; none: of another mesh
    GLsizei index_count_ = 0;                         ///< of patches that are shown, which come first
    GLsizei outline_count_ = 0;                       ///< of patches that are outlined
    Vec3 origin_{0.0};
    double diagonal_ = 1.0;
    std::array<float, 3> environment_{};

    gl::Framebuffer sample_target_;
    std::optional<Image> colour_;
    std::optional<Image> depth_;
    GLint max_texture_ = 0;
};

} // namespace hemi
