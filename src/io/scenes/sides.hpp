#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/io/scene_reader.hpp"

#include <string>

namespace hemi::io {

/// Makes surfaces one-sided and two-sided and turns them, in this order, as the options say.
/// @throws InvalidArgument for an unknown group, with the nearest; for one that is to be both.
void set_sides(Scene& scene, const SceneReaderOptions& options, const std::string& file,
               Diagnostics& diagnostics);

} // namespace hemi::io
