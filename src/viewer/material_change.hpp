#pragma once

#include "viewer/panels.hpp"
#include "viewer/script.hpp"

namespace hemi::viewer {

/// Puts a script's values into the materials that are chosen.
/// @throws InvalidArgument where there is no such material, no form factors, or another number of channels
void apply_set(const SetCommand& set, const ViewerInput& input, Choices& choices);

} // namespace hemi::viewer
