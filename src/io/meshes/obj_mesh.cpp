#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "io/meshes/face_builder.hpp"
#include "io/scenes/obj_lines.hpp"

#include <tiny_obj_loader.h>

#include <istream>
#include <limits>
#include <string_view>
#include <utility>

namespace hemi::io {

namespace {

constexpr std::uint32_t absent = std::numeric_limits<std::uint32_t>::max();

/// Receives what the loader finds, in the file's order.
class MeshBuilder {
public:
    MeshBuilder(const std::filesystem::path& path, const ObjLines& lines, const SceneReaderOptions& options)
        : lines_(lines), faces_(path, options) {}

    void group(std::string_view name) {
        group_name_ = trim(name).empty() ? "default" : to_utf8(trim(name));
        group_ = absent;
    }

    void material(std::string_view name) {
        material_name_ = to_utf8(trim(name));
        material_line_ = lines_.line();
        material_ = absent;
    }

    void face(std::span<const tinyobj::index_t> indices) {
        corners_.clear();
        const auto& vertices = lines_.vertices();
        for (const tinyobj::index_t& index : indices) {
            const auto n = index.vertex_index; // checked by ObjLines
            corners_.push_back(vertices[n > 0 ? static_cast<std::size_t>(n) - 1
                                              : vertices.size() - static_cast<std::size_t>(-n)]);
        }
        if (group_ == absent) {
            group_ = faces_.group(group_name_);
        }
        if (material_ == absent) {
            material_ = faces_.material(material_name_, material_line_);
        }
        faces_.add(corners_, group_, material_, {lines_.line(), 0});
    }

    void reserve(std::uint64_t faces, std::uint64_t most) { faces_.reserve(faces, most); }

    FaceMesh finish(Diagnostics& diagnostics) {
        FaceMesh mesh = faces_.finish("f lines", diagnostics);
        mesh.libraries = lines_.libraries();
        return mesh;
    }

private:
    const ObjLines& lines_;
    FaceBuilder faces_;
    std::string group_name_ = "default";
    std::string material_name_;
    std::size_t material_line_ = 0;
    std::uint32_t group_ = absent; ///< index of group_name_ once a face is in it
    std::uint32_t material_ = absent;
    std::vector<Vec3> corners_; // kept between faces for their memory
};

MeshBuilder& builder(void* user) {
    return *static_cast<MeshBuilder*>(user);
}

tinyobj::callback_t callbacks() {
    tinyobj::callback_t result;
    result.index_cb = [](void* user, tinyobj::index_t* indices, int count) {
        builder(user).face({indices, static_cast<std::size_t>(count)});
    };
    result.usemtl_cb = [](void* user, const char* name, int) { builder(user).material(name); };
    result.object_cb = [](void* user, const char* name) { builder(user).group(name); };
    result.group_cb = [](void* user, const char** names, int count) {
        std::string joined;
        for (int k = 0; k < count; ++k) {
            joined += k == 0 ? "" : " ";
            joined += names[k];
        }
        builder(user).group(joined);
    };
    return result;
}

/// About as many as there are: continued lines and leading blanks are not looked for.
std::uint64_t count_faces(std::string_view text) {
    std::uint64_t faces = text.starts_with("f ") ? 1 : 0;
    for (std::size_t at = text.find("\nf "); at != std::string_view::npos; at = text.find("\nf ", at + 3)) {
        ++faces;
    }
    return faces;
}

} // namespace

FaceMesh read_obj_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                       Diagnostics& diagnostics) {
    const std::string text = read_text(path);
    ObjLines lines(path.string(), text, diagnostics);
    MeshBuilder mesh(path, lines, options);
    mesh.reserve(count_faces(text), text.size() / 8); // f 1 2 3
    std::istream stream(&lines);
    stream.exceptions(std::ios::badbit); // lets errors of ObjLines through as they are
    tinyobj::LoadObjWithCallback(stream, callbacks(), &mesh);
    return mesh.finish(diagnostics);
}

} // namespace hemi::io
