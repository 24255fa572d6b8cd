#include "hemi/io/scene_reader.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_mesh.hpp"
#include "io/scenes/obj_materials.hpp"
#include "io/scenes/sides.hpp"
#include "io/scenes/up_axis.hpp"

#include <algorithm>
#include <utility>

namespace hemi::io {

namespace {

Material scene_material(const FaceMesh::MaterialUse& use, const std::optional<MtlMaterial>& found,
                        std::size_t channels) {
    const std::string name = use.name.empty() ? "default" : use.name;
    if (!found) {
        return {name, std::vector<double>(channels, 0.5), std::vector<double>(channels, 0.0)};
    }
    return {name,
            {found->reflectance.begin(), found->reflectance.end()},
            {found->exitance.begin(), found->exitance.end()}};
}

/// @param found  what is known of each of the mesh's materials
Scene make_scene(FaceMesh mesh, const std::vector<std::optional<MtlMaterial>>& found,
                 const SceneReaderOptions& options, Diagnostics& diagnostics) {
    const bool coloured =
        std::any_of(found.begin(), found.end(), [](const auto& m) { return m.has_value(); });
    Scene scene;
    scene.name = to_utf8(mesh.path.stem().string());
    scene.channels =
        coloured ? std::vector<std::string>{"red", "green", "blue"} : std::vector<std::string>{"grey"};
    scene.environment.assign(scene.channels.size(), 0.0);
    for (std::size_t k = 0; k < found.size(); ++k) {
        scene.materials.push_back(scene_material(mesh.materials[k], found[k], scene.channels.size()));
    }
    scene.groups = std::move(mesh.groups);
    scene.surfaces = std::move(mesh.surfaces);
    set_sides(scene, options, mesh.path.string(), diagnostics);
    return scene;
}

Scene without_materials(FaceMesh mesh, const SceneReaderOptions& options, Diagnostics& diagnostics) {
    const std::size_t materials = mesh.materials.size();
    return make_scene(std::move(mesh), std::vector<std::optional<MtlMaterial>>(materials), options,
                      diagnostics);
}

} // namespace

Scene read_obj_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                     Diagnostics& diagnostics) {
    FaceMesh mesh = read_obj_mesh(path, options, diagnostics);
    const auto found =
        find_obj_materials(mesh, {}, SceneFolder(path, options.allow_outside), options.strict, diagnostics);
    Scene scene = make_scene(std::move(mesh), found, options, diagnostics);
    scene.up = up_by_faces(scene);
    return scene;
}

Scene read_mesh_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                      Diagnostics& diagnostics) {
    return without_materials(read_face_mesh(path, options, diagnostics), options, diagnostics);
}

Scene read_msh_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                     Diagnostics& diagnostics) {
    return without_materials(read_msh_mesh(path, options, diagnostics), options, diagnostics);
}

Scene read_ply_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                     Diagnostics& diagnostics) {
    return without_materials(read_ply_mesh(path, options, diagnostics), options, diagnostics);
}

Scene read_stl_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                     Diagnostics& diagnostics) {
    return without_materials(read_stl_mesh(path, options, diagnostics), options, diagnostics);
}

} // namespace hemi::io
