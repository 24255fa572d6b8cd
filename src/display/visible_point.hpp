#pragma once

#include "hemi/display/picture_cut.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <optional>

namespace hemi {

/// A point that a picture shows.
struct VisiblePoint {
    Vec3 position;
    std::uint32_t surface;
    bool back; ///< of a two-sided surface
};
/// Nearest point in front of `origin` along `direction` where the picture shows a surface: on the front of a
/// surface, or on either side of a two-sided one; with `backs` on either side of any; not on what is cut.
/// Looks at every surface; no acceleration.
[[nodiscard]] std::optional<VisiblePoint> visible_point(const PatchMesh& mesh, const Vec3& origin,
                                                        const Vec3& direction, bool backs = false,
                                                        const PictureCut& cut = {});
/// The patch that the point lies on; of those that meet there, the first. Looks at every patch of the
/// surface.
[[nodiscard]] std::uint32_t patch_at(const PatchMesh& mesh, const VisiblePoint& point);

} // namespace hemi
