#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// One value per patch and channel, channels of a patch side by side and padded with zero channels to a width
/// that row_product takes in whole vectors. Every channel is summed in the same order whatever the padding.
class ChannelField {
public:
    ChannelField(std::uint32_t patches, std::uint32_t channels)
        : stride_(padded(channels)), values_(std::size_t{patches} * stride_, 0.0) {}

    /// Channels with padding: 1, 2 or a multiple of 4.
    [[nodiscard]] static std::size_t padded(std::uint32_t channels) {
        return channels <= 2 ? channels : (std::size_t{channels} + 3) / 4 * 4;
    }

    [[nodiscard]] std::size_t stride() const noexcept { return stride_; }
    [[nodiscard]] double* patch(std::uint32_t i) { return values_.data() + i * stride_; }
    [[nodiscard]] const double* patch(std::uint32_t i) const { return values_.data() + i * stride_; }
    /// All patches' values, one after the other.
    [[nodiscard]] std::span<double> values() noexcept { return values_; }

private:
    std::size_t stride_;
    std::vector<double> values_;
};

/// Sums F(i, j)·x_j over the entries of a row, for `width` neighbouring channels from `x` on.
template <std::size_t width>
void row_product_of_width(const RowView& row, const double* x, std::size_t stride, double* sums) {
    // Independent partial sums hide the latency of the additions.
    constexpr std::size_t lanes = 4;
    std::array<std::array<double, width>, lanes> partial{};
    const std::uint32_t* const columns = row.columns.data();
    const float* const values = row.values.data();
    const std::size_t count = row.columns.size();
    std::size_t k = 0;
    for (; k + lanes <= count; k += lanes) {
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const double factor = static_cast<double>(values[k + lane]);
            const double* const x_j = x + columns[k + lane] * stride;
            for (std::size_t c = 0; c < width; ++c) {
                partial[lane][c] += factor * x_j[c];
            }
        }
    }
    for (std::size_t lane = 0; k < count; ++k, ++lane) {
        const double factor = static_cast<double>(values[k]);
        const double* const x_j = x + columns[k] * stride;
        for (std::size_t c = 0; c < width; ++c) {
            partial[lane][c] += factor * x_j[c];
        }
    }
    for (std::size_t c = 0; c < width; ++c) {
        sums[c] = (partial[0][c] + partial[1][c]) + (partial[2][c] + partial[3][c]);
    }
}

/// Sums F(i, j)·x_j over the entries of a row, per channel.
/// @param sums  x.stride() values
inline void row_product(const RowView& row, const ChannelField& x, double* sums) {
    const std::size_t stride = x.stride();
    if (stride == 1) {
        row_product_of_width<1>(row, x.patch(0), 1, sums);
    } else if (stride == 2) {
        row_product_of_width<2>(row, x.patch(0), 2, sums);
    } else if (stride == 4) {
        row_product_of_width<4>(row, x.patch(0), 4, sums);
    } else {
        for (std::size_t c = 0; c < stride; c += 4) {
            row_product_of_width<4>(row, x.patch(0) + c, stride, sums + c);
        }
    }
}

} // namespace hemi
