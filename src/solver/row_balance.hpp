#pragma once

#include "hemi/core/buried.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

#include <algorithm>
#include <cmath>

namespace hemi {

/// What leaves a patch, as the solvers see it. Sums that miss balance by rounding, or by what a sampled row
/// is wrong, must not make light: B grows by the factor 1 / (1 - rho - excess).
struct RowBalance {
    double defect = 0.0; ///< counts as F(i, i); see RadiosityProblem
    double lost = 0.0;   ///< share that no patch gets: 1 - sum - defect, without the rounding of that sum
};

/// @param sum  of the row's factors, with its diagonal
[[nodiscard]] inline RowBalance balance_row(double sum, double environment, double blocked) {
    constexpr double mendable = 0.01;
    const bool covered = blocked > buried_above;
    if (covered && sum + environment <= 1.0) {
        return {.lost = 1.0 - sum};
    }
    const double lost = covered ? environment : environment + blocked;
    const double defect = 1.0 - sum - lost;
    if (std::abs(defect) > mendable) {
        return {.lost = 1.0 - sum};
    }
    return {defect, lost};
}

/// F(i, i), 0 where not stored.
[[nodiscard]] inline double diagonal_of(const RowView& row, std::uint32_t i) {
    const auto found = std::lower_bound(row.columns.begin(), row.columns.end(), i);
    return found != row.columns.end() && *found == i
               ? static_cast<double>(row.values[static_cast<std::size_t>(found - row.columns.begin())])
               : 0.0;
}

} // namespace hemi
