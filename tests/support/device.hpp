#pragma once

#include <cstdlib>
#include <string>

namespace hemi::test {

/// The device that tests tagged [every-device] compute rows on: OSMesa; ctest runs them again on software EGL
/// and on the CPU rasteriser, which the environment variable HEMI_TEST_DEVICE names.
[[nodiscard]] inline std::string test_device() {
    const char* const device = std::getenv("HEMI_TEST_DEVICE");
    return device != nullptr ? device : "osmesa";
}

/// Has OpenGL transform polygons on the CPU ("cpu") or the GPU ("gpu") whatever the device, until it goes out
/// of scope.
class WithTransform {
public:
    explicit WithTransform(const char* where) { setenv("HEMI_TRANSFORM", where, 1); }
    ~WithTransform() { unsetenv("HEMI_TRANSFORM"); }
    WithTransform(const WithTransform&) = delete;
    WithTransform& operator=(const WithTransform&) = delete;
};

} // namespace hemi::test
