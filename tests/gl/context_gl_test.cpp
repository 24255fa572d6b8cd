#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

using namespace hemi;
using Catch::Matchers::Contains;

namespace {

/// Devices to test with: OSMesa is always there, an EGL device may be missing.
std::vector<std::string> devices() {
    const auto names = gl::device_names();
    const bool egl = std::find(names.begin(), names.end(), "egl:0") != names.end();
    return egl ? std::vector<std::string>{"osmesa", "egl:0"} : std::vector<std::string>{"osmesa"};
}

/// Whether the current context can draw: it clears a pixel and reads it back.
bool draws() {
    const gl::Texture2D texture;
    glTextureStorage2D(texture.get(), 1, GL_R32UI, 1, 1);
    const gl::Framebuffer framebuffer;
    glNamedFramebufferTexture(framebuffer.get(), GL_COLOR_ATTACHMENT0, texture.get(), 0);
    const GLuint written[4]{0xFEDCBA98U, 0, 0, 0};
    glClearNamedFramebufferuiv(framebuffer.get(), GL_COLOR, 0, written);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer.get());
    GLuint read = 0;
    glReadPixels(0, 0, 1, 1, GL_RED_INTEGER, GL_UNSIGNED_INT, &read);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    gl::check_errors("drawing a pixel");
    return read == written[0];
}

/// Message of the GlError that the next check throws; empty if it throws none.
std::string checked() {
    try {
        gl::check_errors("test");
    } catch (const GlError& error) {
        return error.what();
    }
    return "";
}

/// Sets an environment variable, and puts it back at the end.
class Environment {
public:
    Environment(const char* name, const char* value) : name_(name) {
        const char* before = std::getenv(name);
        before_ = before != nullptr ? before : "";
        setenv(name, value, 1);
    }
    ~Environment() { setenv(name_, before_.c_str(), 1); }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

private:
    const char* name_;
    std::string before_;
};

} // namespace

TEST_CASE("Context: a device name that is none is refused", "[gl]") {
    for (const char* name :
         {"", "gpu", "EGL", "egl:", "egl:x", "egl:-1", "egl:1x", "egl:12345", "osmesa:0"}) {
        INFO(name);
        CHECK_THROWS_AS(gl::make_context(name), InvalidArgument);
        CHECK_THROWS_WITH(gl::make_context(name), Contains("must be auto, egl, egl:N or osmesa"));
    }
    for (const char* name : {"auto", "egl", "egl:0", "egl:9999", "osmesa"}) {
        CHECK_NOTHROW(gl::check_device_name(name));
    }
}

TEST_CASE("Context: a device that is not there is named, and nothing replaces it", "[gl]") {
    CHECK_THROWS_AS(gl::make_context("egl:9999"), NoDevice);
    CHECK_THROWS_WITH(gl::make_context("egl:9999"), Contains("egl:9999: there is no such device"));
}

TEST_CASE("Context: OSMesa is always there, on the CPU, and the last of the devices", "[gl]") {
    CHECK(gl::device_names().back() == "osmesa");
    CHECK(gl::is_surely_software("osmesa"));
    const auto context = gl::make_context("osmesa");
    CHECK(context->name() == "osmesa");
    CHECK(context->software());
    CHECK_FALSE(context->renderer().empty());
    CHECK_FALSE(context->version().empty());
    CHECK(draws());
}

TEST_CASE("Context: two one after the other draw, on the same device and on another", "[gl]") {
    for (const std::string& first : devices()) {
        for (const std::string& second : devices()) {
            INFO(first << ", then " << second);
            {
                const auto context = gl::make_context(first);
                CHECK(context->name() == first);
                CHECK(draws());
            }
            const auto context = gl::make_context(second);
            CHECK(context->name() == second);
            CHECK(draws());
        }
    }
}

TEST_CASE("Context: of two at a time the one that is made current is drawn with", "[gl]") {
    for (const std::string& one : devices()) {
        for (const std::string& other : devices()) {
            INFO(one << " and " << other);
            const auto first = gl::make_context(one);
            glEnable(GL_CULL_FACE); // a mark
            const auto second = gl::make_context(other);
            CHECK(glIsEnabled(GL_CULL_FACE) == GL_FALSE);
            CHECK(draws());
            first->make_current();
            CHECK(glIsEnabled(GL_CULL_FACE) == GL_TRUE);
            CHECK(draws());
            second->make_current();
            CHECK(glIsEnabled(GL_CULL_FACE) == GL_FALSE);
            CHECK(draws());
        }
    }
}

TEST_CASE("Context: debug contexts are on in the tests", "[gl]") {
    CHECK(gl::debug_wanted());
    const Environment off("HEMI_GL_DEBUG", "0");
    CHECK_FALSE(gl::debug_wanted());
}

TEST_CASE("Context: an error is recorded, and the next check throws it with the driver's words, once",
          "[gl]") {
    for (const std::string& device : devices()) {
        INFO(device);
        const auto context = gl::make_context(device);
        CHECK(checked().empty());
        glBindTexture(GL_TRIANGLES, 0);
        glViewport(0, 0, -1, 1); // what went wrong first is what is reported
        CHECK_THAT(checked(),
                   Contains("test: OpenGL reports invalid enum (0x0500): ") && Contains("glBindTexture"));
        CHECK(checked().empty());
        glViewport(0, 0, -1, 1);
        CHECK_THAT(checked(), Contains("invalid value (0x0501): ") && Contains("glViewport"));
        CHECK(checked().empty());
    }
}

TEST_CASE("Context: an error that was recorded is not lost when others ask OpenGL for it first", "[gl]") {
    const auto context = gl::make_context("osmesa");
    glViewport(0, 0, -1, 1);
    REQUIRE(glGetError() == GL_INVALID_VALUE);
    CHECK_THAT(checked(), Contains("glViewport"));
}

TEST_CASE("Context: only errors and grave messages are recorded", "[gl]") {
    const auto context = gl::make_context("osmesa");
    const auto say = [](GLenum type, GLenum severity) {
        glDebugMessageInsert(GL_DEBUG_SOURCE_APPLICATION, type, 1, severity, -1, "said by the test");
        return checked();
    };
    CHECK(say(GL_DEBUG_TYPE_PERFORMANCE, GL_DEBUG_SEVERITY_MEDIUM).empty());
    CHECK(say(GL_DEBUG_TYPE_OTHER, GL_DEBUG_SEVERITY_NOTIFICATION).empty());
    CHECK(say(GL_DEBUG_TYPE_DEPRECATED_BEHAVIOR, GL_DEBUG_SEVERITY_MEDIUM).empty());
    CHECK_THAT(say(GL_DEBUG_TYPE_ERROR, GL_DEBUG_SEVERITY_MEDIUM), Contains("said by the test"));
    CHECK_THAT(say(GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR, GL_DEBUG_SEVERITY_HIGH), Contains("said by the test"));
}

TEST_CASE("Context: what one records, a check of another does not throw", "[gl]") {
    const auto first = gl::make_context("osmesa");
    glViewport(0, 0, -1, 1);
    const auto second = gl::make_context("osmesa");
    CHECK(checked().empty());
    first->make_current();
    CHECK_THAT(checked(), Contains("glViewport"));
}

TEST_CASE("Context: without debugging a check still throws an error, by its code", "[gl]") {
    const Environment off("HEMI_GL_DEBUG", "0");
    for (const std::string& device : devices()) {
        INFO(device);
        const auto context = gl::make_context(device);
        glViewport(0, 0, -1, 1);
        CHECK(checked() == "test: OpenGL reports invalid value (0x0501)");
        CHECK(checked().empty());
    }
}
