#include "io/meshes/face_mesh.hpp"
#include "hemi/io/paths.hpp"

#include "hemi/core/error.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>

namespace hemi::io {

namespace {

struct Reader {
    std::string_view extension;
    FaceMesh (*read)(const std::filesystem::path&, const SceneReaderOptions&, Diagnostics&);
};
constexpr Reader readers[] = {{".obj", read_obj_mesh}, {".msh", read_msh_mesh}, {".ply", read_ply_mesh},
                              {".stl", read_stl_mesh}, {".inp", read_inp_mesh}, {".vtk", read_vtk_mesh},
                              {".vtp", read_vtk_mesh}, {".vtu", read_vtk_mesh}, {".bdf", read_bdf_mesh},
                              {".nas", read_bdf_mesh}};

const Reader* reader_of(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    const auto* found = std::find_if(std::begin(readers), std::end(readers),
                                     [&](const Reader& reader) { return reader.extension == extension; });
    return found == std::end(readers) ? nullptr : found;
}

} // namespace

FaceMesh read_face_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                        Diagnostics& diagnostics) {
    const Reader* reader = reader_of(path);
    if (reader == nullptr) {
        throw InputError(fmt::format("{}: meshes are read from {} files", path.string(), mesh_extensions()));
    }
    return reader->read(path, options, diagnostics);
}

std::string mesh_extensions() {
    std::string list;
    for (const Reader& reader : readers) {
        list += list.empty() ? "" : ", ";
        list += reader.extension;
    }
    return list;
}

bool is_face_mesh(const std::filesystem::path& path) {
    return reader_of(path) != nullptr;
}

} // namespace hemi::io
