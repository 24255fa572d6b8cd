#include "display/picture_renderer.hpp"

#include "display/picture_uniforms.hpp"
#include "gl/context.hpp"
#include "gl/reversed_depth.hpp"
#include "gl/shaders.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include <fmt/format.h>

namespace hemi {

namespace {

/// Samples along an edge of a tile. Small tiles are quicker, since their memory is used again and again; but
/// every tile draws the whole mesh anew, which is more than the pixels cost where each is one sample.
constexpr std::uint32_t small_tile = 1024;
constexpr std::uint32_t large_tile = 4096;
constexpr GLsizei many_indices = 12 * 20000;
/// Near plane, in scene diagonals. Reversed depth in floats loses nothing by a small one.
constexpr double near_share = 1e-5;
/// Where neither surface nor environment is seen; display linear.
constexpr float nothing_level = 0.025F;

float linear_of(std::uint8_t srgb) {
    const float value = static_cast<float>(srgb) / 255.0F;
    return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}
/// Patch outlines, pixels.
constexpr float outline_pixels = 0.75F;
/// Iso-lines, pixels.
constexpr float line_pixels = 1.5F;
constexpr std::size_t most_lines = 32;
/// Stripes on the backs of surfaces, pixels.
constexpr float stripe_pixels = 4.0F;

struct Vertex {
    std::array<float, 3> position;
    std::array<float, 3> gouraud;
    std::array<float, 3> patch;
    std::array<float, 3> outline;
    std::uint32_t item;
};

std::array<float, 3> triple(const std::vector<float>& values, std::size_t index) {
    return {values[index * 3], values[index * 3 + 1], values[index * 3 + 2]};
}

/// Vertices of a patch: a triangle is one, a quadrilateral four triangles around its centre, so that the
/// picture does not show along which diagonal it was cut.
/// @return the number of its corners
std::uint8_t add_patch(const PictureMesh& mesh, std::size_t patch, bool outlined,
                       std::vector<Vertex>& vertices) {
    const auto item = static_cast<std::uint32_t>(patch + 1);
    const std::array<float, 3> flat = triple(mesh.patches, patch);
    const auto corner = [&](std::size_t k, std::array<float, 3> outline) {
        return Vertex{triple(mesh.positions, patch * 4 + k), triple(mesh.corners, patch * 4 + k), flat,
                      outline, item};
    };
    if (triple(mesh.positions, patch * 4 + 2) == triple(mesh.positions, patch * 4 + 3)) {
        const float off = outlined ? 0.0F : 1.0F;
        vertices.insert(vertices.end(), {corner(0, {1.0F, off, off}), corner(1, {off, 1.0F, off}),
                                         corner(2, {off, off, 1.0F})});
        return 3;
    }
    Vertex centre{{}, {}, flat, {1.0F, 1.0F, 1.0F}, item};
    for (std::size_t k = 0; k < 4; ++k) {
        vertices.push_back(corner(k, {outlined ? 0.0F : 1.0F, 1.0F, 1.0F}));
        for (std::size_t i = 0; i < 3; ++i) {
            centre.position[i] += 0.25F * vertices.back().position[i];
            centre.gouraud[i] += 0.25F * vertices.back().gouraud[i];
        }
    }
    vertices.push_back(centre);
    return 4;
}

/// Triangles of a patch whose vertices begin at `first`, see add_patch().
void add_indices(std::uint8_t corners, std::uint32_t first, std::vector<std::uint32_t>& indices) {
    if (corners == 3) {
        indices.insert(indices.end(), {first, first + 1, first + 2});
        return;
    }
    for (std::uint32_t k = 0; k < 4; ++k) {
        indices.insert(indices.end(), {first + k, first + (k + 1) % 4, first + 4});
    }
}

/// Rows: right, up and back of a camera; of unit length and perpendicular to each other.
std::array<Vec3, 3> camera_axes(const Camera& camera) {
    const Vec3 view = camera.target - camera.eye;
    const double length = glm::length(view);
    if (!(length > 0.0) || !std::isfinite(length)) {
        throw InvalidArgument("camera: eye and target are the same point, or not finite");
    }
    const Vec3 forward = view / length;
    Vec3 right = glm::cross(forward, camera.up);
    if (!(glm::length(right) > 1e-9 * glm::length(camera.up))) {
        // Up is along the view: any other direction does.
        right = glm::cross(forward, std::abs(forward.y) < 0.9 ? Vec3(0.0, 1.0, 0.0) : Vec3(1.0, 0.0, 0.0));
    }
    right = glm::normalize(right);
    return {right, glm::cross(right, forward), -forward};
}

/// Column-major clip_from_direction for a part of the picture, given in pixels from its lower left.
/// @param reach  from the eye to the farthest point of the scene, at least
std::array<float, 16> projection(const Camera& camera, const PictureSettings& settings, double x, double y,
                                 double width, double height, double near_distance, double reach) {
    const std::array<Vec3, 3> axes = camera_axes(camera);
    const double focal = 1.0 / std::tan(camera.fov * std::numbers::pi / 360.0);
    const double aspect = static_cast<double>(settings.width) / settings.height;
    const double scale_x = settings.width / width;
    const double scale_y = settings.height / height;
    const double shift_x = (settings.width - 2.0 * x - width) / width;
    const double shift_y = (settings.height - 2.0 * y - height) / height;
    std::array<float, 16> matrix{};
    if (camera.orthographic) {
        const double scale = focal / glm::length(camera.target - camera.eye);
        for (int column = 0; column < 3; ++column) {
            const std::size_t at = static_cast<std::size_t>(column) * 4;
            matrix[at] = static_cast<float>(scale_x * scale / aspect * axes[0][column]);
            matrix[at + 1] = static_cast<float>(scale_y * scale * axes[1][column]);
            matrix[at + 2] = static_cast<float>(0.5 / reach * axes[2][column]);
        }
        matrix[12] = static_cast<float>(shift_x);
        matrix[13] = static_cast<float>(shift_y);
        matrix[14] = 0.5F;
        matrix[15] = 1.0F;
        return matrix;
    }
    for (int column = 0; column < 3; ++column) {
        const double depth = -axes[2][column];
        const std::size_t at = static_cast<std::size_t>(column) * 4;
        matrix[at] = static_cast<float>(scale_x * focal / aspect * axes[0][column] + shift_x * depth);
        matrix[at + 1] = static_cast<float>(scale_y * focal * axes[1][column] + shift_y * depth);
        matrix[at + 3] = static_cast<float>(depth);
    }
    matrix[14] = static_cast<float>(near_distance);
    return matrix;
}

void check(const Camera& camera, const PictureSettings& settings) {
    for (const std::uint32_t size : {settings.width, settings.height}) {
        if (size == 0 || size > PictureRenderer::max_size) {
            throw InvalidArgument(fmt::format("picture size {}x{}; each must be 1 to {}", settings.width,
                                              settings.height, PictureRenderer::max_size));
        }
    }
    if (settings.samples < 1 || settings.samples > 8) {
        throw InvalidArgument(
            fmt::format("{} samples along a pixel's edge; must be 1 to 8", settings.samples));
    }
    if (!std::isfinite(settings.exposure) || settings.exposure < 0.0) {
        throw InvalidArgument(fmt::format("exposure {}; must be finite and not negative", settings.exposure));
    }
    if (!(camera.fov > 0.0 && camera.fov < 180.0)) {
        throw InvalidArgument(
            fmt::format("camera: field of view {}; must lie between 0 and 180", camera.fov));
    }
    if (settings.iso_lines.size() > most_lines) {
        throw InvalidArgument(
            fmt::format("{} iso-lines; must be at most {}", settings.iso_lines.size(), most_lines));
    }
}

gl::Texture2D make_texture(GLenum format, std::uint32_t width, std::uint32_t height, const char* name) {
    gl::Texture2D texture;
    glTextureStorage2D(texture.get(), 1, format, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
    glTextureParameteri(texture.get(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(texture.get(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl::label(GL_TEXTURE, texture.get(), name);
    return texture;
}

/// Cuts what is drawn while it lives, where there is a plane.
class Clipping {
public:
    explicit Clipping(const PictureCut& cut) : on_(cut.clip.has_value()) {
        if (on_) {
            glEnable(GL_CLIP_DISTANCE0);
        }
    }
    ~Clipping() {
        if (on_) {
            glDisable(GL_CLIP_DISTANCE0);
        }
    }
    Clipping(const Clipping&) = delete;
    Clipping& operator=(const Clipping&) = delete;

private:
    bool on_;
};

void require_complete(const gl::Framebuffer& framebuffer, const char* name) {
    const GLenum status = glCheckNamedFramebufferStatus(framebuffer.get(), GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE) {
        throw GlError(fmt::format("{}: framebuffer incomplete (0x{:04x})", name, status));
    }
}

} // namespace

PictureRenderer::PictureRenderer()
    : picture_program_(gl::make_program("picture", gl::shaders::picture_vert, gl::shaders::picture_frag)),
      resolve_program_(gl::make_program("resolve", gl::shaders::fullscreen_vert, gl::shaders::resolve_frag)),
      item_program_(
          gl::make_program("picture items", gl::shaders::picture_vert, gl::shaders::picture_item_frag)),
      outline_program_(gl::make_program("picture outlines", gl::shaders::picture_vert,
                                        gl::shaders::picture_outline_frag)) {
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_texture_);
    gl::label(GL_BUFFER, vertices_.get(), "picture vertices");
    gl::label(GL_BUFFER, indices_.get(), "picture indices");
    glVertexArrayVertexBuffer(vertex_array_.get(), 0, vertices_.get(), 0, sizeof(Vertex));
    glVertexArrayElementBuffer(vertex_array_.get(), indices_.get());
    const std::array<std::size_t, 4> offsets{offsetof(Vertex, position), offsetof(Vertex, gouraud),
                                             offsetof(Vertex, patch), offsetof(Vertex, outline)};
    for (GLuint attribute = 0; attribute < offsets.size(); ++attribute) {
        glEnableVertexArrayAttrib(vertex_array_.get(), attribute);
        glVertexArrayAttribFormat(vertex_array_.get(), attribute, 3, GL_FLOAT, GL_FALSE,
                                  static_cast<GLuint>(offsets[attribute]));
        glVertexArrayAttribBinding(vertex_array_.get(), attribute, 0);
    }
    constexpr GLuint item_attribute = 4;
    glEnableVertexArrayAttrib(vertex_array_.get(), item_attribute);
    glVertexArrayAttribIFormat(vertex_array_.get(), item_attribute, 1, GL_UNSIGNED_INT,
                               static_cast<GLuint>(offsetof(Vertex, item)));
    glVertexArrayAttribBinding(vertex_array_.get(), item_attribute, 0);
}

void PictureRenderer::upload(const PictureMesh& mesh) {
    const std::size_t patches = mesh.patches.size() / 3;
    if (mesh.positions.size() != patches * 12 || mesh.corners.size() != patches * 12) {
        throw InvalidArgument(fmt::format("picture: {} patches, {} positions and {} corner values", patches,
                                          mesh.positions.size(), mesh.corners.size()));
    }
    if (patches * 12 > static_cast<std::size_t>(std::numeric_limits<GLsizei>::max())) {
        throw InvalidArgument(fmt::format("picture: {} patches are more than can be drawn", patches));
    }
    if (!mesh.groups.empty() && mesh.groups.size() != patches) {
        throw InvalidArgument(fmt::format("picture: {} patches, {} groups", patches, mesh.groups.size()));
    }
    std::vector<Vertex> vertices;
    vertices.reserve(patches * 5);
    corner_counts_.clear();
    for (std::size_t patch = 0; patch < patches; ++patch) {
        corner_counts_.push_back(add_patch(mesh, patch, patch + mesh.without_outline < patches, vertices));
    }
    glNamedBufferData(vertices_.get(), static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)),
                      vertices.data(), GL_STATIC_DRAW);
    groups_ = mesh.groups;
    selected_.reset(); // the next picture says which groups it shows
    gl::check_errors("uploading the picture's mesh");
    origin_ = mesh.origin;
    environment_ = mesh.environment;
    diagonal_ = mesh.bounds.diagonal() > 0.0 ? mesh.bounds.diagonal() : 1.0;
}

void PictureRenderer::upload_indices(const std::vector<Visibility>& groups) {
    std::vector<std::uint32_t> indices;
    std::vector<std::uint32_t> outlined;
    indices.reserve(corner_counts_.size() * 12);
    std::uint32_t first = 0;
    for (std::size_t patch = 0; patch < corner_counts_.size(); ++patch) {
        const bool known = !groups_.empty() && groups_[patch] < groups.size();
        const Visibility visibility = known ? groups[groups_[patch]] : Visibility::shown;
        if (visibility != Visibility::hidden) {
            add_indices(corner_counts_[patch], first, visibility == Visibility::shown ? indices : outlined);
        }
        first += corner_counts_[patch] == 3 ? 3 : 5;
    }
    index_count_ = static_cast<GLsizei>(indices.size());
    outline_count_ = static_cast<GLsizei>(outlined.size());
    indices.insert(indices.end(), outlined.begin(), outlined.end());
    glNamedBufferData(indices_.get(), static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)),
                      indices.data(), GL_STATIC_DRAW);
    gl::check_errors("uploading the picture's patches");
    selected_ = groups;
}

void PictureRenderer::select(const std::vector<Visibility>& groups) {
    if (groups == selected_) {
        return;
    }
    if (groups_.empty() && !corner_counts_.empty() && !groups.empty()) {
        throw InvalidArgument("picture: a cut by groups, of a mesh that says of none");
    }
    upload_indices(groups);
}

std::vector<PictureRenderer::Tile> PictureRenderer::tiles(const PictureSettings& settings) const {
    const bool small = index_count_ < many_indices && settings.samples > 1;
    const std::uint32_t wanted = small ? small_tile : large_tile;
    const std::uint32_t samples = std::min(wanted, static_cast<std::uint32_t>(max_texture_));
    const std::uint32_t edge = std::max(1U, samples / settings.samples);
    std::vector<Tile> result;
    for (std::uint32_t y = 0; y < settings.height; y += edge) {
        for (std::uint32_t x = 0; x < settings.width; x += edge) {
            result.push_back({x, y, std::min(edge, settings.width - x), std::min(edge, settings.height - y)});
        }
    }
    return result;
}

void PictureRenderer::make_sample_target(std::uint32_t width, std::uint32_t height) {
    if (colour_ && colour_->width >= width && colour_->height >= height) {
        return;
    }
    if (colour_) {
        width = std::max(width, colour_->width);
        height = std::max(height, colour_->height);
    }
    colour_.reset();
    depth_.reset();
    colour_ = Image{make_texture(GL_RGBA32F, width, height, "picture samples"), width, height};
    depth_ = Image{make_texture(GL_DEPTH_COMPONENT32F, width, height, "picture depth"), width, height};
    glNamedFramebufferTexture(sample_target_.get(), GL_COLOR_ATTACHMENT0, colour_->texture.get(), 0);
    glNamedFramebufferTexture(sample_target_.get(), GL_DEPTH_ATTACHMENT, depth_->texture.get(), 0);
    gl::check_errors("making the picture's samples");
    require_complete(sample_target_, "picture samples");
}

void PictureRenderer::draw_samples(const Camera& camera, const PictureSettings& settings, const Tile& tile) {
    const std::uint32_t samples = settings.samples;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, sample_target_.get());
    glViewport(0, 0, static_cast<GLsizei>(tile.width * samples), static_cast<GLsizei>(tile.height * samples));
    const std::array<float, 4> nothing{};
    const float far_depth = 0.0F;
    glClearNamedFramebufferfv(sample_target_.get(), GL_COLOR, 0, nothing.data());
    glClearNamedFramebufferfv(sample_target_.get(), GL_DEPTH, 0, &far_depth);

    glUseProgram(picture_program_.get());
    glUniform1i(picture_uniforms::flat_shading, settings.shading == Shading::flat ? 1 : 0);
    glUniform1f(picture_uniforms::outline_width,
                settings.outlines ? outline_pixels * static_cast<float>(samples) : 0.0F);
    glUniform1i(picture_uniforms::line_count, static_cast<GLint>(settings.iso_lines.size()));
    glUniform1f(picture_uniforms::line_width, line_pixels * static_cast<float>(samples));
    glUniform1fv(picture_uniforms::lines, static_cast<GLsizei>(settings.iso_lines.size()),
                 settings.iso_lines.data());
    glUniform1f(picture_uniforms::stripe_width, stripe_pixels * static_cast<float>(samples));
    glUniform2f(picture_uniforms::first_sample, static_cast<float>(tile.x * samples),
                static_cast<float>(tile.y * samples));
    draw_mesh(picture_program_, camera, settings, tile);
    if (outline_count_ > 0) {
        draw_outlines(camera, settings, tile);
    }
}

void PictureRenderer::draw_mesh(const gl::Program& program, const Camera& camera,
                                const PictureSettings& settings, const Tile& tile) {
    const gl::ReversedDepth state(GL_CCW);
    const Clipping clipping(settings.cut);
    use(program, camera, settings, tile);
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
    if (settings.backs) {
        // A hair farther away, so that a two-sided surface shows the patch on that side.
        state.cull_fronts();
        state.offset(-1.0F, -16.0F);
        glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
    }
}

void PictureRenderer::draw_outlines(const Camera& camera, const PictureSettings& settings, const Tile& tile) {
    const gl::ReversedDepth state(GL_CCW);
    const Clipping clipping(settings.cut);
    use(outline_program_, camera, settings, tile);
    glUniform1f(picture_uniforms::outline_width, outline_pixels * static_cast<float>(settings.samples));
    const auto* const first =
        reinterpret_cast<const void*>(static_cast<std::uintptr_t>(index_count_) * sizeof(std::uint32_t));
    glDrawElements(GL_TRIANGLES, outline_count_, GL_UNSIGNED_INT, first);
    state.cull_fronts();
    glDrawElements(GL_TRIANGLES, outline_count_, GL_UNSIGNED_INT, first);
}

void PictureRenderer::use(const gl::Program& program, const Camera& camera, const PictureSettings& settings,
                          const Tile& tile) {
    glUseProgram(program.get());
    const Vec3 eye = camera.eye - origin_;
    const std::array<float, 16> matrix = projection(camera, settings, tile.x, tile.y, tile.width, tile.height,
                                                    near_share * diagonal_, glm::length(eye) + diagonal_);
    glUniformMatrix4fv(picture_uniforms::clip_from_direction, 1, GL_FALSE, matrix.data());
    glUniform3f(picture_uniforms::eye, static_cast<float>(eye.x), static_cast<float>(eye.y),
                static_cast<float>(eye.z));
    const ClipPlane plane = settings.cut.clip.value_or(ClipPlane{Vec3(0.0), 1.0});
    glUniform4f(picture_uniforms::clip, static_cast<float>(plane.normal.x),
                static_cast<float>(plane.normal.y), static_cast<float>(plane.normal.z),
                static_cast<float>(plane.offset - glm::dot(plane.normal, origin_)));
    glBindVertexArray(vertex_array_.get());
}

void PictureRenderer::resolve(const PictureSettings& settings, const Tile& tile, GLuint target,
                              std::uint32_t x, std::uint32_t y) {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target);
    glViewport(static_cast<GLint>(x), static_cast<GLint>(y), static_cast<GLsizei>(tile.width),
               static_cast<GLsizei>(tile.height));
    glDisable(GL_DITHER);
    glUseProgram(resolve_program_.get());
    glBindTextureUnit(resolve_uniforms::samples_unit, colour_->texture.get());
    glUniform1i(resolve_uniforms::samples_per_edge, static_cast<GLint>(settings.samples));
    glUniform2i(resolve_uniforms::target_origin, static_cast<GLint>(x), static_cast<GLint>(y));
    glUniform1f(resolve_uniforms::exposure, static_cast<float>(settings.exposure));
    glUniform1i(resolve_uniforms::filmic, settings.tone_mapping == ToneMapping::filmic ? 1 : 0);
    glUniform3f(resolve_uniforms::environment, environment_[0], environment_[1], environment_[2]);
    const bool shows_environment = !settings.background && environment_ != std::array<float, 3>{};
    glUniform1i(resolve_uniforms::has_environment, shows_environment ? 1 : 0);
    const auto behind = [&settings](std::size_t c) {
        return settings.background ? linear_of((*settings.background)[c]) : nothing_level;
    };
    glUniform3f(resolve_uniforms::nothing, behind(0), behind(1), behind(2));
    glBindVertexArray(no_vertices_.get());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glEnable(GL_DITHER);
    glBindTextureUnit(resolve_uniforms::samples_unit, 0);
    glBindVertexArray(0);
    glUseProgram(0);
}

void PictureRenderer::draw(const Camera& camera, const PictureSettings& settings, GLuint target) {
    check(camera, settings);
    select(settings.cut.groups);
    for (const Tile& tile : tiles(settings)) {
        make_sample_target(tile.width * settings.samples, tile.height * settings.samples);
        draw_samples(camera, settings, tile);
        resolve(settings, tile, target, tile.x, tile.y);
    }
    gl::check_errors("drawing the picture");
}

Picture PictureRenderer::picture(const Camera& camera, const PictureSettings& settings) {
    check(camera, settings);
    select(settings.cut.groups);
    Picture result;
    result.width = settings.width;
    result.height = settings.height;
    const std::size_t row = std::size_t{settings.width} * 3;
    result.srgb.resize(row * settings.height);
    result.linear.resize(row * settings.height);

    const std::vector<Tile> all = tiles(settings);
    const gl::Texture2D srgb = make_texture(GL_RGBA8, all[0].width, all[0].height, "picture");
    const gl::Texture2D linear = make_texture(GL_RGBA32F, all[0].width, all[0].height, "linear picture");
    const gl::Framebuffer target;
    glNamedFramebufferTexture(target.get(), GL_COLOR_ATTACHMENT0, srgb.get(), 0);
    glNamedFramebufferTexture(target.get(), GL_COLOR_ATTACHMENT1, linear.get(), 0);
    const std::array<GLenum, 2> attachments{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    glNamedFramebufferDrawBuffers(target.get(), 2, attachments.data());
    require_complete(target, "picture");

    std::vector<std::uint8_t> bytes(std::size_t{all[0].width} * all[0].height * 3);
    std::vector<float> floats(bytes.size());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target.get());
    for (const Tile& tile : all) {
        stop_if_interrupted();
        make_sample_target(tile.width * settings.samples, tile.height * settings.samples);
        draw_samples(camera, settings, tile);
        resolve(settings, tile, target.get(), 0, 0);
        const auto width = static_cast<GLsizei>(tile.width);
        const auto height = static_cast<GLsizei>(tile.height);
        glNamedFramebufferReadBuffer(target.get(), GL_COLOR_ATTACHMENT0);
        glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, bytes.data());
        glNamedFramebufferReadBuffer(target.get(), GL_COLOR_ATTACHMENT1);
        glReadPixels(0, 0, width, height, GL_RGB, GL_FLOAT, floats.data());
        for (std::uint32_t y = 0; y < tile.height; ++y) {
            // OpenGL's rows begin at the bottom.
            const std::size_t to = (settings.height - 1 - tile.y - y) * row + std::size_t{tile.x} * 3;
            const auto from = static_cast<std::ptrdiff_t>(std::size_t{y} * tile.width * 3);
            std::copy_n(bytes.begin() + from, tile.width * 3,
                        result.srgb.begin() + static_cast<std::ptrdiff_t>(to));
            std::copy_n(floats.begin() + from, tile.width * 3,
                        result.linear.begin() + static_cast<std::ptrdiff_t>(to));
        }
    }
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    gl::check_errors("drawing the picture");
    return result;
}

std::vector<std::uint32_t> PictureRenderer::draw_items(const Camera& camera, const PictureSettings& settings,
                                                       const Tile& tile) {
    const gl::Texture2D items = make_texture(GL_R32UI, tile.width, tile.height, "picture items");
    const gl::Texture2D depth = make_texture(GL_DEPTH_COMPONENT32F, tile.width, tile.height, "item depth");
    const gl::Framebuffer target;
    glNamedFramebufferTexture(target.get(), GL_COLOR_ATTACHMENT0, items.get(), 0);
    glNamedFramebufferTexture(target.get(), GL_DEPTH_ATTACHMENT, depth.get(), 0);
    require_complete(target, "picture items");
    const std::array<GLuint, 4> nothing{};
    const float far_depth = 0.0F;
    glClearNamedFramebufferuiv(target.get(), GL_COLOR, 0, nothing.data());
    glClearNamedFramebufferfv(target.get(), GL_DEPTH, 0, &far_depth);
    glBindFramebuffer(GL_FRAMEBUFFER, target.get());
    glViewport(0, 0, static_cast<GLsizei>(tile.width), static_cast<GLsizei>(tile.height));
    draw_mesh(item_program_, camera, settings, tile);
    std::vector<std::uint32_t> result(std::size_t{tile.width} * tile.height);
    glReadPixels(0, 0, static_cast<GLsizei>(tile.width), static_cast<GLsizei>(tile.height), GL_RED_INTEGER,
                 GL_UNSIGNED_INT, result.data());
    glBindVertexArray(0);
    glUseProgram(0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    gl::check_errors("drawing the picture's items");
    return result;
}

std::vector<std::uint32_t> PictureRenderer::items(const Camera& camera, const PictureSettings& settings) {
    check(camera, settings);
    select(settings.cut.groups);
    PictureSettings single = settings;
    single.samples = 1;
    std::vector<std::uint32_t> result(std::size_t{settings.width} * settings.height);
    for (const Tile& tile : tiles(single)) {
        const std::vector<std::uint32_t> part = draw_items(camera, settings, tile);
        for (std::uint32_t y = 0; y < tile.height; ++y) {
            const std::size_t to = std::size_t{settings.height - 1 - tile.y - y} * settings.width + tile.x;
            for (std::uint32_t x = 0; x < tile.width; ++x) {
                result[to + x] = part[std::size_t{y} * tile.width + x] - 1; // 0 becomes no_item
            }
        }
    }
    return result;
}

std::optional<std::uint32_t> PictureRenderer::item(const Camera& camera, const PictureSettings& settings,
                                                   std::uint32_t x, std::uint32_t y) {
    check(camera, settings);
    if (x >= settings.width || y >= settings.height) {
        throw InvalidArgument(
            fmt::format("pixel {}, {} of a picture of {}x{}", x, y, settings.width, settings.height));
    }
    select(settings.cut.groups);
    const std::uint32_t found = draw_items(camera, settings, {x, settings.height - 1 - y, 1, 1})[0];
    return found == 0 ? std::nullopt : std::optional(found - 1);
}

Picture draw_picture(const PictureMesh& mesh, const Camera& camera, const PictureSettings& settings,
                     const std::string& device) {
    check(camera, settings);
    const auto context = gl::make_context(device);
    PictureRenderer renderer;
    renderer.upload(mesh);
    return renderer.picture(camera, settings);
}

} // namespace hemi
