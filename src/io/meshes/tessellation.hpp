#pragma once

#include "io/meshes/polygon_pieces.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// Cuts a polygon, convex or not, with holes or without, into triangles, and joins those two at a time to
/// quadrilaterals that are planar and convex; same orientation as the outline. Where the polygon is not
/// plane, it is cut as it is seen along its normal.
/// @param holes  in either orientation; they may touch the outline and each other
/// @param pieces  the pieces are added at its end; those without area are left out
/// @return what is wrong: an outline that crosses itself, a hole that is not in it
[[nodiscard]] std::optional<std::string> tessellate(std::span<const Vec3> outline,
                                                    std::span<const std::vector<Vec3>> holes,
                                                    std::vector<PolygonPiece>& pieces);

} // namespace hemi::io
