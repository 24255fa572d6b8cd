#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/pipeline/radiosity.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Radiosity at a point by a row of its own: E + rho (sum_j F_j B_j + e B_env).
/// @param row        of the point, over the patches
/// @param values     what patches reflect and radiate
/// @param radiosity  B, N·channels
/// @param host       patch that the point lies on
/// @param light      gets a value a channel
template <class Number>
void gathered_radiosity(const RowView& row, const PatchValues& values, std::span<const double> radiosity,
                        std::uint32_t host, std::span<Number> light) {
    const std::uint32_t channels = values.channels;
    std::vector<double> sum(channels, 0.0);
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        const double* const source = radiosity.data() + std::size_t{row.columns[k]} * channels;
        for (std::uint32_t c = 0; c < channels; ++c) {
            sum[c] += static_cast<double>(row.values[k]) * source[c];
        }
    }
    for (std::uint32_t c = 0; c < channels; ++c) {
        const std::size_t at = std::size_t{host} * channels + c;
        const double from_environment =
            values.environment.empty() ? 0.0 : row.environment * values.environment[c];
        light[c] =
            static_cast<Number>(values.exitance[at] + values.reflectance[at] * (sum[c] + from_environment));
    }
}

} // namespace hemi
