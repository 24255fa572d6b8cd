#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Radiosity of a mesh as a square texture: every grid of patches of a surface is a rectangle of it where its
/// patches have the same values at their common corners, every other patch one of its own (a triangle half of
/// it). Corners of patches are at centres of texels, so that sampling it bilinearly gives what pictures
/// interpolate between corners; around every rectangle its outermost texels are repeated.
struct Lightmap {
    std::uint32_t size = 0;       ///< texels along an edge
    std::uint32_t patch_size = 0; ///< texels along the edge of a patch
    std::vector<float> texels;    ///< red, green, blue, as `radiosity`, rows from the top; 0 where nothing is
    /// u from the left and v from the top of corner k of patch i at [(i·4 + k)·2], from 0 to 1; a triangle's
    /// fourth is not used.
    std::vector<float> coordinates;
};

/// Packs the rectangles by rows of equal height, with as many texels a patch as fit.
/// @param mesh       N patches
/// @param radiosity  red, green, blue of corner k of patch i at [(i·4 + k)·3], as corner_values() has them
/// @param size       of the texture, 16 to 16384 texels
/// @throws InvalidArgument for another length of `radiosity` and other sizes; where not even one texel for
///   a patch fits, which names a size that does
[[nodiscard]] Lightmap make_lightmap(const PatchMesh& mesh, std::span<const float> radiosity,
                                     std::uint32_t size);

} // namespace hemi
