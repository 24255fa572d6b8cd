#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

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

    /// Gets values for more patches, 0, or loses some.
    void resize(std::uint32_t patches) { values_.resize(std::size_t{patches} * stride_, 0.0); }

    [[nodiscard]] std::size_t stride() const noexcept { return stride_; }
    [[nodiscard]] double* patch(std::uint32_t i) { return values_.data() + i * stride_; }
    [[nodiscard]] const double* patch(std::uint32_t i) const { return values_.data() + i * stride_; }
    /// All patches' values, one after the other.
    [[nodiscard]] std::span<double> values() noexcept { return values_; }

private:
    std::size_t stride_;
    std::vector<double> values_;
};

/// The field with the means of the clusters of a matrix, if it has any, behind the values of the patches:
/// what rows of clusters are multiplied by.
[[nodiscard]] ChannelField with_clusters(ChannelField field, const FormFactorMatrix& factors);
/// Finds these means again.
void fill_clusters(ChannelField& field, const FormFactorMatrix& factors);

/// Sums F(i, j)·x_j over the entries of a row, per channel, by the best instruction set that the processor
/// has: the same bits by all of them.
/// @param sums  x.stride() values
void row_product(const RowView& row, const ChannelField& x, double* sums);

} // namespace hemi
