#include "io/meshes/vtk_cells.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/io/output_file.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <span>

namespace hemi::io {

namespace {

/// VTK's numbers of the cells that are surfaces, and how many of their first points are corners; 0: all, or
/// the first half of those that are curved.
struct CellType {
    int number;
    std::size_t corners;
    bool curved;
};
constexpr int triangle_strip = 6;
constexpr int pixel = 8;
constexpr std::array surfaces{CellType{5, 3, false}, CellType{triangle_strip, 0, false},
                              CellType{7, 0, false}, CellType{pixel, 4, false},
                              CellType{9, 4, false}, CellType{22, 3, true},
                              CellType{23, 4, true}, CellType{28, 4, true},
                              CellType{30, 4, true}, CellType{34, 3, true},
                              CellType{36, 0, true}, CellType{61, 3, true},
                              CellType{62, 4, true}, CellType{69, 3, true},
                              CellType{70, 4, true}, CellType{76, 3, true},
                              CellType{77, 4, true}};

} // namespace

int vtk_group_rank(std::string_view array) {
    static constexpr std::array<std::string_view, 13> names{
        "group",       "groups",        "patch",         "region", "regionid", "material", "materialids",
        "material_id", "gmsh:physical", "cellentityids", "zone",   "part",     "physical"};
    std::string lower(array);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const auto* const found = std::find(names.begin(), names.end(), lower);
    return found == names.end() ? 0 : static_cast<int>(found - names.begin()) + 1;
}

VtkFaces::VtkFaces(const std::filesystem::path& path, const SceneReaderOptions& options)
    : file_(path.string()), faces_(path, options), material_(faces_.material("", 0)) {}

void VtkFaces::add(const VtkCells& cells) {
    const auto refuse = [&](std::size_t cell, const std::string& message) {
        throw InputError(fmt::format("{}: cell {}: {}", file_, cell, message));
    };
    if (cells.types.size() != cells.ends.size()) {
        throw InputError(
            fmt::format("{}: {} types of {} cells", file_, cells.types.size(), cells.ends.size()));
    }
    if (!cells.groups.empty() && cells.groups.size() != cells.ends.size()) {
        throw InputError(fmt::format("{}: {} values of {} for {} cells", file_, cells.groups.size(),
                                     in_quotes(cells.group_array), cells.ends.size()));
    }
    std::vector<Vec3> corners;
    std::int64_t begin = 0;
    for (std::size_t k = 0; k < cells.ends.size(); ++k) {
        const std::int64_t end = cells.ends[k];
        if (end < begin || end > static_cast<std::int64_t>(cells.nodes.size())) {
            refuse(k, fmt::format("its points end at {}; must be from {} to {}", end, begin,
                                  cells.nodes.size()));
        }
        const std::uint64_t number = cells_ + k;
        const auto* const type = std::find_if(surfaces.begin(), surfaces.end(), [&](const CellType& other) {
            return other.number == cells.types[k];
        });
        const auto size = static_cast<std::size_t>(end - begin);
        if (type == surfaces.end()) {
            ++left_out_;
            begin = end;
            continue;
        }
        const std::size_t wanted = type->corners != 0 ? type->corners : type->curved ? 6 : 3;
        if (size < wanted) {
            refuse(k,
                   fmt::format("{} points; a cell of type {} has at least {}", size, type->number, wanted));
        }
        corners.clear();
        const std::size_t count = type->corners != 0 ? wanted : type->curved ? size / 2 : size;
        for (std::size_t c = 0; c < count; ++c) {
            const std::int64_t point = cells.nodes[static_cast<std::size_t>(begin) + c];
            if (point < 0 || point >= static_cast<std::int64_t>(cells.points.size())) {
                refuse(k, fmt::format("point {}; there are {}, counted from 0", point, cells.points.size()));
            }
            corners.push_back(cells.points[static_cast<std::size_t>(point)]);
        }
        curved_ += type->curved ? 1 : 0;
        if (!cells.groups.empty() && !std::isfinite(cells.groups[k])) {
            refuse(k, fmt::format("{} {}; must be a finite number", in_quotes(cells.group_array),
                                  cells.groups[k]));
        }
        const std::uint32_t group = faces_.group(
            cells.groups.empty() ? "default" : fmt::format("{}_{}", cells.group_array, cells.groups[k]));
        if (type->number == triangle_strip) {
            for (std::size_t t = 0; t + 2 < corners.size(); ++t) {
                faces_.add(std::array{corners[t], corners[t + 1 + t % 2], corners[t + 2 - t % 2]}, group,
                           material_, {0, number});
            }
        } else {
            if (type->number == pixel) {
                std::swap(corners[2], corners[3]);
            }
            faces_.add(corners, group, material_, {0, number});
        }
        begin = end;
    }
    cells_ += cells.ends.size();
}

FaceMesh VtkFaces::finish(Diagnostics& diagnostics) {
    if (left_out_ > 0) {
        diagnostics.warn(
            fmt::format("{}: {} left out (points, lines, volumes)", file_,
                        plural(left_out_, "cell that is no surface", "cells that are no surfaces")));
    }
    if (curved_ > 0) {
        diagnostics.warn(fmt::format("{}: {} of second order or more taken as plane between the corners",
                                     file_, plural(curved_, "cell", "cells")));
    }
    return faces_.finish("polygons, or cells that are triangles or quadrilaterals", diagnostics);
}

FaceMesh read_vtk_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                       Diagnostics& diagnostics) {
    const std::string bytes = read_unmarked(path);
    return bytes.starts_with("# vtk") ? read_vtk_legacy(path, bytes, options, diagnostics)
                                      : read_vtk_xml(path, bytes, options, diagnostics);
}

} // namespace hemi::io
