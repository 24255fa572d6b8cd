#pragma once

#include <cstdlib>
#include <string>

namespace hemi::test {

/// The device that tests tagged [every-device] compute rows on: OSMesa; ctest runs them again on software
/// EGL, on OSMesa that transforms polygons as a GPU does and on the CPU rasteriser, which the environment
/// variable HEMI_TEST_DEVICE names ("egl", "gpu-transform", "cpu").
[[nodiscard]] inline std::string test_device() {
    const char* const wanted = std::getenv("HEMI_TEST_DEVICE");
    const std::string device = wanted != nullptr ? wanted : "osmesa";
    if (device == "gpu-transform") {
        setenv("HEMI_TRANSFORM", "gpu", 1);
        return "osmesa";
    }
    return device;
}

/// Sets an environment variable until it goes out of scope.
class WithVariable {
public:
    WithVariable(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
    ~WithVariable() { unsetenv(name_); }
    WithVariable(const WithVariable&) = delete;
    WithVariable& operator=(const WithVariable&) = delete;

private:
    const char* name_;
};

/// Has OpenGL transform polygons on the CPU ("cpu") or the GPU ("gpu") whatever the device.
class WithTransform : WithVariable {
public:
    explicit WithTransform(const char* where) : WithVariable("HEMI_TRANSFORM", where) {}
};

} // namespace hemi::test
