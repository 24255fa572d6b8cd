#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/output_file.hpp"
#include "io/factors/rows_builder.hpp"
#include "io/factors/triples.hpp"
#include "io/formats/binary_scan.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <bit>
#include <limits>

namespace hemi::io {

namespace {

class ElmerTextReader {
public:
    explicit ElmerTextReader(const std::filesystem::path& path)
        : file_(path.string()), text_(read_file(path)), lines_(text_), triples_(file_) {}

    FormFactorMatrix read() {
        std::uint64_t rows = 0;
        while (next_line()) {
            ++rows;
            const auto count = parse_integer<std::uint64_t>(trim(line_));
            if (!count) {
                fail(
                    fmt::format("{}; must be the number of entries of row {}", in_quotes(trim(line_)), rows));
            }
            for (std::uint64_t k = 0; k < *count; ++k) {
                read_entry(rows);
            }
        }
        if (rows == 0 || triples_.extent() > rows) {
            throw InputError(
                rows == 0 ? fmt::format("{}: no rows", file_)
                          : fmt::format("{}: column {}; there are {} rows", file_, triples_.extent(), rows));
        }
        return triples_.matrix(static_cast<std::uint32_t>(rows));
    }

private:
    void read_entry(std::uint64_t row) {
        if (!next_line()) {
            fail(fmt::format("cut short in row {}", row));
        }
        std::string_view rest = line_;
        const std::string_view first = next_word(rest);
        if (parse_integer<std::uint64_t>(first) != row) {
            fail(fmt::format("row {}; must be {}, the row of its place", in_quotes(first), row));
        }
        const std::string_view column = next_word(rest);
        triples_.add(first, column, next_word(rest), lines_.number(), 1, most_rows(text_.size()));
        if (!trim(rest).empty()) {
            fail(
                fmt::format("{} after the factor; a line must be: row column factor", in_quotes(trim(rest))));
        }
    }

    bool next_line() {
        while (lines_.next(line_)) {
            if (!trim(line_).empty()) {
                return true;
            }
        }
        return false;
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw ParseError(file_, lines_.number(), 0, message);
    }

    std::string file_;
    std::string text_;
    Lines lines_;
    std::string_view line_;
    Triples triples_;
};

class ElmerBinaryReader {
public:
    explicit ElmerBinaryReader(const std::filesystem::path& path)
        : file_(path.string()), bytes_(read_file(path)) {}

    FormFactorMatrix read() {
        const auto rows = take<std::int32_t>();
        if (rows <= 0 || static_cast<std::uint64_t>(rows) > bytes_.size() / sizeof(std::int32_t)) {
            fail(fmt::format("{} rows in a file of {} bytes; that cannot be", rows, bytes_.size()));
        }
        RowsBuilder builder(static_cast<std::uint32_t>(rows));
        for (std::int32_t row = 1; row <= rows; ++row) {
            const auto count = take<std::int32_t>();
            if (count < 0 || count > rows) {
                fail(fmt::format("row {} of {} entries; must be 0 to {}", row, count, rows));
            }
            for (std::int32_t k = 0; k < count; ++k) {
                const auto column = take<std::int32_t>();
                if (column < 1 || column > rows) {
                    fail(fmt::format("row {}: column {}; must be from 1 to {}", row, column, rows));
                }
                const auto value = take<double>();
                if (!(value >= 0.0 && value <= static_cast<double>(std::numeric_limits<float>::max()))) {
                    fail(fmt::format("F({}, {}) = {}; must be finite and not negative", row, column, value));
                }
                builder.add(static_cast<std::uint32_t>(column - 1), static_cast<float>(value));
            }
            if (const auto twice = builder.end_row()) {
                fail(fmt::format("row {}: column {} is there twice", row, *twice + 1));
            }
        }
        if (at_ != bytes_.size()) {
            fail(fmt::format("{} bytes after the last row", bytes_.size() - at_));
        }
        return builder.take();
    }

private:
    template <class Number>
    Number take() {
        if (bytes_.size() - at_ < sizeof(Number)) {
            fail("cut short");
        }
        const auto number = load<Number>(bytes_.data() + at_, std::endian::little);
        at_ += sizeof(Number);
        return number;
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(fmt::format("{}: byte {}: {}", file_, at_, message));
    }

    std::string file_;
    std::string bytes_;
    std::size_t at_ = 0;
};

} // namespace

FormFactorMatrix read_elmer(const std::filesystem::path& path, ElmerFormat format) {
    return format == ElmerFormat::text ? ElmerTextReader(path).read() : ElmerBinaryReader(path).read();
}

} // namespace hemi::io
