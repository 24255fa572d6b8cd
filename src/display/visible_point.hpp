#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <optional>

namespace hemi {

/// Nearest point in front of `origin` along `direction` where the picture shows a surface: on the front of a
/// surface, or on either side of a two-sided one. Looks at every surface; no acceleration.
[[nodiscard]] std::optional<Vec3> visible_point(const PatchMesh& mesh, const Vec3& origin,
                                                const Vec3& direction);

} // namespace hemi
