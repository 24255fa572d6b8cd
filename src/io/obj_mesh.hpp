#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/scene/scene.hpp"
#include "io/mtl_reader.hpp"
#include "io/obj_lines.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// The faces of an OBJ file, before anything is known of its materials but their names.
struct ObjMesh {
    /// A material that faces use; no name: faces without one.
    struct MaterialUse {
        std::string name;
        std::size_t line = 0; ///< of its first usemtl
    };

    std::filesystem::path path;
    std::vector<std::string> groups;    ///< unique, in order of first appearance
    std::vector<Surface> surfaces;      ///< in the file's order; `material` is an index into materials
    std::vector<MaterialUse> materials; ///< in order of first use by a face
    std::vector<ObjLines::Library> libraries;
};

/// @throws ParseError or InputError with the line.
[[nodiscard]] ObjMesh read_obj_mesh(const std::filesystem::path& path, bool skip_degenerate,
                                    Diagnostics& diagnostics);

/// What the mesh's MTL files say of its materials, one for each of ObjMesh::materials, ranges checked.
/// Nothing for faces without a material, for names that are in `defined_elsewhere`, and for names whose file
/// is missing (with a warning).
/// @throws InputError for a name that is defined nowhere, with the nearest that is.
[[nodiscard]] std::vector<std::optional<MtlMaterial>>
find_obj_materials(const ObjMesh& mesh, std::span<const std::string> defined_elsewhere,
                   Diagnostics& diagnostics);

} // namespace hemi::io
