#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <span>

namespace hemi::io {

/// @throws InvalidArgument for radiosities of another length than 12 a patch, values that are not finite, a
///   negative exposure.
void check_baked(const PatchMesh& mesh, std::span<const float> radiosity, double exposure);

} // namespace hemi::io
