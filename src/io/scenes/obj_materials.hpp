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
/// Nothing for faces without a material, for names that are in `defined_elsewhere`, and (with a warning) for
/// names whose file is missing and those that are defined nowhere. A reflectance of 1 becomes 0.99, with a
/// warning.
/// @param strict  names that are defined nowhere and reflectances of 1 are errors
/// @throws InputError for these, for values out of range, and for files that are not allowed by `folder`
[[nodiscard]] std::vector<std::optional<MtlMaterial>>
find_obj_materials(const FaceMesh& mesh, std::span<const std::string> defined_elsewhere,
                   const SceneFolder& folder, bool strict, Diagnostics& diagnostics);

} // namespace hemi::io
