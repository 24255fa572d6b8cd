#include "io/factors/triples.hpp"

#include "hemi/core/error.hpp"
#include "io/factors/rows_builder.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::io {

void Triples::add(std::string_view row, std::string_view column, std::string_view value, std::uint64_t line,
                  std::uint64_t first, std::uint64_t rows) {
    const auto fail = [&](const std::string& message) { throw ParseError(file_, line, 0, message); };
    std::uint64_t indices[2] = {};
    for (int k = 0; k < 2; ++k) {
        const std::string_view word = k == 0 ? row : column;
        const auto index = parse_integer<std::uint64_t>(word);
        if (!index || *index < first || *index - first >= rows) {
            fail(fmt::format("{} {}; must be a whole number from {} to {}", k == 0 ? "row" : "column",
                             in_quotes(word), first, rows + first - 1));
        }
        indices[k] = *index - first;
        extent_ = std::max(extent_, indices[k] + 1);
    }
    const auto number = parse_number(value);
    if (!number || !(*number >= 0.0 && *number <= std::numeric_limits<float>::max())) {
        fail(fmt::format("value {}; a form factor must be finite and not negative", in_quotes(value)));
    }
    entries_.push_back({static_cast<std::uint32_t>(indices[0]), static_cast<std::uint32_t>(indices[1]),
                        static_cast<float>(*number), static_cast<std::uint32_t>(line)});
}

void Triples::sort() {
    const auto before = [](const Entry& a, const Entry& b) {
        return a.key() != b.key() ? a.key() < b.key() : a.line < b.line;
    };
    if (!std::is_sorted(entries_.begin(), entries_.end(), before)) {
        std::sort(entries_.begin(), entries_.end(), before);
    }
    const auto twice = std::adjacent_find(entries_.begin(), entries_.end(),
                                          [](const Entry& a, const Entry& b) { return a.key() == b.key(); });
    if (twice != entries_.end()) {
        throw ParseError(
            file_, std::next(twice)->line, 0,
            fmt::format("the entry of line {} again; there must be one for a row and column", twice->line));
    }
}

FormFactorMatrix Triples::matrix(std::uint32_t rows) {
    sort();
    RowsBuilder builder(rows);
    auto entry = entries_.begin();
    for (std::uint32_t row = 0; row < rows; ++row) {
        for (; entry != entries_.end() && entry->row == row; ++entry) {
            builder.add(entry->column, entry->value);
        }
        (void)builder.end_row(); // sort() has found what is there twice
    }
    return builder.take();
}

void require_all_known(const FormFactorMatrix& factors, std::string_view format) {
    if (!factors.all_known()) {
        throw InvalidArgument(fmt::format(
            "some rows were not computed, which {} cannot say; compute all rows, or use .hff", format));
    }
}

} // namespace hemi::io
