#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <filesystem>
#include <span>

namespace hemi::io {

/// A mesh with its radiosity baked into the vertices, as binary glTF 2.0 (.glb): a node of that name for
/// every group, every patch with corners of its own (quadrilaterals as two triangles), one unlit material
/// (KHR_materials_unlit). Vertex attributes, 32-bit floats: POSITION about the node's translation, the centre
/// of the scene; COLOR_0, linear, `exposure` times radiosity, from 0 to 1; _RADIOSITY, as it is, W/m².
/// @param path       of the file
/// @param mesh       its patches
/// @param radiosity  red, green, blue of corner k of patch i at [(i·4 + k)·3], as corner_values() has them
/// @param exposure   factor on radiosity for the colours, >= 0
/// @throws InvalidArgument for another length, values that are not finite, an exposure that is negative, more
///   bytes than a .glb can hold (4 GiB); IoError
void write_baked_glb(const std::filesystem::path& path, const PatchMesh& mesh,
                     std::span<const float> radiosity, double exposure);

/// Radiosity as a square texture, as make_lightmap() has it.
struct BakedTexture {
    std::uint32_t size = 0;             ///< texels along an edge
    std::span<const float> texels;      ///< red, green, blue, rows from the top
    std::span<const float> coordinates; ///< u and v of corner k of patch i at [(i·4 + k)·2]
};
/// The same with the light in a texture, by which the one material shines, black otherwise: a 16-bit PNG in
/// the file, by the sRGB curve, of `exposure` times radiosity from 0 to 1, between the corners of patches.
/// TEXCOORD_1 says where every vertex is in it, as TEXCOORD_0 does, without which there is no second set.
/// There is no COLOR_0, by which engines would multiply it.
/// @param path       of the file
/// @param mesh       its patches
/// @param radiosity  as in write_baked_glb()
/// @param exposure   factor on radiosity for the texture, >= 0
/// @param texture    of the mesh and the radiosity
/// @throws as write_baked_glb; InvalidArgument for a texture of other numbers of texels or coordinates
void write_lightmapped_glb(const std::filesystem::path& path, const PatchMesh& mesh,
                           std::span<const float> radiosity, double exposure, const BakedTexture& texture);

/// The same as write_baked_glb() as PLY, binary little endian: every patch a face with vertices of its own,
/// in the patches' order, quadrilaterals as such. Vertex properties: x, y, z (double), red, green, blue
/// (uchar, sRGB of `exposure` times radiosity) and radiosity_red, radiosity_green, radiosity_blue (float, as
/// it is, W/m²).
/// @throws InvalidArgument as write_baked_glb, and for more vertices than 32 bits count; IoError
void write_baked_ply(const std::filesystem::path& path, const PatchMesh& mesh,
                     std::span<const float> radiosity, double exposure);

} // namespace hemi::io
