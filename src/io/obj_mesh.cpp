#include "io/obj_mesh.hpp"

#include "core/nearest_word.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "io/polygon_pieces.hpp"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <istream>
#include <limits>
#include <unordered_map>
#include <utility>

namespace hemi::io {

namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// Index of each name, given out in order of first use.
class Names {
public:
    std::uint32_t index(const std::string& name) {
        return indices_.emplace(name, static_cast<std::uint32_t>(indices_.size())).first->second;
    }
    [[nodiscard]] std::size_t size() const { return indices_.size(); }

private:
    std::unordered_map<std::string, std::uint32_t> indices_;
};

/// Receives what the loader finds, in the file's order.
class MeshBuilder {
public:
    MeshBuilder(const std::filesystem::path& path, const ObjLines& lines, bool skip_degenerate)
        : lines_(lines), skip_degenerate_(skip_degenerate) {
        mesh_.path = path;
    }

    void group(std::string_view name) {
        group_name_ = trim(name).empty() ? "default" : to_utf8(trim(name));
        group_ = none;
    }

    void material(std::string_view name) {
        material_name_ = to_utf8(trim(name));
        material_line_ = lines_.line();
        material_ = none;
    }

    void face(std::span<const tinyobj::index_t> indices) {
        collect_corners(indices);
        if (corners_.size() <= 4) {
            if (accept(has_no_area(corners_) ? "zero area" : polygon_defect(corners_))) {
                add(corners_);
            }
            return;
        }
        if (accept(many_corners_defect(corners_))) {
            pieces_.clear();
            cut_into_pieces(corners_, pieces_);
            for (const PolygonPiece& piece : pieces_) {
                add({piece.points.data(), piece.count});
            }
            ++split_;
        }
    }

    ObjMesh finish(Diagnostics& diagnostics) {
        const std::string file = mesh_.path.string();
        if (skipped_ > 0) {
            diagnostics.warn(fmt::format("{}:{}: {} faces without area left out, the first one here", file,
                                         first_skipped_, skipped_));
        }
        if (split_ > 0) {
            diagnostics.warn(fmt::format(
                "{}: {} faces of more than 4 vertices cut into quadrilaterals and triangles", file, split_));
        }
        mesh_.libraries = lines_.libraries();
        return std::move(mesh_);
    }

private:
    /// Corners of the face, without repeated ones in a row.
    void collect_corners(std::span<const tinyobj::index_t> indices) {
        corners_.clear();
        const auto& vertices = lines_.vertices();
        for (const tinyobj::index_t& index : indices) {
            const auto n = index.vertex_index; // checked by ObjLines
            const auto place =
                n > 0 ? static_cast<std::size_t>(n) - 1 : vertices.size() - static_cast<std::size_t>(-n);
            if (corners_.empty() || vertices[place] != corners_.back()) {
                corners_.push_back(vertices[place]);
            }
        }
        while (corners_.size() > 1 && corners_.front() == corners_.back()) {
            corners_.pop_back();
        }
    }

    /// Whether to use a face with that defect, or none.
    bool accept(const std::optional<std::string>& defect) {
        if (!defect) {
            return true;
        }
        if (!skip_degenerate_ || !has_no_area(corners_)) {
            throw ParseError(mesh_.path.string(), lines_.line(), 0, fmt::format("face: {}", *defect));
        }
        first_skipped_ = skipped_ == 0 ? lines_.line() : first_skipped_;
        ++skipped_;
        return false;
    }

    void add(std::span<const Vec3> polygon) {
        Surface surface;
        std::copy(polygon.begin(), polygon.end(), surface.vertices.begin());
        surface.vertex_count = static_cast<std::uint32_t>(polygon.size());
        surface.group = current_group();
        surface.material = current_material();
        mesh_.surfaces.push_back(surface);
    }

    std::uint32_t current_group() {
        if (group_ == none) {
            group_ = group_indices_.index(group_name_);
            if (group_ == mesh_.groups.size()) {
                mesh_.groups.push_back(group_name_);
            }
        }
        return group_;
    }

    std::uint32_t current_material() {
        if (material_ == none) {
            material_ = material_indices_.index(material_name_);
            if (material_ == mesh_.materials.size()) {
                mesh_.materials.push_back({material_name_, material_line_});
            }
        }
        return material_;
    }

    ObjMesh mesh_;
    const ObjLines& lines_;
    bool skip_degenerate_;
    Names group_indices_;
    Names material_indices_;
    std::string group_name_ = "default";
    std::string material_name_;
    std::size_t material_line_ = 0;
    std::uint32_t group_ = none;
    std::uint32_t material_ = none;
    std::vector<Vec3> corners_; // kept between faces for their memory
    std::vector<PolygonPiece> pieces_;
    std::size_t split_ = 0;
    std::size_t skipped_ = 0;
    std::size_t first_skipped_ = 0;
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

/// Reads the files of one mtllib line: all of it as one name if there is such a file, else its words.
/// False if one is missing.
bool read_library(const ObjMesh& mesh, const ObjLines::Library& library, std::vector<MtlMaterial>& materials,
                  Diagnostics& diagnostics) {
    const auto folder = mesh.path.parent_path();
    if (std::filesystem::exists(folder / library.names)) {
        read_mtl(folder / library.names, materials, diagnostics);
        return true;
    }
    bool all = true;
    std::string_view rest = library.names;
    for (std::string_view name = next_word(rest); !name.empty(); name = next_word(rest)) {
        if (std::filesystem::exists(folder / name)) {
            read_mtl(folder / name, materials, diagnostics);
        } else {
            all = false;
            diagnostics.warn(fmt::format("{}:{}: there is no file {}; materials that it would define have "
                                         "reflectance 0.5 and exitance 0",
                                         mesh.path.string(), library.line, (folder / name).string()));
        }
    }
    return all;
}

[[noreturn]] void refuse_unknown(const ObjMesh& mesh, const ObjMesh::MaterialUse& use,
                                 const std::vector<MtlMaterial>& known,
                                 std::span<const std::string> elsewhere) {
    std::vector<std::string> names(elsewhere.begin(), elsewhere.end());
    for (const MtlMaterial& material : known) {
        names.push_back(material.name);
    }
    throw ParseError(
        mesh.path.string(), use.line, 0,
        fmt::format("unknown material {}{}", in_quotes(use.name), did_you_mean_or_list(use.name, names)));
}

} // namespace

ObjMesh read_obj_mesh(const std::filesystem::path& path, bool skip_degenerate, Diagnostics& diagnostics) {
    const std::string text = read_file(path);
    ObjLines lines(path.string(), text, diagnostics);
    MeshBuilder mesh(path, lines, skip_degenerate);
    std::istream stream(&lines);
    stream.exceptions(std::ios::badbit); // lets errors of ObjLines through as they are
    tinyobj::LoadObjWithCallback(stream, callbacks(), &mesh);
    ObjMesh result = mesh.finish(diagnostics);
    if (result.surfaces.empty()) {
        throw InputError(fmt::format("{}: no faces; a scene needs at least one (f lines)", path.string()));
    }
    return result;
}

std::vector<std::optional<MtlMaterial>> find_obj_materials(const ObjMesh& mesh,
                                                           std::span<const std::string> defined_elsewhere,
                                                           Diagnostics& diagnostics) {
    const auto wanted = [&](const ObjMesh::MaterialUse& use) {
        return !use.name.empty() && std::find(defined_elsewhere.begin(), defined_elsewhere.end(), use.name) ==
                                        defined_elsewhere.end();
    };
    std::vector<std::optional<MtlMaterial>> found(mesh.materials.size());
    const auto first = std::find_if(mesh.materials.begin(), mesh.materials.end(), wanted);
    if (first == mesh.materials.end()) {
        return found;
    }
    if (mesh.libraries.empty()) {
        diagnostics.warn(fmt::format("{}:{}: usemtl without mtllib; reflectance 0.5 and exitance 0 are used",
                                     mesh.path.string(), first->line));
        return found;
    }
    std::vector<MtlMaterial> known;
    bool complete = true;
    for (const ObjLines::Library& library : mesh.libraries) {
        complete = read_library(mesh, library, known, diagnostics) && complete;
    }
    for (std::size_t k = 0; k < found.size(); ++k) {
        const ObjMesh::MaterialUse& use = mesh.materials[k];
        const auto same = std::find_if(known.begin(), known.end(),
                                       [&](const MtlMaterial& other) { return other.name == use.name; });
        if (!wanted(use)) {
            continue;
        }
        if (same != known.end()) {
            check_range(*same);
            found[k] = *same;
        } else if (complete) {
            refuse_unknown(mesh, use, known, defined_elsewhere);
        }
    }
    return found;
}

} // namespace hemi::io
