#include "gl/contexts.hpp"

#include "hemi/core/error.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <vector>

namespace hemi::gl {

namespace {

template <typename Function>
Function egl_function(const char* name) {
    return reinterpret_cast<Function>(eglGetProcAddress(name));
}

std::vector<EGLDeviceEXT> egl_devices() {
    const auto query = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    EGLint count = 0;
    if (query == nullptr || query(0, nullptr, &count) == EGL_FALSE || count <= 0) {
        return {};
    }
    std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
    if (query(count, devices.data(), &count) == EGL_FALSE) {
        return {};
    }
    devices.resize(static_cast<std::size_t>(count));
    return devices;
}

/// A context without any surface, on the platform of one device.
class EglContext final : public Context {
public:
    explicit EglContext(std::size_t index) : device_name_(fmt::format("egl:{}", index)) {
        const std::vector<EGLDeviceEXT> devices = egl_devices();
        if (index >= devices.size()) {
            throw NoDevice(fmt::format("{}: there is no such device; EGL devices here: {}", device_name_,
                                       devices.size()));
        }
        const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
        require(get_display != nullptr, "eglGetPlatformDisplayEXT");
        display_ = get_display(EGL_PLATFORM_DEVICE_EXT, devices[index], nullptr);
        require(display_ != EGL_NO_DISPLAY, "eglGetPlatformDisplayEXT");
        require(eglInitialize(display_, nullptr, nullptr) == EGL_TRUE, "eglInitialize");
        require(eglBindAPI(EGL_OPENGL_API) == EGL_TRUE, "eglBindAPI");
        const std::array<EGLint, 3> config_attributes{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint configs = 0;
        // A device platform may offer no config with a surface type; none is needed.
        std::array<EGLint, 5> any_surface{EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
        if (eglChooseConfig(display_, any_surface.data(), &config, 1, &configs) == EGL_FALSE ||
            configs == 0) {
            require(eglChooseConfig(display_, config_attributes.data(), &config, 1, &configs) == EGL_TRUE &&
                        configs > 0,
                    "eglChooseConfig");
        }
        const std::array<EGLint, 9> context_attributes{EGL_CONTEXT_MAJOR_VERSION,
                                                       4,
                                                       EGL_CONTEXT_MINOR_VERSION,
                                                       5,
                                                       EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                       EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                       debug_wanted() ? EGL_CONTEXT_OPENGL_DEBUG : EGL_NONE,
                                                       EGL_TRUE,
                                                       EGL_NONE};
        context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, context_attributes.data());
        require(context_ != EGL_NO_CONTEXT, "eglCreateContext (OpenGL 4.5 core)");
        try {
            EglContext::make_current();
            describe(device_name_);
        } catch (...) {
            release();
            throw;
        }
    }

    ~EglContext() override { release(); }

    void make_current() override {
        // The client API is per thread, and another library may have changed it.
        eglBindAPI(EGL_OPENGL_API);
        if (!functions_loaded_for("egl")) {
            // Where OSMesa has made its context current, Mesa's EGL still takes its own last one for current,
            // and would do nothing.
            eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        }
        if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE) {
            throw NoDevice(fmt::format("{}: eglMakeCurrent failed (0x{:04x})", device_name_, eglGetError()));
        }
        load_functions("egl", eglGetProcAddress);
    }

private:
    void require(bool condition, const char* what) {
        if (!condition) {
            const EGLint error = eglGetError();
            release();
            throw NoDevice(fmt::format("{}: {} failed (0x{:04x})", device_name_, what, error));
        }
    }

    // The display stays initialised: it is shared by all contexts of the device in this process.
    void release() noexcept {
        if (context_ != EGL_NO_CONTEXT) {
            eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
            eglDestroyContext(display_, context_);
            context_ = EGL_NO_CONTEXT;
        }
    }

    std::string device_name_;
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
};

} // namespace

std::size_t egl_device_count() {
    return egl_devices().size();
}

bool egl_device_is_software(std::size_t device) {
    const auto query = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
    const std::vector<EGLDeviceEXT> devices = egl_devices();
    if (query == nullptr || device >= devices.size()) {
        return false;
    }
    const char* extensions = query(devices[device], EGL_EXTENSIONS);
    return extensions != nullptr && std::strstr(extensions, "EGL_MESA_device_software") != nullptr;
}

std::unique_ptr<Context> make_egl_context(std::size_t device) {
    return std::make_unique<EglContext>(device);
}

} // namespace hemi::gl
