#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/output_file.hpp"
#include "io/factors/triples.hpp"
#include "io/formats/text_output.hpp"
#include "io/formats/text_scan.hpp"

#include <algorithm>

namespace hemi::io {

namespace {

class MtxReader {
public:
    explicit MtxReader(const std::filesystem::path& path)
        : file_(path.string()), text_(read_file(path)), lines_(text_), triples_(file_) {}

    FormFactorMatrix read() {
        read_banner();
        read_sizes();
        triples_.reserve(entries_);
        std::string_view line;
        while (next_data_line(line)) {
            if (triples_.size() == entries_) {
                fail(fmt::format("more entries than the {} that the size line says", entries_));
            }
            const std::string_view row = next_word(line);
            const std::string_view column = next_word(line);
            const std::string_view value = next_word(line);
            if (!trim(line).empty()) {
                fail(fmt::format("{} after the value; a line must be: row column value",
                                 in_quotes(trim(line))));
            }
            triples_.add(row, column, value, lines_.number(), 1, rows_);
        }
        if (triples_.size() != entries_) {
            fail(fmt::format("cut short: {} entries; the size line says {}", triples_.size(), entries_));
        }
        return triples_.matrix(static_cast<std::uint32_t>(rows_));
    }

private:
    void read_banner() {
        std::string_view line;
        std::string lower(lines_.next(line) ? line : std::string_view());
        std::transform(lower.begin(), lower.end(), lower.begin(),
                       [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
        std::string_view rest = lower;
        if (next_word(rest) != "%%matrixmarket") {
            fail("no Matrix Market file: the first line must start with %%MatrixMarket");
        }
        const bool good = next_word(rest) == "matrix" && next_word(rest) == "coordinate" &&
                          is_real(next_word(rest)) && next_word(rest) == "general" && trim(rest).empty();
        if (!good) {
            fail(fmt::format("{}; must be \"%%MatrixMarket matrix coordinate real general\"",
                             in_quotes(line)));
        }
    }

    static bool is_real(std::string_view word) { return word == "real" || word == "integer"; }

    void read_sizes() {
        std::string_view line;
        if (!next_data_line(line)) {
            fail("cut short: the line with rows, columns and entries is missing");
        }
        const auto rows = parse_integer<std::uint64_t>(next_word(line));
        const auto columns = parse_integer<std::uint64_t>(next_word(line));
        const auto entries = parse_integer<std::uint64_t>(next_word(line));
        if (!rows || !columns || !entries || !trim(line).empty()) {
            fail("must be three whole numbers: rows, columns, entries");
        }
        if (*rows != *columns) {
            fail(fmt::format("{} rows and {} columns; form factors must have as many of both", *rows,
                             *columns));
        }
        if (*rows > most_rows(text_.size()) || *entries > text_.size() / 6 + 1) { // "1 1 0\n"
            fail(fmt::format("{} rows and {} entries in a file of {} bytes; that cannot be", *rows, *entries,
                             text_.size()));
        }
        rows_ = *rows;
        entries_ = *entries;
    }

    bool next_data_line(std::string_view& line) {
        while (lines_.next(line)) {
            if (!trim(line).empty() && line[0] != '%') {
                return true;
            }
        }
        return false;
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw ParseError(file_, std::max<std::size_t>(lines_.number(), 1), 0, message);
    }

    std::string file_;
    std::string text_;
    Lines lines_;
    Triples triples_;
    std::uint64_t rows_ = 0;
    std::uint64_t entries_ = 0;
};

} // namespace

void write_mtx(const std::filesystem::path& path, const FormFactorMatrix& factors) {
    require_all_known(factors, "a Matrix Market file");
    TextOutput output(path);
    output.print(
        FMT_COMPILE("%%MatrixMarket matrix coordinate real general\n"
                    "% entry (i, j): share of what leaves patch i that arrives at patch j\n{} {} {}\n"),
        factors.size(), factors.size(), factors.entries());
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            output.print(FMT_COMPILE("{} {} {:.9g}\n"), i + 1, row.columns[k] + 1, row.values[k]);
        }
    }
    output.commit();
}

FormFactorMatrix read_mtx(const std::filesystem::path& path) {
    return MtxReader(path).read();
}

} // namespace hemi::io
