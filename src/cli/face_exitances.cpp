#include "cli/face_exitances.hpp"

#include "cli/arguments/option_values.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/table_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace hemi::cli {

namespace {

/// Columns with the exitances of the channels, which are one for all, or one each.
std::vector<std::optional<std::size_t>> exitance_columns(const Scene& scene, const io::TextTable& table,
                                                         const std::filesystem::path& path) {
    std::vector<std::optional<std::size_t>> columns;
    std::vector<std::string> names;
    for (const std::string& channel : scene.channels) {
        names.push_back("exitance_" + channel);
        columns.push_back(table.column(names.back()));
    }
    const auto one = table.column("exitance");
    const bool any = std::any_of(columns.begin(), columns.end(), [](const auto& column) { return column; });
    if (one && any) {
        throw InputError(
            fmt::format("{}: a column \"exitance\", for all channels, and columns for single ones; "
                        "leave one kind out",
                        path.string()));
    }
    if (!one && !any) {
        throw InputError(
            fmt::format("{}: no column \"exitance\", nor {}", path.string(), fmt::join(names, ", ")));
    }
    if (one) {
        std::fill(columns.begin(), columns.end(), one);
    }
    return columns;
}

double exitance_in(const io::TextTable& table, std::size_t row, std::size_t column,
                   const std::filesystem::path& path) {
    const std::string& text = table.rows[row][column];
    const std::optional<double> value = to_number(text);
    if (!value || !(*value >= 0.0) || !std::isfinite(*value)) {
        throw ParseError(path.string(), table.lines[row], 0,
                         fmt::format("{} '{}'; must be a finite number that is not negative",
                                     table.columns[column], text));
    }
    return *value;
}

} // namespace

void set_exitances(Scene& scene, const std::filesystem::path& path) {
    const io::TextTable table = io::read_table(path);
    const auto index = table.column("index");
    if (!index) {
        throw InputError(fmt::format("{}: no column \"index\", the numbers of faces from 0", path.string()));
    }
    const auto columns = exitance_columns(scene, table, path);
    const std::vector<std::uint32_t> number_of = face_numbers(scene.surfaces);
    const std::uint32_t faces =
        number_of.empty() ? 0 : *std::max_element(number_of.begin(), number_of.end()) + 1;
    std::vector<std::optional<std::size_t>> row_of(faces);
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const std::string& text = table.rows[row][*index];
        const std::optional<double> number = to_number(text);
        if (!number || !(*number >= 0.0 && *number < faces) || *number != std::floor(*number)) {
            throw ParseError(path.string(), table.lines[row], 0,
                             fmt::format("index '{}'; must be the number of a face, 0 to {}", text,
                                         faces == 0 ? 0 : faces - 1));
        }
        std::optional<std::size_t>& entry = row_of[static_cast<std::size_t>(*number)];
        if (entry) {
            throw ParseError(
                path.string(), table.lines[row], 0,
                fmt::format("face {} a second time; it is on line {}, too", text, table.lines[*entry]));
        }
        entry = row;
    }
    std::map<std::pair<std::uint32_t, std::vector<double>>, std::uint32_t> made;
    for (std::size_t s = 0; s < scene.surfaces.size(); ++s) {
        const std::optional<std::size_t> row = row_of[number_of[s]];
        if (!row) {
            continue;
        }
        Surface& surface = scene.surfaces[s];
        std::vector<double> exitance = scene.materials[surface.material].exitance;
        for (std::size_t c = 0; c < columns.size(); ++c) {
            if (columns[c] && !table.rows[*row][*columns[c]].empty()) {
                exitance[c] = exitance_in(table, *row, *columns[c], path);
            }
        }
        if (exitance == scene.materials[surface.material].exitance) {
            continue;
        }
        const auto [entry, is_new] = made.try_emplace({surface.material, exitance},
                                                      static_cast<std::uint32_t>(scene.materials.size()));
        if (is_new) {
            Material material = scene.materials[surface.material];
            material.exitance = std::move(exitance);
            scene.materials.push_back(std::move(material));
        }
        surface.material = entry->second;
    }
}

} // namespace hemi::cli
