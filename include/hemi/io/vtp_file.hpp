#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// Numbers of every patch, under a name.
struct CellArray {
    std::string name;                    ///< as ParaView shows it
    std::vector<double> values;          ///< component c of patch i at [i·components + c]
    std::vector<std::string> components; ///< their names; empty: one number a patch
};

/// ParaView's XML PolyData (.vtp): every patch a polygon with corners of its own, in the patches' order,
/// front counter-clockwise. Cell data are `patch` (index), `group` (index into the field data `groups`, the
/// names), `area` and `arrays`. 64-bit numbers, raw behind the XML.
/// @throws InvalidArgument for arrays of another length, values that are not finite; IoError
void write_vtp(const std::filesystem::path& path, const PatchMesh& mesh, std::span<const CellArray> arrays);

} // namespace hemi::io
