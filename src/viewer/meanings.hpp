#pragma once

#include "viewer/look.hpp"

namespace hemi::viewer {

/// What is shown there: in words, with its symbol and its unit.
[[nodiscard]] const char* meaning_of(const Shown& shown);

} // namespace hemi::viewer
