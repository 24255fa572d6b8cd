#include "io/factors/dense_rows.hpp"

#include <algorithm>
#include <bit>
#include <vector>

namespace hemi::io {

static_assert(std::endian::native == std::endian::little, "files are little endian; swap bytes here");

void write_dense_rows(OutputFile& output, const FormFactorMatrix& factors) {
    std::vector<float> line(factors.size());
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        std::fill(line.begin(), line.end(), 0.0f);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            line[row.columns[k]] = row.values[k];
        }
        output.write(line.data(), line.size() * sizeof(float));
    }
}

} // namespace hemi::io
