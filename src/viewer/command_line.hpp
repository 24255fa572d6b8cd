#pragma once

#include "hemi/display/picture.hpp"
#include "viewer/look.hpp"

#include <span>
#include <string>

namespace hemi::viewer {

/// The options of `hemi render` for a picture and a camera, each with a blank before it. The numbers read
/// back to the same bits.
/// @param lit  whether light is drawn, and not false colours
[[nodiscard]] std::string picture_options(const PictureSettings& settings, const Camera& camera, bool lit,
                                          std::span<const std::string> groups);
/// Those for a quantity and its colours.
/// @param drawn  as the window draws it
[[nodiscard]] std::string quantity_options(const Look& look, const FalseColours& drawn);

/// A word as a shell takes it: in quotes where it needs them.
[[nodiscard]] std::string quoted(const std::string& word);

} // namespace hemi::viewer
