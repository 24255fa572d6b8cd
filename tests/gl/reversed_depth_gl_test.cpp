#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/reversed_depth.hpp"

#include <catch2/catch.hpp>

#include <array>

using namespace hemi;

namespace {

/// One pixel of item numbers and its depth; the numbers of what is drawn are in the depth's own order.
class Pixel {
public:
    Pixel() {
        glTextureStorage2D(ids_.get(), 1, GL_R32UI, 1, 1);
        glTextureStorage2D(depth_.get(), 1, GL_DEPTH_COMPONENT32F, 1, 1);
        glNamedFramebufferTexture(target_.get(), GL_COLOR_ATTACHMENT0, ids_.get(), 0);
        glNamedFramebufferTexture(target_.get(), GL_DEPTH_ATTACHMENT, depth_.get(), 0);
        glBindFramebuffer(GL_FRAMEBUFFER, target_.get());
        glViewport(0, 0, 1, 1);
        glUseProgram(program_.get());
        glBindVertexArray(no_vertices_.get());
        const std::array<GLuint, 4> nothing{};
        const GLfloat infinity = 0.0F;
        glClearNamedFramebufferuiv(target_.get(), GL_COLOR, 0, nothing.data());
        glClearNamedFramebufferfv(target_.get(), GL_DEPTH, 0, &infinity);
    }
    ~Pixel() {
        glUseProgram(0);
        glBindVertexArray(0);
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
    }
    Pixel(const Pixel&) = delete;
    Pixel& operator=(const Pixel&) = delete;

    /// A triangle over the whole pixel at this clip z, turning counter-clockwise unless `clockwise`.
    void draw(GLuint id, GLfloat z, bool clockwise = false) const {
        glUniform1ui(0, id);
        glUniform1f(1, z);
        glUniform1i(2, clockwise ? 1 : 0);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }
    [[nodiscard]] GLuint id() const {
        GLuint value = 0;
        glReadPixels(0, 0, 1, 1, GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
        return value;
    }

private:
    static constexpr const char* vertex = R"(#version 450 core
layout(location = 1) uniform float z;
layout(location = 2) uniform bool clockwise;
void main() {
    vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
    gl_Position = vec4(clockwise ? corner.yx : corner, z, 1.0);
}
)";
    static constexpr const char* fragment = R"(#version 450 core
layout(location = 0) uniform uint id_to_write;
layout(location = 0) out uint id;
void main() { id = id_to_write; }
)";
    gl::Texture2D ids_;
    gl::Texture2D depth_;
    gl::Framebuffer target_;
    gl::VertexArray no_vertices_;
    gl::Program program_ = gl::make_program("pixel", vertex, fragment);
};

} // namespace

TEST_CASE("ReversedDepth: the nearest front face wins, in either order", "[gl]") {
    const auto context = gl::make_context("osmesa");
    for (const bool clockwise : {false, true}) {
        const Pixel pixel;
        const gl::ReversedDepth state(clockwise ? GL_CW : GL_CCW);
        CHECK(pixel.id() == 0);
        pixel.draw(1, 1e-30F, clockwise); // almost infinitely far
        CHECK(pixel.id() == 1);
        pixel.draw(2, 0.5F, clockwise);
        CHECK(pixel.id() == 2);
        pixel.draw(3, 0.25F, clockwise);
        CHECK(pixel.id() == 2);
        pixel.draw(4, 0.75F, !clockwise); // a back face
        CHECK(pixel.id() == 2);
        pixel.draw(5, 1.0F, clockwise);
        CHECK(pixel.id() == 5);
        gl::check_errors("drawing a pixel");
    }
}

TEST_CASE("ReversedDepth: backs can be drawn, and ties in depth decided", "[gl]") {
    const auto context = gl::make_context("osmesa");
    const Pixel pixel;
    const gl::ReversedDepth state(GL_CCW);
    pixel.draw(1, 0.5F);
    state.cull_fronts();
    pixel.draw(2, 0.75F); // a front face by now
    CHECK(pixel.id() == 1);
    state.offset(0.0F, -16.0F);
    pixel.draw(3, 0.5F, true);
    CHECK(pixel.id() == 1);
    state.offset(0.0F, 16.0F);
    pixel.draw(4, 0.5F, true);
    CHECK(pixel.id() == 4);
    gl::check_errors("drawing a pixel");
}

TEST_CASE("ReversedDepth: leaves OpenGL's default state behind", "[gl]") {
    const auto context = gl::make_context("osmesa");
    const auto integers = [] {
        std::array<GLint, 5> values{};
        const std::array<GLenum, 5> names{GL_CLIP_DEPTH_MODE, GL_CLIP_ORIGIN, GL_DEPTH_FUNC, GL_FRONT_FACE,
                                          GL_CULL_FACE_MODE};
        for (std::size_t i = 0; i < names.size(); ++i) {
            glGetIntegerv(names[i], &values[i]);
        }
        return values;
    };
    const auto switches = [] {
        return std::array{glIsEnabled(GL_DEPTH_TEST), glIsEnabled(GL_CULL_FACE),
                          glIsEnabled(GL_POLYGON_OFFSET_FILL)};
    };
    const auto offsets = [] {
        std::array<GLfloat, 2> values{};
        glGetFloatv(GL_POLYGON_OFFSET_FACTOR, &values[0]);
        glGetFloatv(GL_POLYGON_OFFSET_UNITS, &values[1]);
        return values;
    };
    const auto integers_before = integers();
    const auto switches_before = switches();
    const auto offsets_before = offsets();
    {
        const gl::ReversedDepth state(GL_CW);
        state.cull_fronts();
        state.offset(-1.0F, -16.0F);
        CHECK(integers() != integers_before);
        CHECK(switches() != switches_before);
        CHECK(offsets() != offsets_before);
    }
    CHECK(integers() == integers_before);
    CHECK(switches() == switches_before);
    CHECK(offsets() == offsets_before);
    gl::check_errors("restoring the state");
}
