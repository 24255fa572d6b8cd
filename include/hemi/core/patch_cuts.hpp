#pragma once

#include <cstdint>
#include <vector>

namespace hemi {

/// Number of patches along the two directions of a surface.
struct Grid {
    std::uint32_t u = 1; ///< along vertex 0 -> vertex 1
    std::uint32_t v = 1; ///< along vertex 0 -> vertex 3 (quadrilateral); equal to u for a triangle

    bool operator==(const Grid&) const = default; ///< member by member
};

/// A patch of a surface whose patches differ in size: a cell of the grid that is 2^level_u x 2^level_v times
/// as fine as the surface's own.
struct GridPart {
    std::uint32_t level_u = 0; ///< halvings along u
    std::uint32_t level_v = 0; ///< halvings along v; of a triangle as many
    std::uint32_t cell = 0;    ///< of that grid, numbered as the patches of a surface with this grid

    bool operator==(const GridPart&) const = default; ///< member by member
};

/// How all surfaces of a mesh are cut into patches.
struct PatchCuts {
    std::vector<Grid> grids; ///< of every surface
    /// Of every surface the patches that its grid is cut into, which fill it once; empty of a surface whose
    /// patches are the cells of its grid; nothing at all where all surfaces are such.
    std::vector<std::vector<GridPart>> parts;

    /// Whether it says anything.
    [[nodiscard]] bool any() const noexcept { return !grids.empty(); }

    bool operator==(const PatchCuts&) const = default; ///< member by member
};

} // namespace hemi
