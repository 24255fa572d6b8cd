#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/scene/scene.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace hemi::io {

/// The faces of a mesh file, before anything is known of its materials but their names.
struct FaceMesh {
    /// A material that faces use; no name: faces without one.
    struct MaterialUse {
        std::string name;
        std::size_t line = 0; ///< where it is first asked for; 0: nowhere, the name is a group's
    };
    /// A file that defines materials, as the mesh names it.
    struct Library {
        std::size_t line;
        std::string names; ///< the rest of the line
    };

    std::filesystem::path path;
    std::vector<std::string> groups;    ///< unique, in order of first appearance
    std::vector<Surface> surfaces;      ///< in the file's order; `material` is an index into materials
    std::vector<MaterialUse> materials; ///< in order of first use by a face
    std::vector<Library> libraries;
};

/// Reads a mesh by its extension: see mesh_extensions().
/// @throws ParseError or InputError with file, place, value and what would be right.
[[nodiscard]] FaceMesh read_face_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                                      Diagnostics& diagnostics);

/// The extensions that read_face_mesh reads, as a message lists them: ".msh, .obj".
[[nodiscard]] std::string mesh_extensions();

/// A mesh by itself as a scene: reflectance 0.5 and exitance 0, whatever materials it names.
[[nodiscard]] Scene read_mesh_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                                    Diagnostics& diagnostics);

/// Whether the extension is one of those that read_face_mesh reads.
[[nodiscard]] bool is_face_mesh(const std::filesystem::path& path);

/// Wavefront OBJ: groups and materials as the file names them.
[[nodiscard]] FaceMesh read_obj_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                                     Diagnostics& diagnostics);
/// Gmsh MSH 4.1 and 2.2, ASCII and binary: groups are physical surfaces, and so are the names of materials.
[[nodiscard]] FaceMesh read_msh_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                                     Diagnostics& diagnostics);
/// Abaqus input: groups are surfaces, else sets of elements, no material.
[[nodiscard]] FaceMesh read_inp_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                                     Diagnostics& diagnostics);
/// Nastran bulk data: groups are properties, "PID n", no material.
[[nodiscard]] FaceMesh read_bdf_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                                     Diagnostics& diagnostics);
/// VTK, legacy and XML, polygons and unstructured grids: groups are values of a cell array, no material.
[[nodiscard]] FaceMesh read_vtk_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                                     Diagnostics& diagnostics);
/// PLY, ASCII or binary of either byte order: one group, no material.
[[nodiscard]] FaceMesh read_ply_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                                     Diagnostics& diagnostics);
/// STL, ASCII or binary: groups are solids, no material.
[[nodiscard]] FaceMesh read_stl_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                                     Diagnostics& diagnostics);

} // namespace hemi::io
