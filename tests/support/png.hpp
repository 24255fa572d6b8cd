#pragma once

#include "support/picture_difference.hpp"

#include <string>

namespace hemi::test {

/// @throws std::runtime_error where there is no PNG
[[nodiscard]] SrgbPicture read_png(const std::string& path);

} // namespace hemi::test
