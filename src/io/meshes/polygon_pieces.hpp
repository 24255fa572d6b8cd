#pragma once

#include "hemi/core/geometry.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// A triangle or quadrilateral cut from a larger polygon; `count` is 3 or 4.
struct PolygonPiece {
    std::array<Vec3, 4> points{};
    std::uint32_t count = 4;
};

/// Whether a polygon has no area to speak of: fewer than three different corners, or all in a line.
[[nodiscard]] bool has_no_area(std::span<const Vec3> polygon);

/// What keeps a polygon of any number of corners from being planar and convex, or nothing.
[[nodiscard]] std::optional<std::string> many_corners_defect(std::span<const Vec3> polygon);

/// Cuts a planar convex polygon of five or more corners into strips that begin at the edge from its last to
/// its first corner: quadrilaterals, and a triangle at the end if the count is odd. Same orientation; pieces
/// without area are left out.
/// @param pieces  the pieces are added at its end.
void cut_into_pieces(std::span<const Vec3> polygon, std::vector<PolygonPiece>& pieces);

} // namespace hemi::io
