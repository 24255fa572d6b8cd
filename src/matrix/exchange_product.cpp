#include "matrix/exchange_product.hpp"

#include "hemi/core/error.hpp"
#include "hemi/matrix/source_clusters.hpp"

#include <algorithm>

namespace hemi {

ExchangeProduct::ExchangeProduct(const FormFactorMatrix& factors, std::span<const double> areas,
                                 std::size_t stride, std::span<const double> scale)
    : factors_(factors), areas_(areas), stride_(stride), scale_(scale), all_known_(factors.all_known()),
      pairs_(factors, slice_rows(factors), factors.columns(),
             factors.clusters() == nullptr ? PairEntries::right_of_diagonal : PairEntries::all, stride) {
    if (factors.clusters() != nullptr) {
        if (!all_known_) {
            throw InvalidArgument("exchange product: with clusters all rows must be known");
        }
        from_.resize(factors.columns() * stride);
        to_.resize(from_.size());
    }
}

void ExchangeProduct::apply(std::span<const double> diagonal, std::span<const double> z, std::span<double> y,
                            bool with_unknown) {
    const std::size_t size = factors_.size();
    if (diagonal.size() != size || z.size() != size * stride_ || y.size() != size * stride_) {
        throw InvalidArgument("exchange product: the spans do not have the sizes of the matrix");
    }
    const std::span<const RowBlock> blocks = factors_.blocks();
    if (factors_.clusters() != nullptr) {
        apply_clusters(z, y);
    } else {
        pairs_.apply([this](std::uint32_t i) { return areas_[i]; },
                     [](const RowView& row, std::uint32_t) {
                         return [values = row.values.data()](std::size_t k) {
                             return static_cast<double>(values[k]);
                         };
                     },
                     z.data(), y.data());
    }
    for (std::uint32_t i = 0; i < factors_.size(); ++i) {
        double* const y_i = y.data() + i * stride_;
        for (std::size_t c = 0; c < stride_; ++c) {
            y_i[c] += areas_[i] * diagonal[i] * z[i * stride_ + c];
        }
        if (with_unknown && !all_known_) {
            const RowBlock& block = block_of(blocks, i);
            visit_unknown_left(blocks, i, [&](std::uint64_t k) {
                const double exchange = areas_[i] * static_cast<double>(block.values[k]);
                for (std::size_t c = 0; c < stride_; ++c) {
                    y_i[c] += exchange * z[block.columns[k] * stride_ + c];
                }
            });
        }
    }
}

void ExchangeProduct::apply_clusters(std::span<const double> z, std::span<double> y) {
    const auto visit_values = [this](const auto& visit) {
        for (std::uint32_t i = 0; i < factors_.size(); ++i) {
            for (std::size_t k = i * stride_; k < (i + 1) * stride_; ++k) {
                visit(i, k);
            }
        }
    };
    visit_values([&](std::uint32_t i, std::size_t k) { from_[k] = scale(i) * z[k]; });
    factors_.clusters()->fill(from_, stride_);
    std::copy(z.begin(), z.end(), from_.begin());
    pairs_.apply([this](std::uint32_t i) { return 0.5 * areas_[i]; },
                 [this](const RowView& row, std::uint32_t i) {
                     return [values = row.values.data(), columns = row.columns.data(), size = factors_.size(),
                             far = scale(i)](std::size_t k) {
                         return static_cast<double>(values[k]) * (columns[k] < size ? 1.0 : far);
                     };
                 },
                 from_.data(), to_.data());
    std::copy_n(to_.begin(), y.size(), y.begin());
    std::fill_n(to_.begin(), y.size(), 0.0);
    factors_.clusters()->share_out(to_, stride_);
    visit_values([&](std::uint32_t i, std::size_t k) { y[k] += scale(i) * to_[k]; });
}

} // namespace hemi
