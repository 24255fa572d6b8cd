#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/matrix/source_clusters.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace hemi {

/// Calls `visit(j, F(i, j))` for the entries of a row. What comes from a cluster of patches is shared out
/// among them by their weights; then patches come in no order, and one of area 0 may come with 0.
template <class Visit>
void visit_sources(const FormFactorMatrix& factors, const RowView& row, const Visit& visit) {
    const std::uint32_t patches = factors.size();
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        const auto value = static_cast<double>(row.values[k]);
        if (row.columns[k] < patches) {
            visit(row.columns[k], value);
            continue;
        }
        const std::uint32_t cluster = row.columns[k] - patches;
        const SourceClusters& clusters = *factors.clusters();
        for (const std::uint32_t j : clusters.patches(cluster)) {
            visit(j, value * clusters.share(j, cluster));
        }
    }
}

/// F X: of radiosities X the irradiance that comes from patches. Sums in double, in column order: the same
/// bits on any number of threads. Rows that are not known give 0.
/// @param factors   N rows
/// @param values    X, N·channels: channel c of patch j at [j·channels + c]
/// @param channels  columns of X, all multiplied at once
/// @param product   N·channels, overwritten
/// @throws InvalidArgument if sizes do not match
void multiply(const FormFactorMatrix& factors, std::span<const double> values, std::uint32_t channels,
              std::span<double> product);

} // namespace hemi
