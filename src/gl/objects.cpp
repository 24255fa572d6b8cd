#include "gl/objects.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

namespace hemi::gl {

namespace {

GLuint compile(std::string_view label, GLenum stage, const char* source) {
    const GLuint shader = glCreateShader(stage);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled != GL_TRUE) {
        std::string log(4096, '\0');
        GLsizei length = 0;
        glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
        log.resize(static_cast<std::size_t>(length));
        glDeleteShader(shader);
        throw GlError(fmt::format("{}: {} shader does not compile: {}", label,
                                  stage == GL_VERTEX_SHADER ? "vertex" : "fragment", log));
    }
    return shader;
}

} // namespace

Program make_program(std::string_view label_text, const char* vertex_source, const char* fragment_source) {
    Program program;
    for (const auto& [stage, source] :
         {std::pair{static_cast<GLenum>(GL_VERTEX_SHADER), vertex_source},
          std::pair{static_cast<GLenum>(GL_FRAGMENT_SHADER), fragment_source}}) {
        const GLuint shader = compile(label_text, stage, source);
        glAttachShader(program.get(), shader);
        glDeleteShader(shader); // goes with the program
    }
    glLinkProgram(program.get());
    GLint linked = GL_FALSE;
    glGetProgramiv(program.get(), GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) {
        std::string log(4096, '\0');
        GLsizei length = 0;
        glGetProgramInfoLog(program.get(), static_cast<GLsizei>(log.size()), &length, log.data());
        log.resize(static_cast<std::size_t>(length));
        throw GlError(fmt::format("{}: program does not link: {}", label_text, log));
    }
    label(GL_PROGRAM, program.get(), label_text);
    return program;
}

std::string with_definition(std::string_view source, std::string_view name) {
    const std::size_t version = source.find('\n') + 1;
    return fmt::format("{}#define {}\n{}", source.substr(0, version), name, source.substr(version));
}

void label(GLenum kind, GLuint name, std::string_view text) {
    glObjectLabel(kind, name, static_cast<GLsizei>(text.size()), text.data());
}

} // namespace hemi::gl
