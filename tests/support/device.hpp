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

} // namespace hemi::test
