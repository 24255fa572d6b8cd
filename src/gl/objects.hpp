#pragma once

#include <glad/gl.h>

#include <string>
#include <string_view>
#include <utility>

namespace hemi::gl {

/// Owner of one OpenGL object name; move-only. Traits: static GLuint create(); static void destroy(GLuint).
template <typename Traits>
class UniqueObject {
public:
    UniqueObject() : name_(Traits::create()) {}
    UniqueObject(UniqueObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    UniqueObject& operator=(UniqueObject&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    ~UniqueObject() {
        if (name_ != 0) {
            Traits::destroy(name_);
        }
    }
    UniqueObject(const UniqueObject&) = delete;
    UniqueObject& operator=(const UniqueObject&) = delete;

    [[nodiscard]] GLuint get() const noexcept { return name_; }

private:
    GLuint name_;
};

struct BufferTraits {
    static GLuint create() {
        GLuint name = 0;
        glCreateBuffers(1, &name);
        return name;
    }
    static void destroy(GLuint name) { glDeleteBuffers(1, &name); }
};
struct Texture2DTraits {
    static GLuint create() {
        GLuint name = 0;
        glCreateTextures(GL_TEXTURE_2D, 1, &name);
        return name;
    }
    static void destroy(GLuint name) { glDeleteTextures(1, &name); }
};
struct FramebufferTraits {
    static GLuint create() {
        GLuint name = 0;
        glCreateFramebuffers(1, &name);
        return name;
    }
    static void destroy(GLuint name) { glDeleteFramebuffers(1, &name); }
};
struct VertexArrayTraits {
    static GLuint create() {
        GLuint name = 0;
        glCreateVertexArrays(1, &name);
        return name;
    }
    static void destroy(GLuint name) { glDeleteVertexArrays(1, &name); }
};
struct ProgramTraits {
    static GLuint create() { return glCreateProgram(); }
    static void destroy(GLuint name) { glDeleteProgram(name); }
};

using Buffer = UniqueObject<BufferTraits>;
using Texture2D = UniqueObject<Texture2DTraits>;
using Framebuffer = UniqueObject<FramebufferTraits>;
using VertexArray = UniqueObject<VertexArrayTraits>;
using Program = UniqueObject<ProgramTraits>;

/// Compiles and links a vertex and a fragment shader. @throws GlError with the driver's log.
[[nodiscard]] Program make_program(std::string_view label, const char* vertex_source,
                                   const char* fragment_source);

/// A shader's source with a preprocessor name defined, after its first line, the version.
[[nodiscard]] std::string with_definition(std::string_view source, std::string_view name);

/// Names an object for debuggers. `kind` as glObjectLabel: GL_BUFFER, GL_TEXTURE, GL_FRAMEBUFFER …
void label(GLenum kind, GLuint name, std::string_view text);

} // namespace hemi::gl
