#pragma once

#include <fmt/format.h>

#include <string>

namespace hemi::test {

/// How a shell command begins that is to have a display of its own.
/// @param authority  file for the display's key, new: named, because xvfb-run ends with status 5 now and then
///   where it has to remove a folder of its own, and leaves the display running
inline std::string virtual_display(const std::string& authority, const std::string& screen = "1280x1024x24") {
    return fmt::format("xvfb-run -a -f '{}' -s '-screen 0 {}'", authority, screen);
}

} // namespace hemi::test
