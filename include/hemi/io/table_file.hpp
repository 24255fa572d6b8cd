#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::io {

/// A table as CSV files hold it.
struct TextTable {
    std::vector<std::string> columns;           ///< names, from the first line
    std::vector<std::vector<std::string>> rows; ///< a cell for every column
    std::vector<std::size_t> lines;             ///< of every row, where in the file it is, from 1

    /// Index of the column of that name, if there is one.
    [[nodiscard]] std::optional<std::size_t> column(std::string_view name) const;
};

/// Reads a CSV file: a line of names, then lines of as many cells, with commas between them; cells with
/// commas are in double quotes. Empty lines and lines that begin with # are left out.
/// @throws ParseError or InputError with file, line and what is wrong
[[nodiscard]] TextTable read_table(const std::filesystem::path& path);

/// A line with the names of the columns, then the rows.
/// @throws InvalidArgument for rows of another length; IoError
void write_table(const std::filesystem::path& path, const TextTable& table);

} // namespace hemi::io
