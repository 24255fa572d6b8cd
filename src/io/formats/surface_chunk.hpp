#pragma once

#include "hemi/scene/patch_mesh.hpp"
#include "io/formats/chunk_file.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace hemi::io {

/// A surface as it lies in a file. The grid is the one that was used, wherever it came from: stored patches
/// must not depend on how a later version cuts surfaces.
struct StoredSurface {
    std::array<double, 12> vertices;
    std::uint32_t vertex_count;
    std::uint32_t material;
    std::uint32_t group;
    std::uint32_t
        sides; ///< sum of: 1, it has two; 2, it continues the face of the one before; 4, it joins two
    std::uint32_t grid_u;
    std::uint32_t grid_v;
};
static_assert(sizeof(StoredSurface) == 12 * 8 + 6 * 4);

/// The surfaces of a mesh with their grids; parts are another chunk, see stored_parts().
[[nodiscard]] std::vector<StoredSurface> stored_surfaces(const PatchMesh& mesh);

/// Surfaces from a file, up to the payload's end.
/// @param count    of the surfaces
/// @param patches  that they have together
/// @param parts    of every surface, see PatchCuts::parts; empty: all patches are cells
/// @throws InputError
[[nodiscard]] std::vector<Surface> read_surfaces(Payload payload, std::uint64_t count, std::uint64_t patches,
                                                 const std::vector<std::vector<GridPart>>& parts);

} // namespace hemi::io
