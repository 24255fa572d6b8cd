#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace hemi {

/// Item ids in a buffer: 0 where nothing was drawn, 1 for a back face, patches from 2.
inline constexpr std::uint32_t item_nothing = 0;
inline constexpr std::uint32_t item_blocked = 1;
inline constexpr std::uint32_t item_first_patch = 2;

/// Corner of a drawn outline.
struct OutlineCorner {
    std::uint32_t vertex; ///< into DrawList::vertices
    float grid_u;         ///< where it lies on the polygon's grid (quads: in the frame of corners 0, 1, 3)
    float grid_v;
};

/// A polygon as it is drawn: one surface, or a lattice of coplanar ones merged. Trivially copyable.
struct DrawPolygon {
    Vec3 normal{0.0}; ///< unit, of the front
    Vec3 centre{0.0}; ///< with `radius`: a sphere round the polygon
    double radius = 0.0;
    std::uint32_t first_corner = 0; ///< outline, counter-clockwise seen from the front
    std::uint32_t corner_count = 0;
    std::uint32_t first_triangle = 0;
    std::uint32_t triangle_count = 0;
    Grid grid;                  ///< cells along the two directions
    std::uint32_t split = 0;    ///< 1: every cell is two triangles, cut from (1, 0) to (0, 1)
    std::uint32_t bilinear = 0; ///< 1: a quadrilateral that is no parallelogram
    float twist_u = 0.0f;       ///< its corner 2 in the frame of corners 0, 1, 3, less (1, 1)
    float twist_v = 0.0f;
    std::uint32_t front_id = 0;           ///< draw id of its first cell, seen from the front
    std::uint32_t back_id = item_blocked; ///< and from the back
};

/// What the item buffers are drawn from: polygons with welded vertices and outlines without T-junctions, and
/// what every draw id stands for.
struct DrawList {
    std::vector<Vec3> vertices;
    std::vector<DrawPolygon> polygons;
    std::vector<OutlineCorner> corners;
    std::vector<std::array<std::uint32_t, 3>> triangles; ///< positions in their polygon's outline
    std::vector<std::uint32_t> item_of_id; ///< draw id -> item (nothing, blocked, item_first_patch + patch)
    std::vector<std::uint32_t> polygon_of_surface;
    double tolerance = 0.0; ///< lengths below are rounding: scene units
};

/// @throws InvalidArgument if a surface is cut more than 65,535 ways along an edge.
[[nodiscard]] DrawList make_draw_list(const PatchMesh& mesh, bool merge_lattices);

} // namespace hemi
