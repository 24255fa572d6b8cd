#include "hemi/matrix/product.hpp"

#include "core/parallel_for.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace hemi {

void multiply(const FormFactorMatrix& factors, std::span<const double> values, std::uint32_t channels,
              std::span<double> product) {
    const std::size_t size = std::size_t{factors.size()} * channels;
    if (values.size() != size || product.size() != size) {
        throw InvalidArgument(fmt::format("a product of {} rows in {} channels, from {} values into {}",
                                          factors.size(), channels, values.size(), product.size()));
    }
    std::vector<double> with_means;
    if (factors.clusters() != nullptr) {
        with_means.assign(values.begin(), values.end());
        with_means.resize(std::size_t{factors.columns()} * channels);
        factors.clusters()->fill(with_means, channels);
        values = with_means;
    }
    parallel_for(factors.size(), FormFactorMatrix::block_rows, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::span<double> sums = product.subspan(i * channels, channels);
            std::fill(sums.begin(), sums.end(), 0.0);
            const RowView row = factors.row(static_cast<std::uint32_t>(i));
            for (std::size_t k = 0; k < row.columns.size(); ++k) {
                const std::size_t from = std::size_t{row.columns[k]} * channels;
                for (std::size_t c = 0; c < channels; ++c) {
                    sums[c] += double{row.values[k]} * values[from + c];
                }
            }
        }
    });
}

} // namespace hemi
