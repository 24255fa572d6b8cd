#pragma once

#include "engine/hemicube/outline.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// A rectangle of lattice cells that is drawn as one parallelogram.
struct MergedLattice {
    std::array<std::uint32_t, 4> vertices{}; ///< welded vertices at its corners, counter-clockwise
    Grid cells;                              ///< patches along its two directions
    bool split = false;                      ///< cells are pairs of triangles, cut from (1, 0) to (0, 1)
    std::vector<std::uint32_t> surfaces;     ///< what it is made of
};

/// Finds coplanar lattices: parallelograms, or triangles in pairs, that share edges and repeat one cell.
/// Material and group do not matter, every face keeps its own ids; side and subdivision must agree.
/// Surfaces that are in no lattice of two or more are in no result.
/// @param surface_vertices  welded vertex of every surface corner, 4 a surface.
/// @param positions         of the welded vertices.
/// @param tolerance         vertices may be off the lattice by half of what still counts as touching: the
///   neighbours' vertices along a merged edge are then inserted into it.
[[nodiscard]] std::vector<MergedLattice>
find_lattices(const PatchMesh& mesh, std::span<const std::array<std::uint32_t, 4>> surface_vertices,
              std::span<const Vec3> positions, const TouchingTolerance& tolerance);

} // namespace hemi
