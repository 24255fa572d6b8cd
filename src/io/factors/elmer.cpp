#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "io/factors/triples.hpp"
#include "io/formats/binary_output.hpp"
#include "io/formats/text_output.hpp"

#include <cstdint>

namespace hemi::io {

namespace {

void write_text(const std::filesystem::path& path, const FormFactorMatrix& factors) {
    TextOutput output(path);
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        output.print(FMT_COMPILE("{}\n"), row.columns.size());
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            output.print(FMT_COMPILE("{} {} {:.9g}\n"), i + 1, row.columns[k] + 1, row.values[k]);
        }
    }
    output.commit();
}

void write_binary(const std::filesystem::path& path, const FormFactorMatrix& factors) {
    BinaryOutput output(path);
    output.put(static_cast<std::int32_t>(factors.size()));
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        output.put(static_cast<std::int32_t>(row.columns.size()));
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            output.put(static_cast<std::int32_t>(row.columns[k] + 1));
            output.put(static_cast<double>(row.values[k]));
        }
    }
    output.commit();
}

} // namespace

void write_elmer(const std::filesystem::path& path, const FormFactorMatrix& factors, ElmerFormat format) {
    require_all_known(factors, "an Elmer file");
    if (format == ElmerFormat::text) {
        write_text(path, factors);
    } else {
        write_binary(path, factors);
    }
}

} // namespace hemi::io
