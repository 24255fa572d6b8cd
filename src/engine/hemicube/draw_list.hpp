#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace hemi {

// Items, draw ids and cells: the definition that the hemicube shaders, the item buffers, the accumulators
// and the workers share.
//
// An item is what a texel of a hemicube shows:
//   0      nothing was drawn there: the environment
//   1      a back face that has no patches: it occludes, and no patch receives what hits it
//   2 + i  patch i; the back of a two-sided surface has patches of its own
//
// A draw id is what the shaders write, since a fragment knows its cell but not its patch: 32 bits. 0 and 1
// mean what they mean as items. From 2 on, every side of a polygon that has patches owns a block of
// consecutive ids, one a cell; DrawList::item_of_id gives the item of each.
//
// The cells of a polygon are a grid of grid.u x grid.v: the patches of one surface, or of a piece of it whose
// patches are of one size, or those of coplanar surfaces merged into a lattice. With (u, v) counted in cells
// from the polygon's first corner, and i and j their whole parts, clamped to the grid:
//   id = first_id + ((j * grid.u + i) << split) + half
// split is 1 where every cell is two triangles, cut from (i + 1, j) to (i, j + 1), and half is 1 beyond that
// cut, where (u - i) + (v - j) > 1; else both are 0. Triangles that are subdivided have the grid of the
// parallelogram around them; ids outside stand for the nearest patch, since rounding reaches them.
// (u, v) is interpolated on parallelograms and triangles. On other quadrilaterals what is interpolated is the
// position in the frame of corners 0, 1 and 3, and hemicube_quad.frag inverts the bilinear map.
//
// first_id is front_id for an eye in front of the polygon's plane and back_id behind it. Both sides number
// their cells alike: a cell of the back lies behind the same cell of the front. A back_id of 1 is one cell.

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

    /// Whether a side shows the same draw id everywhere: the polygon has one cell.
    [[nodiscard]] bool shows_one_id() const { return grid.u * grid.v == 1 && split == 0; }
};

/// Polygons one after the other: one, or the pieces of a surface whose patches differ in size.
struct PolygonRange {
    std::uint32_t first = 0;
    std::uint32_t count = 0;

    [[nodiscard]] bool holds(std::uint32_t polygon) const { return polygon - first < count; }
};

/// What the item buffers are drawn from: polygons with welded vertices and outlines without T-junctions, and
/// what every draw id stands for.
struct DrawList {
    std::vector<Vec3> vertices;
    std::vector<DrawPolygon> polygons;
    std::vector<OutlineCorner> corners;
    std::vector<std::array<std::uint32_t, 3>> triangles; ///< positions in their polygon's outline
    std::vector<std::uint32_t> item_of_id;               ///< draw id -> item
    std::vector<PolygonRange> polygons_of_surface;       ///< those that show the surface
    double tolerance = 0.0;                              ///< lengths below are rounding: scene units

    /// Those that an eye on a surface lies on; none for one that is on no surface.
    [[nodiscard]] PolygonRange polygons_at(std::uint32_t surface) const {
        return surface < polygons_of_surface.size() ? polygons_of_surface[surface] : PolygonRange();
    }
};

/// @throws InvalidArgument if a surface is cut more than 65,535 ways along an edge.
[[nodiscard]] DrawList make_draw_list(const PatchMesh& mesh, bool merge_lattices);

} // namespace hemi
