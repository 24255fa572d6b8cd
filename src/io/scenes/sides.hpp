#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/io/scene_reader.hpp"

#include <string>
#include <vector>

namespace hemi::io {

/// Makes surfaces one-sided and two-sided and turns them, in this order, as the options say.
/// @param exported  for every group, whether what the file says of sides may be an exporter's habit: closed
///   bodies of those become one-sided, unless the options make them two-sided; empty: of none
/// @throws InvalidArgument for an unknown group, with the nearest; for one that is to be both.
void set_sides(Scene& scene, const SceneReaderOptions& options, const std::string& file,
               Diagnostics& diagnostics, std::vector<bool> exported = {});

} // namespace hemi::io
