#pragma once

#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include <optional>

namespace hemi::cli {

/// A camera inside a room, where the scene is one: where fronts close a place in on nearly all sides. It
/// stands at a little more than half the height, where the view is long, and looks along it. Up is z.
[[nodiscard]] std::optional<Camera> interior_camera(const PatchMesh& mesh);

} // namespace hemi::cli
