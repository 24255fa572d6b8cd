#include "matrix/exchange_product.hpp"

#include "hemi/core/error.hpp"

namespace hemi {

ExchangeProduct::ExchangeProduct(const FormFactorMatrix& factors, std::span<const double> areas,
                                 std::size_t stride)
    : factors_(factors), areas_(areas), stride_(stride), all_known_(factors.all_known()),
      pairs_(factors.blocks(), factors.size(), stride) {}

void ExchangeProduct::apply(std::span<const double> diagonal, std::span<const double> z, std::span<double> y,
                            bool with_unknown) {
    const std::size_t size = factors_.size();
    if (diagonal.size() != size || z.size() != size * stride_ || y.size() != size * stride_) {
        throw InvalidArgument("exchange product: the spans do not have the sizes of the matrix");
    }
    const std::span<const RowBlock> blocks = factors_.blocks();
    pairs_.apply([this](std::uint32_t i) { return areas_[i]; },
                 [](const RowBlock& block, std::uint32_t) {
                     return [values = block.values.data()](std::uint64_t k) {
                         return static_cast<double>(values[k]);
                     };
                 },
                 z.data(), y.data());
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

} // namespace hemi
