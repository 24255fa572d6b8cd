#include "display/picture_uniforms.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/shaders.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <map>
#include <string>

using namespace hemi;
using Catch::Matchers::Contains;

namespace {

/// Names and locations.
using Locations = std::map<std::string, GLint>;

/// Active variables of one kind (GL_UNIFORM, GL_PROGRAM_INPUT); those that OpenGL itself defines are left
/// out.
Locations locations(const gl::Program& program, GLenum kind) {
    GLint count = 0;
    glGetProgramInterfaceiv(program.get(), kind, GL_ACTIVE_RESOURCES, &count);
    Locations found;
    for (GLuint index = 0; index < static_cast<GLuint>(count); ++index) {
        std::string name(256, '\0');
        GLsizei length = 0;
        glGetProgramResourceName(program.get(), kind, index, static_cast<GLsizei>(name.size()), &length,
                                 name.data());
        name.resize(static_cast<std::size_t>(length));
        if (!name.starts_with("gl_")) {
            found[name] = glGetProgramResourceLocation(program.get(), kind, name.c_str());
        }
    }
    return found;
}

std::string error_of(const char* vertex_source, const char* fragment_source) {
    try {
        static_cast<void>(gl::make_program("a cube", vertex_source, fragment_source));
    } catch (const GlError& error) {
        return error.what();
    }
    return "";
}

constexpr const char* good_vertex = "#version 450 core\nlayout(location = 0) out vec2 at;\n"
                                    "void main() { at = vec2(1.0); gl_Position = vec4(0.0); }\n";
constexpr const char* good_fragment = "#version 450 core\nlayout(location = 0) in vec2 at;\n"
                                      "layout(location = 0) out vec4 colour;\n"
                                      "void main() { colour = at.xyxy; }\n";

} // namespace

TEST_CASE("make_program: two shaders that fit make a program with its label", "[gl]") {
    const auto context = gl::make_context("osmesa");
    const gl::Program program = gl::make_program("a cube", good_vertex, good_fragment);
    glUseProgram(program.get());
    glUseProgram(0);
    std::string label(64, '\0');
    GLsizei length = 0;
    glGetObjectLabel(GL_PROGRAM, program.get(), static_cast<GLsizei>(label.size()), &length, label.data());
    CHECK(label.substr(0, static_cast<std::size_t>(length)) == "a cube");
    GLint attached = 0;
    glGetProgramiv(program.get(), GL_ATTACHED_SHADERS, &attached);
    CHECK(attached == 2);
    gl::check_errors("making a program");
}

TEST_CASE("make_program: an error of the compiler names program, stage, line and word", "[gl]") {
    const auto context = gl::make_context("osmesa");
    const char* bad = "#version 450 core\n\nvoid main() {\n    undeclared = 1.0;\n}\n";
    // Mesa's place in a source: string 0, line 4.
    CHECK_THAT(error_of(bad, good_fragment), Contains("a cube: vertex shader does not compile: ") &&
                                                 Contains("0:4(") && Contains("undeclared"));
    CHECK_THAT(error_of(good_vertex, bad), Contains("a cube: fragment shader does not compile: ") &&
                                               Contains("0:4(") && Contains("undeclared"));
    gl::check_errors("after programs that do not compile"); // was reported, and leaves nothing behind
}

TEST_CASE("make_program: shaders that do not fit are refused by the linker's message", "[gl]") {
    const auto context = gl::make_context("osmesa");
    const char* other = "#version 450 core\nlayout(location = 0) in flat uvec3 at;\n"
                        "layout(location = 0) out vec4 colour;\nvoid main() { colour = vec4(at, 1u); }\n";
    CHECK_THAT(error_of(good_vertex, other), Contains("a cube: program does not link: ") && Contains("at"));
    gl::check_errors("after a program that does not link");
}

TEST_CASE("shaders: uniforms of the picture are where the constants say", "[gl][display]") {
    const auto context = gl::make_context("osmesa");
    {
        using namespace picture_uniforms;
        const Locations shared{{"eye", eye}, {"clip_from_direction", clip_from_direction}, {"clip", clip}};
        Locations all{{"flat_shading", flat_shading},
                      {"outline_width", outline_width},
                      {"stripe_width", stripe_width},
                      {"first_sample", first_sample},
                      {"line_count", line_count},
                      {"line_width", line_width},
                      {"lines[0]", lines}};
        all.insert(shared.begin(), shared.end());
        CHECK(locations(gl::make_program("picture", gl::shaders::picture_vert, gl::shaders::picture_frag),
                        GL_UNIFORM) == all);
        CHECK(locations(gl::make_program("items", gl::shaders::picture_vert, gl::shaders::picture_item_frag),
                        GL_UNIFORM) == shared);
        Locations outlines{{"outline_width", outline_width}};
        outlines.insert(shared.begin(), shared.end());
        CHECK(locations(
                  gl::make_program("outlines", gl::shaders::picture_vert, gl::shaders::picture_outline_frag),
                  GL_UNIFORM) == outlines);
    }
    using namespace resolve_uniforms;
    const gl::Program resolve =
        gl::make_program("resolve", gl::shaders::fullscreen_vert, gl::shaders::resolve_frag);
    Locations found = locations(resolve, GL_UNIFORM);
    REQUIRE(found.contains("samples"));
    GLint unit = -1;
    glGetUniformiv(resolve.get(), found["samples"], &unit);
    CHECK(unit == static_cast<GLint>(samples_unit));
    found.erase("samples");
    CHECK(found == Locations{{"samples_per_edge", samples_per_edge},
                             {"target_origin", target_origin},
                             {"exposure", exposure},
                             {"filmic", filmic},
                             {"environment", environment},
                             {"has_environment", has_environment},
                             {"nothing", nothing}});
    gl::check_errors("reading uniforms");
}

TEST_CASE("shaders: the hemicube's programs have the vertex inputs of a DrawVertex and of a PolygonVertex",
          "[gl][engine]") {
    const auto context = gl::make_context("osmesa");
    const std::string clipped = gl::with_definition(gl::shaders::hemicube_frag, "CLIPPED");
    const std::string bilinear = gl::with_definition(clipped, "BILINEAR");
    const Locations clipped_inputs{{"position", 0}, {"grid_position", 1}, {"twist", 2}, {"cells", 3}};
    for (const std::string& fragment : {clipped, bilinear}) {
        const gl::Program program =
            gl::make_program("hemicube", gl::shaders::hemicube_clipped_vert, fragment.c_str());
        CHECK(locations(program, GL_UNIFORM).empty());
        if (fragment == bilinear) {
            CHECK(locations(program, GL_PROGRAM_INPUT) == clipped_inputs);
        }
    }
    const Locations inputs{{"high", 0}, {"low", 1}, {"polygon", 2}};
    const std::string plain = gl::shaders::hemicube_frag;
    for (const std::string& fragment : {plain, gl::with_definition(plain, "COUNT_COVERED")}) {
        const gl::Program program =
            gl::make_program("hemicube", gl::shaders::hemicube_vert, fragment.c_str());
        CHECK(locations(program, GL_PROGRAM_INPUT) == inputs);
    }
    gl::check_errors("reading inputs");
}
