#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/output_file.hpp"
#include "io/factors/triples.hpp"
#include "io/formats/text_output.hpp"
#include "io/formats/text_scan.hpp"

#include <algorithm>

namespace hemi::io {

namespace {

constexpr std::string_view header = "i,j,F";

/// Takes the text up to the next comma, without blanks around it.
std::string_view next_field(std::string_view& rest) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    const std::string_view field = trim(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return field;
}

/// Whether some entry is in the last row or column.
bool tells_size(const FormFactorMatrix& factors) {
    const std::uint32_t last = factors.size() - 1;
    if (!factors.row(last).columns.empty()) {
        return true;
    }
    for (std::uint32_t i = 0; i < last; ++i) {
        const RowView row = factors.row(i);
        if (!row.columns.empty() && row.columns.back() == last) {
            return true;
        }
    }
    return false;
}

} // namespace

void write_csv(const std::filesystem::path& path, const FormFactorMatrix& factors) {
    require_all_known(factors, "a .csv file");
    TextOutput output(path);
    output.print(FMT_COMPILE("{}\n"), header);
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            output.print(FMT_COMPILE("{},{},{:.9g}\n"), i, row.columns[k], row.values[k]);
        }
    }
    // The size is nowhere else: a zero in the last corner tells it where the last patch sees and is seen by
    // none.
    const std::uint32_t last = factors.size() - 1;
    if (factors.size() > 0 && !tells_size(factors)) {
        output.print(FMT_COMPILE("{},{},0\n"), last, last);
    }
    output.commit();
}

FormFactorMatrix read_csv(const std::filesystem::path& path) {
    const std::string file = path.string();
    const std::string text = read_file(path);
    Lines lines(text);
    std::string_view line;
    if (!lines.next(line) || trim(line) != header) {
        throw ParseError(file, 1, 0, fmt::format("{}; must be the header \"{}\"", in_quotes(line), header));
    }
    Triples triples(file);
    while (lines.next(line)) {
        if (trim(line).empty()) {
            continue;
        }
        if (std::count(line.begin(), line.end(), ',') != 2) {
            throw ParseError(file, lines.number(), 0,
                             fmt::format("{}; must be three fields: row, column, value", in_quotes(line)));
        }
        const std::string_view row = next_field(line);
        const std::string_view column = next_field(line);
        triples.add(row, column, next_field(line), lines.number(), 0, most_rows(text.size()));
    }
    if (triples.size() == 0) {
        throw InputError(fmt::format("{}: no entries, so the size of the matrix is not known", file));
    }
    return triples.matrix(static_cast<std::uint32_t>(triples.extent()));
}

} // namespace hemi::io
