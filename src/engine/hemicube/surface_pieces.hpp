#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <vector>

namespace hemi {

/// A piece of a surface that is cut by a grid: it can be drawn as one polygon.
struct SurfacePiece {
    PatchCorners corners; ///< of the piece, counter-clockwise about the surface's front
    Grid grid;            ///< its patches; of a triangle that is a part of its surface 1 x 1
    /// Of every cell of the grid, row by row, which patch of the surface's front it is, from 0; empty: the
    /// piece is the whole surface, and its patches are in their order.
    std::vector<std::uint32_t> patches;
};

/// The pieces of a surface whose patches differ in size: rectangles of patches of one size, as large as they
/// are found from the first cell on; of a triangle its patches. None where the surface's patches are of one
/// size.
[[nodiscard]] std::vector<SurfacePiece> pieces_of(const PatchMesh& mesh, std::uint32_t surface);

} // namespace hemi
