#pragma once

#include "hemi/core/diagnostics.hpp"
#include "io/meshes/face_mesh.hpp"
#include "io/scenes/mtl_reader.hpp"
#include "io/scenes/scene_folder.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// What an OBJ mesh's MTL files say of its materials, one for each of FaceMesh::materials, ranges checked.
/// Nothing for faces without a material, for names that are in `defined_elsewhere`, and for names whose file
/// is missing (with a warning).
/// @throws InputError for a name that is defined nowhere, with the nearest that is, and for files that are
///   not allowed by `folder`
[[nodiscard]] std::vector<std::optional<MtlMaterial>>
find_obj_materials(const FaceMesh& mesh, std::span<const std::string> defined_elsewhere,
                   const SceneFolder& folder, Diagnostics& diagnostics);

} // namespace hemi::io
