#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <optional>
#include <type_traits>

using namespace hemi;

namespace {

/// A kind of object, and OpenGL's own question whether a name is one of those.
template <typename ObjectType, GLboolean (*const* is_function)(GLuint)>
struct Kind {
    using Object = ObjectType;
    static bool exists(GLuint name) { return (*is_function)(name) == GL_TRUE; }
};
using BufferKind = Kind<gl::Buffer, &glad_glIsBuffer>;
using TextureKind = Kind<gl::Texture2D, &glad_glIsTexture>;
using FramebufferKind = Kind<gl::Framebuffer, &glad_glIsFramebuffer>;
using VertexArrayKind = Kind<gl::VertexArray, &glad_glIsVertexArray>;
using ProgramKind = Kind<gl::Program, &glad_glIsProgram>;

} // namespace

TEMPLATE_TEST_CASE("UniqueObject: an object lives as long as its owner", "[gl]", BufferKind, TextureKind,
                   FramebufferKind, VertexArrayKind, ProgramKind) {
    const auto context = gl::make_context("osmesa");
    GLuint name = 0;
    {
        const typename TestType::Object object;
        name = object.get();
        CHECK(name != 0);
        CHECK(TestType::exists(name));
    }
    CHECK_FALSE(TestType::exists(name));
    gl::check_errors("owning an object");
}

TEMPLATE_TEST_CASE("UniqueObject: moving hands the object on", "[gl]", BufferKind, TextureKind,
                   FramebufferKind, VertexArrayKind, ProgramKind) {
    using Object = typename TestType::Object;
    static_assert(std::is_nothrow_move_constructible_v<Object> && std::is_nothrow_move_assignable_v<Object>);
    static_assert(!std::is_copy_constructible_v<Object> && !std::is_copy_assignable_v<Object>);
    const auto context = gl::make_context("osmesa");

    std::optional<Object> first(std::in_place);
    const GLuint name = first->get();
    std::optional<Object> second(std::move(*first));
    CHECK(second->get() == name);
    first.reset();
    CHECK(TestType::exists(name));

    std::optional<Object> third(std::in_place);
    const GLuint replaced = third->get();
    CHECK(replaced != name);
    *third = std::move(*second);
    CHECK(third->get() == name);
    second.reset(); // by now the replaced object is gone, whichever of the two took it
    CHECK_FALSE(TestType::exists(replaced));
    CHECK(TestType::exists(name));

    Object& same = *third;
    *third = std::move(same);
    CHECK(third->get() == name);
    CHECK(TestType::exists(name));
    third.reset();
    CHECK_FALSE(TestType::exists(name));
    gl::check_errors("moving an object");
}

TEST_CASE("gl::label: an object's label can be read back", "[gl]") {
    const auto context = gl::make_context("osmesa");
    const gl::Buffer buffer;
    gl::label(GL_BUFFER, buffer.get(), std::string_view("vertices of a cube").substr(0, 8));
    std::string label(64, '?');
    GLsizei length = 0;
    glGetObjectLabel(GL_BUFFER, buffer.get(), static_cast<GLsizei>(label.size()), &length, label.data());
    CHECK(label.substr(0, static_cast<std::size_t>(length)) == "vertices");
    gl::check_errors("labelling an object");
}
