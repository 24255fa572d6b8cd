#include "io/scenes/obj_materials.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace hemi::io {

namespace {

/// Reads the files of one mtllib line: all of it as one name if there is such a file, else its words.
/// False if one is missing.
bool read_library(const FaceMesh& mesh, const FaceMesh::Library& library, const SceneFolder& folder,
                  std::vector<MtlMaterial>& materials, Diagnostics& diagnostics) {
    // Backslashes part folders where the file comes from, unless there is a file of such a name.
    const auto path_of = [&](std::string_view name) {
        const std::filesystem::path as_written = mesh.path.parent_path() / name;
        std::error_code ignored;
        if (name.find('\\') == std::string_view::npos || std::filesystem::exists(as_written, ignored)) {
            return as_written;
        }
        std::string slashes(name);
        std::replace(slashes.begin(), slashes.end(), '\\', '/');
        return mesh.path.parent_path() / slashes;
    };
    const auto exists = [&](std::string_view name) {
        std::error_code ignored; // a name that no file can have
        return std::filesystem::exists(path_of(name), ignored);
    };
    const auto read = [&](std::string_view name) {
        if (!folder.allows(path_of(name))) {
            throw ParseError(mesh.path.string(), library.line, 0,
                             "mtllib " + SceneFolder::refusal(std::string(name)));
        }
        read_mtl(path_of(name), materials, diagnostics);
    };
    if (exists(library.names)) {
        read(library.names);
        return true;
    }
    bool all = true;
    std::string_view rest = library.names;
    for (std::string_view name = next_word(rest); !name.empty(); name = next_word(rest)) {
        if (exists(name)) {
            read(name);
        } else {
            all = false;
            diagnostics.warn(fmt::format("{}:{}: there is no file {}; materials that it would define have "
                                         "reflectance 0.5 and exitance 0",
                                         mesh.path.string(), library.line, path_of(name).string()));
        }
    }
    return all;
}

void tell_unknown(const FaceMesh& mesh, const FaceMesh::MaterialUse& use,
                  const std::vector<MtlMaterial>& known, std::span<const std::string> elsewhere, bool strict,
                  Diagnostics& diagnostics) {
    std::vector<std::string> names(elsewhere.begin(), elsewhere.end());
    for (const MtlMaterial& material : known) {
        names.push_back(material.name);
    }
    const std::string message =
        fmt::format("unknown material {}{}", in_quotes(use.name), did_you_mean_or_list(use.name, names));
    if (strict) {
        throw ParseError(mesh.path.string(), use.line, 0, message);
    }
    diagnostics.warn(fmt::format("{}:{}: {}; reflectance 0.5 and exitance 0 are used", mesh.path.string(),
                                 use.line, message));
}

} // namespace

std::vector<std::optional<MtlMaterial>> find_obj_materials(const FaceMesh& mesh,
                                                           std::span<const std::string> defined_elsewhere,
                                                           const SceneFolder& folder, bool strict,
                                                           Diagnostics& diagnostics) {
    const auto wanted = [&](const FaceMesh::MaterialUse& use) {
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
    std::vector<std::string> limited;
    bool complete = true;
    for (const FaceMesh::Library& library : mesh.libraries) {
        complete = read_library(mesh, library, folder, known, diagnostics) && complete;
    }
    for (std::size_t k = 0; k < found.size(); ++k) {
        const FaceMesh::MaterialUse& use = mesh.materials[k];
        const auto same = std::find_if(known.begin(), known.end(),
                                       [&](const MtlMaterial& other) { return other.name == use.name; });
        if (!wanted(use)) {
            continue;
        }
        if (same != known.end()) {
            found[k] = *same;
            if (!strict && limit_reflectance(*found[k])) {
                limited.push_back(same->name);
            }
            check_range(*found[k]);
        } else if (complete) {
            tell_unknown(mesh, use, known, defined_elsewhere, strict, diagnostics);
        }
    }
    if (!limited.empty()) {
        diagnostics.warn(
            fmt::format("{}: reflectance {} instead of Kd 1 in {} (no surface reflects all it receives)",
                        mesh.path.string(), most_reflectance, fmt::join(limited, ", ")));
    }
    return found;
}

} // namespace hemi::io
