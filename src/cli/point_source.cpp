#include "cli/point_source.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/core/text.hpp"
#include "hemi/io/table_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hemi::cli {

namespace {

const std::vector<std::string> position_columns{"x", "y", "z"};
const std::vector<std::string> normal_columns{"nx", "ny", "nz"};

double number_in(const std::filesystem::path& path, const io::TextTable& table, std::size_t row,
                 std::size_t column) {
    try {
        return parse_number(table.columns[column], table.rows[row][column]);
    } catch (const InvalidArgument& error) {
        throw ParseError(path.string(), table.lines[row], 0, error.what());
    }
}

Vec3 vector_in(const std::filesystem::path& path, const io::TextTable& table, std::size_t row,
               const std::array<std::size_t, 3>& columns) {
    return {number_in(path, table, row, columns[0]), number_in(path, table, row, columns[1]),
            number_in(path, table, row, columns[2])};
}

/// @return nothing if none of them is there
std::optional<std::array<std::size_t, 3>> find_columns(const std::filesystem::path& path,
                                                       const io::TextTable& table,
                                                       const std::vector<std::string>& names) {
    std::array<std::size_t, 3> found{};
    std::vector<std::string> missing;
    for (std::size_t k = 0; k < names.size(); ++k) {
        if (const auto column = table.column(names[k])) {
            found[k] = *column;
        } else {
            missing.push_back(names[k]);
        }
    }
    if (missing.size() == names.size()) {
        return std::nullopt;
    }
    if (!missing.empty()) {
        throw InputError(fmt::format("{}: no column \"{}\" beside the others of {}", path.string(),
                                     missing.front(), fmt::join(names, ", ")));
    }
    return found;
}

} // namespace

std::vector<Receiver> read_points(const std::filesystem::path& path) {
    const io::TextTable table = io::read_table(path);
    std::vector<std::string> known = position_columns;
    known.insert(known.end(), normal_columns.begin(), normal_columns.end());
    for (auto name = table.columns.begin(); name != table.columns.end(); ++name) {
        if (std::find(known.begin(), known.end(), *name) == known.end()) {
            throw InputError(fmt::format("{}: unknown column \"{}\"; a table of points has x, y, z and, "
                                         "where they have normals, nx, ny, nz",
                                         path.string(), *name));
        }
        if (std::find(table.columns.begin(), name, *name) != name) {
            throw InputError(fmt::format("{}: two columns \"{}\"", path.string(), *name));
        }
    }
    const auto positions = find_columns(path, table, position_columns);
    const auto normals = find_columns(path, table, normal_columns);
    if (!positions) {
        throw InputError(fmt::format("{}: no columns x, y, z", path.string()));
    }
    if (table.rows.empty()) {
        throw InputError(fmt::format("{}: no points", path.string()));
    }
    std::vector<Receiver> points;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        Receiver& point = points.emplace_back();
        point.position = vector_in(path, table, row, *positions);
        const auto is_empty = [&](std::size_t column) { return table.rows[row][column].empty(); };
        if (!normals || std::all_of(normals->begin(), normals->end(), is_empty)) {
            continue;
        }
        const Vec3 normal = vector_in(path, table, row, *normals);
        const double largest = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
        if (!(largest > 0.0)) {
            throw ParseError(path.string(), table.lines[row], 0,
                             "a normal of length 0; leave its cells empty for a point without one");
        }
        point.normal = glm::normalize(normal / largest);
    }
    return points;
}

PointGrid points_of_grid(const PatchMesh& mesh, const PointsArguments::Grid& wanted) {
    const std::vector<std::string>& groups = mesh.groups();
    const auto group = std::find(groups.begin(), groups.end(), wanted.group);
    if (group == groups.end()) {
        throw InvalidArgument(fmt::format("--grid {}: the scene has no such group{}", wanted.group,
                                          did_you_mean_or_list(wanted.group, groups)));
    }
    PointGrid grid = make_point_grid(mesh, static_cast<std::uint32_t>(group - groups.begin()), wanted.spacing,
                                     wanted.height);
    if (grid.points.empty()) {
        throw InvalidArgument(fmt::format("--grid {}: a spacing of {} leaves no point on its faces",
                                          wanted.group, number_text(wanted.spacing)));
    }
    return grid;
}

} // namespace hemi::cli
