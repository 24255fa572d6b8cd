#pragma once

#include "hemi/display/picture.hpp"

#include <string>

namespace hemi::viewer {

/// The options of `hemi render` for a picture and a camera, each with a blank before it. The numbers read
/// back to the same bits.
[[nodiscard]] std::string picture_options(const PictureSettings& settings, const Camera& camera);

/// A word as a shell takes it: in quotes where it needs them.
[[nodiscard]] std::string quoted(const std::string& word);

} // namespace hemi::viewer
