#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hemi::io {

/// Entries of a matrix in the order of a text file, made into a FormFactorMatrix of known rows.
class Triples {
public:
    explicit Triples(std::string file) : file_(std::move(file)) {}

    void reserve(std::size_t entries) { entries_.reserve(entries); }
    [[nodiscard]] std::size_t size() const { return entries_.size(); }

    /// Adds the entry that a line of text gives as three words.
    /// @param first  number of the first row and column in the file: 0 or 1
    /// @param rows   number of rows and columns
    /// @throws ParseError with the line
    void add(std::string_view row, std::string_view column, std::string_view value, std::uint64_t line,
             std::uint64_t first, std::uint64_t rows);

    /// One more than the largest row or column so far.
    [[nodiscard]] std::uint64_t extent() const { return extent_; }

    /// @throws ParseError with the line of an entry that is there twice.
    [[nodiscard]] FormFactorMatrix matrix(std::uint32_t rows);

private:
    struct Entry {
        std::uint32_t row;
        std::uint32_t column;
        float value;
        std::uint32_t line;

        [[nodiscard]] std::uint64_t key() const { return std::uint64_t{row} << 32 | column; }
    };

    void sort();

    std::string file_;
    std::vector<Entry> entries_;
    std::uint64_t extent_ = 0;
};

/// More rows than this in a file of that many bytes are a mistake, not a matrix: memory is not asked for.
[[nodiscard]] inline std::uint64_t most_rows(std::uint64_t file_bytes) {
    return std::min<std::uint64_t>(1'000'000 + file_bytes, std::numeric_limits<std::int32_t>::max());
}

/// @throws InvalidArgument if a row is unknown: the formats that others read cannot say so.
void require_all_known(const FormFactorMatrix& factors, std::string_view format);

} // namespace hemi::io
