#include "gl/context.hpp"

#include "gl/contexts.hpp"
#include "gl/objects.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

namespace hemi::gl {

namespace {

std::string string_of(GLenum name) {
    const auto* text = reinterpret_cast<const char*>(glGetString(name));
    return text != nullptr ? text : "";
}

bool is_software(std::string_view renderer) {
    static constexpr std::array<std::string_view, 5> names{"llvmpipe", "softpipe", "swrast", "Software",
                                                           "SwiftShader"};
    for (const std::string_view name : names) {
        if (renderer.find(name) != std::string_view::npos) {
            return true;
        }
    }
    return false;
}

const char* error_name(GLenum error) {
    switch (error) {
    case GL_INVALID_ENUM:
        return "invalid enum";
    case GL_INVALID_VALUE:
        return "invalid value";
    case GL_INVALID_OPERATION:
        return "invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
        return "invalid framebuffer operation";
    case GL_OUT_OF_MEMORY:
        return "out of memory";
    default:
        return "unknown error";
    }
}

const char* loaded_backend = "";

/// Called from within the driver, which is C: it records and throws nothing; running out of memory ends the
/// program. What the shader compiler says is left out, since make_program() reports that itself.
void GLAD_API_PTR record_error(GLenum source, GLenum type, GLuint, GLenum severity, GLsizei,
                               const GLchar* message, const void* recorded) noexcept {
    const bool is_error = type == GL_DEBUG_TYPE_ERROR || severity == GL_DEBUG_SEVERITY_HIGH;
    auto& first = *static_cast<std::string*>(const_cast<void*>(recorded));
    if (is_error && source != GL_DEBUG_SOURCE_SHADER_COMPILER && first.empty()) {
        first = message;
    }
}

/// What the current context has recorded, which it forgets; empty where it records nothing.
std::string take_recorded() {
    void* callback = nullptr;
    void* recorded = nullptr;
    glGetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &callback);
    glGetPointerv(GL_DEBUG_CALLBACK_USER_PARAM, &recorded);
    const bool ours = callback == reinterpret_cast<void*>(record_error);
    return ours ? std::exchange(*static_cast<std::string*>(recorded), {}) : std::string();
}

std::unique_ptr<Context> first_working_egl(std::vector<std::string>& problems, bool hardware_only) {
    const std::size_t count = egl_device_count();
    for (std::size_t i = 0; i < count; ++i) {
        if (hardware_only && egl_device_is_software(i)) {
            continue;
        }
        try {
            auto context = make_egl_context(i);
            if (!hardware_only || !context->software()) {
                return context;
            }
        } catch (const GlError& error) {
            problems.emplace_back(error.what());
        }
    }
    return nullptr;
}

/// N of "egl:N", if it is that.
std::optional<std::size_t> egl_number(std::string_view device) {
    if (!device.starts_with("egl:")) {
        return std::nullopt;
    }
    const std::string_view digits = device.substr(4);
    if (digits.empty() || digits.size() > 4 ||
        digits.find_first_not_of("0123456789") != std::string_view::npos) {
        return std::nullopt;
    }
    return static_cast<std::size_t>(std::stoul(std::string(digits)));
}

} // namespace

void Context::describe(std::string name) {
    GLint major = 0;
    GLint minor = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    if (major * 10 + minor < 45) {
        throw NoDevice(fmt::format("{}: OpenGL {}.{}; hemi needs 4.5", name, major, minor));
    }
    name_ = std::move(name);
    renderer_ = string_of(GL_RENDERER);
    version_ = string_of(GL_VERSION);
    software_ = is_software(renderer_);
    if (debug_wanted()) {
        record_errors();
    }
}

void Context::record_errors() {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(record_error, &recorded_);
}

bool debug_wanted() {
    const char* value = std::getenv("HEMI_GL_DEBUG");
    return value != nullptr && std::string_view(value) != "0";
}

void check_device_name(const std::string& device) {
    if (device != "auto" && device != "egl" && device != "osmesa" && !egl_number(device)) {
        throw InvalidArgument(fmt::format("device \"{}\"; must be auto, egl, egl:N or osmesa", device));
    }
}

bool is_surely_software(const std::string& device) {
    if (const auto number = egl_number(device)) {
        return egl_device_is_software(*number);
    }
    const std::size_t count = egl_device_count();
    for (std::size_t i = 0; i < count && device != "osmesa"; ++i) {
        if (!egl_device_is_software(i)) {
            return false;
        }
    }
    return true;
}

std::unique_ptr<Context> make_context(const std::string& device) {
    check_device_name(device);
    if (device == "osmesa") {
        return make_osmesa_context();
    }
    if (device == "auto" || device == "egl") {
        std::vector<std::string> problems;
        if (auto context = first_working_egl(problems, device == "auto")) {
            return context;
        }
        if (device == "auto") {
            return make_osmesa_context();
        }
        throw NoDevice(problems.empty() ? std::string("egl: no EGL device is there")
                                        : fmt::format("egl: {}", fmt::join(problems, "; ")));
    }
    return make_egl_context(*egl_number(device));
}

std::optional<std::string> find_gpu() {
    static const std::optional<std::string> found = []() -> std::optional<std::string> {
        std::vector<std::string> ignored;
        const auto context = first_working_egl(ignored, true);
        return context ? std::optional(context->name()) : std::nullopt;
    }();
    return found;
}

std::vector<std::string> device_names() {
    std::vector<std::string> names;
    const std::size_t count = egl_device_count();
    for (std::size_t i = 0; i < count; ++i) {
        names.push_back(fmt::format("egl:{}", i));
    }
    names.emplace_back("osmesa");
    return names;
}

bool functions_loaded_for(const char* backend) noexcept {
    return std::strcmp(loaded_backend, backend) == 0;
}

void load_functions(const char* backend, void (*(*loader)(const char*))()) {
    if (functions_loaded_for(backend)) {
        return;
    }
    if (gladLoadGL(loader) == 0) {
        throw GlError(fmt::format("{}: the OpenGL functions cannot be loaded", backend));
    }
    loaded_backend = backend;
}

void check_errors(const char* where) {
    const GLenum error = glGetError();
    const std::string recorded = take_recorded();
    if (error == GL_NO_ERROR && recorded.empty()) {
        return;
    }
    const std::string code =
        error == GL_NO_ERROR ? "a problem" : fmt::format("{} (0x{:04x})", error_name(error), error);
    throw GlError(
        fmt::format("{}: OpenGL reports {}{}{}", where, code, recorded.empty() ? "" : ": ", recorded));
}

const char* loader_version() noexcept {
    return "glad " GLAD_GENERATOR_VERSION;
}

} // namespace hemi::gl
