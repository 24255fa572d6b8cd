#include "cli/point_source.hpp"

#include "cli/arguments/option_values.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/core/text.hpp"
#include "hemi/io/table_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

/// Those that are not there are not numbers.
std::vector<double> values_in(const std::filesystem::path& path, const io::TextTable& table,
                              std::size_t column) {
    std::vector<double> values;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        values.push_back(table.rows[row][column].empty() ? std::numeric_limits<double>::quiet_NaN()
                                                         : number_in(path, table, row, column));
    }
    return values;
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

void refuse_repeated(const std::filesystem::path& path, const io::TextTable& table) {
    for (auto name = table.columns.begin(); name != table.columns.end(); ++name) {
        if (std::find(table.columns.begin(), name, *name) != name) {
            throw InputError(fmt::format("{}: two columns \"{}\"", path.string(), *name));
        }
    }
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
    }
    refuse_repeated(path, table);
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

PointTable read_point_table(const std::filesystem::path& path, std::string_view column) {
    const io::TextTable table = io::read_table(path);
    refuse_repeated(path, table);
    const auto positions = find_columns(path, table, position_columns);
    if (!positions) {
        throw InputError(fmt::format("{}: no columns x, y, z", path.string()));
    }
    if (table.rows.empty()) {
        throw InputError(fmt::format("{}: no points", path.string()));
    }
    PointTable points;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        points.positions.push_back(vector_in(path, table, row, *positions));
    }
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        const std::string& name = table.columns[c];
        const auto is = [&name](const std::vector<std::string>& names) {
            return std::find(names.begin(), names.end(), name) != names.end();
        };
        if (is(position_columns) || is(normal_columns)) {
            continue;
        }
        try {
            points.columns.push_back({name, unit_of_column(name), values_in(path, table, c)});
        } catch (const ParseError&) { // words, such as names of rooms; among numbers they are slips
            if (name == column || std::any_of(table.rows.begin(), table.rows.end(), [c](const auto& row) {
                    return to_number(row[c]).has_value();
                })) {
                throw;
            }
        }
    }
    return points;
}

std::optional<std::size_t> dots_column(const DotOptions& options, const PointTable& table) {
    std::vector<std::string> names;
    for (const PointTable::Column& column : table.columns) {
        names.push_back(column.name);
    }
    if (options.column.empty()) {
        return names.empty() ? std::nullopt : std::optional<std::size_t>(0);
    }
    const auto found = std::find(names.begin(), names.end(), options.column);
    if (found == names.end() && options.column == "none") {
        return std::nullopt;
    }
    if (found == names.end()) {
        throw InvalidArgument(fmt::format("--column {}: {} has no such column of values{}", options.column,
                                          options.points->string(),
                                          did_you_mean_or_list(options.column, names)));
    }
    return static_cast<std::size_t>(found - names.begin());
}

Dots read_dots(const DotOptions& options, const Bounds& scene) {
    const PointTable table = read_point_table(*options.points, options.column);
    return make_dots(table, dots_column(options, table), scene);
}

std::string unit_of_column(std::string_view name) {
    if (name.starts_with("daylight_factor")) {
        return "%";
    }
    return name.ends_with("_temperature") || name.starts_with("plane_") ? "K" : "";
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
