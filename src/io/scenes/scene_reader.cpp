#include "hemi/io/scene_reader.hpp"
#include "hemi/io/paths.hpp"

#include "hemi/core/error.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_mesh.hpp"
#include "io/scenes/json_symmetry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>

namespace hemi::io {

namespace {

struct Reader {
    std::string_view extension;
    Scene (*read)(const std::filesystem::path&, const SceneReaderOptions&, Diagnostics&);
};
constexpr Reader readers[] = {
    {".json", read_json_scene}, {".obj", read_obj_scene},  {".gltf", read_gltf_scene},
    {".glb", read_gltf_scene},  {".vs3", read_vs3_scene},  {".msh", read_msh_scene},
    {".ply", read_ply_scene},   {".stl", read_stl_scene},  {".inp", read_mesh_scene},
    {".vtk", read_mesh_scene},  {".vtp", read_mesh_scene}, {".vtu", read_mesh_scene},
    {".bdf", read_mesh_scene},  {".nas", read_mesh_scene}, {".epjson", read_epjson_scene}};

const Reader* reader_of(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    const auto* found = std::find_if(std::begin(readers), std::end(readers),
                                     [&](const Reader& reader) { return reader.extension == extension; });
    return found == std::end(readers) ? nullptr : found;
}

} // namespace

std::string scene_extensions() {
    std::string list;
    for (const Reader& reader : readers) {
        list += list.empty() ? "" : ", ";
        list += reader.extension;
    }
    return list;
}

bool is_scene_file(const std::filesystem::path& path) {
    return reader_of(path) != nullptr;
}

Scene read_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                 Diagnostics& diagnostics) {
    const Reader* reader = reader_of(path);
    if (reader == nullptr) {
        throw InputError(fmt::format("{}: {}; scenes are read from {} files", path.string(),
                                     path.has_extension()
                                         ? fmt::format("unknown extension \"{}\"", extension_of(path))
                                         : std::string("no extension"),
                                     scene_extensions()));
    }
    if (!(options.planarity > 0.0 && options.planarity < 1.0)) {
        throw InvalidArgument(fmt::format("planarity {}; must be above 0 and below 1", options.planarity));
    }
    if (!options.zone.empty() && reader->read != read_epjson_scene) {
        throw InvalidArgument(fmt::format("{}: no zone {}; only .epJSON files have zones", path.string(),
                                          in_quotes(options.zone)));
    }
    Scene scene = reader->read(path, options, diagnostics);
    scene.up = options.up.value_or(scene.up);
    scene.unit = options.unit ? options.unit : scene.unit;
    set_symmetry(scene, options.symmetry);
    try {
        validate(scene);
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", path.string(), error.what()));
    }
    return scene;
}

Scene read_scene(const std::filesystem::path& path) {
    Diagnostics not_kept;
    return read_scene(path, {}, not_kept);
}

} // namespace hemi::io
