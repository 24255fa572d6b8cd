#include "hemi/io/table_file.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "io/formats/text_output.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::io {

namespace {

/// The cells of a line; nothing if a quote does not end.
std::optional<std::vector<std::string>> cells_of(std::string_view line) {
    std::vector<std::string> cells;
    while (true) {
        std::string cell;
        std::string_view rest = trim(line);
        if (!rest.empty() && rest.front() == '"') {
            std::size_t k = 1;
            for (; k < rest.size(); ++k) {
                if (rest[k] == '"') {
                    if (k + 1 >= rest.size() || rest[k + 1] != '"') {
                        break;
                    }
                    ++k;
                }
                cell += rest[k];
            }
            if (k >= rest.size()) {
                return std::nullopt;
            }
            rest.remove_prefix(k + 1);
            const std::size_t comma = rest.find(',');
            if (!trim(rest.substr(0, comma)).empty()) {
                return std::nullopt;
            }
            cells.push_back(std::move(cell));
            if (comma == std::string_view::npos) {
                return cells;
            }
            line = rest.substr(comma + 1);
            continue;
        }
        const std::size_t comma = line.find(',');
        cells.emplace_back(trim(line.substr(0, comma)));
        if (comma == std::string_view::npos) {
            return cells;
        }
        line = line.substr(comma + 1);
    }
}

} // namespace

std::optional<std::size_t> TextTable::column(std::string_view name) const {
    const auto found = std::find(columns.begin(), columns.end(), name);
    return found == columns.end() ? std::nullopt : std::optional<std::size_t>(found - columns.begin());
}

TextTable read_table(const std::filesystem::path& path) {
    const std::string file = path.string();
    const std::string text = read_file(path);
    std::string_view all = text;
    if (all.starts_with("\xef\xbb\xbf")) { // as spreadsheets begin
        all.remove_prefix(3);
    }
    Lines lines(all);
    TextTable table;
    std::string_view line;
    while (lines.next(line)) {
        if (trim(line).empty() || trim(line).front() == '#') {
            continue;
        }
        auto cells = cells_of(line);
        if (!cells) {
            throw ParseError(file, lines.number(), 0,
                             "a cell in quotes that does not end with one and a comma");
        }
        for (std::string& cell : *cells) {
            cell = to_utf8(cell);
        }
        if (table.columns.empty()) {
            table.columns = std::move(*cells);
            continue;
        }
        if (cells->size() != table.columns.size()) {
            throw ParseError(file, lines.number(), 0,
                             fmt::format("{} cells; the first line names {} columns", cells->size(),
                                         table.columns.size()));
        }
        table.rows.push_back(std::move(*cells));
        table.lines.push_back(lines.number());
    }
    if (table.columns.empty()) {
        throw InputError(
            fmt::format("{}: empty; a line with the names of the columns must come first", file));
    }
    return table;
}

void write_table(const std::filesystem::path& path, const TextTable& table) {
    TextOutput output(path);
    const auto write = [&](const std::vector<std::string>& cells) {
        if (cells.size() != table.columns.size()) {
            throw InvalidArgument(
                fmt::format("a row of {} cells for {} columns", cells.size(), table.columns.size()));
        }
        for (std::size_t c = 0; c < cells.size(); ++c) {
            output.print(FMT_COMPILE("{}{}"), c == 0 ? "" : ",", csv_field(cells[c]));
        }
        output.print(FMT_COMPILE("\n"));
    };
    write(table.columns);
    for (const std::vector<std::string>& row : table.rows) {
        write(row);
    }
    output.commit();
}

} // namespace hemi::io
