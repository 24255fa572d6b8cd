#pragma once

#include "hemi/core/buried.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Row sums sum_j F(i, j) over the known rows.
struct RowSums {
    double min = 0.0;                 ///< smallest sum
    double max = 0.0;                 ///< largest sum
    double mean = 0.0;                ///< of the sums
    double environment_max = 0.0;     ///< largest e_i
    double blocked_max = 0.0;         ///< largest b_i
    double balance_error_max = 0.0;   ///< largest |sum + e + b - 1| of a row that is not covered
    std::uint32_t known = 0;          ///< rows that were computed
    std::uint32_t leaking = 0;        ///< rows with e_i > 0
    std::uint32_t covered = 0;        ///< rows with b_i > buried_above
    std::uint32_t partly_blocked = 0; ///< rows with 0 < b_i <= buried_above
};

/// Row sums, environment and blocked shares of all known rows.
[[nodiscard]] RowSums row_sums(const FormFactorMatrix& factors);

/// How far A_i F(i, j) and A_j F(j, i) are apart, over pairs of known rows of which one is stored.
/// Relative error of a pair: |x_ij - x_ji| / max(x_ij, x_ji), x_ij = A_i F(i, j).
struct Reciprocity {
    double rms = 0.0;          ///< of F(i, j) - F(j, i)·A_j / A_i over the pairs, absolute
    double max = 0.0;          ///< largest such difference
    double relative_rms = 0.0; ///< of the relative error, over pairs with F > 1e-4 either way
    double relative_max = 0.0; ///< largest relative error, over all pairs
    std::uint32_t worst_i = 0; ///< one patch of the pair of the largest difference
    std::uint32_t worst_j = 0; ///< its other patch
    std::uint64_t pairs = 0;   ///< that were compared
};

/// Compares both directions of all pairs. Memory: O(N). The same bits on any number of threads.
/// @param factors  N rows
/// @param areas    N areas
/// @throws InvalidArgument for clusters of sources, which see nothing
[[nodiscard]] Reciprocity reciprocity(const FormFactorMatrix& factors, std::span<const double> areas);

/// Whether A_i F(i, j) and A_j F(j, i) differ by no more than the rounding of both to floats.
[[nodiscard]] bool is_reciprocal(const Reciprocity& reciprocity);

/// F summed over groups of patches, area-weighted on the leaving side:
/// F(g, h) = sum_{i in g} A_i sum_{j in h} F(i, j) / sum_{i in g} A_i. A group of which nothing is left, of
/// area 0, is blocked: b is 1, its other shares are 0.
struct GroupFactors {
    std::uint32_t groups = 0;        ///< their number
    std::vector<double> areas;       ///< per group
    std::vector<double> factors;     ///< groups x groups, row g: what leaves g
    std::vector<double> environment; ///< per group, area-weighted mean of e
    std::vector<double> blocked;     ///< per group, area-weighted mean of b
};

/// Sums the rows of all patches by groups.
/// @param factors   N rows, all known
/// @param areas     N areas
/// @param group_of  group of every patch, below `groups`
/// @param groups    number of groups
/// @throws InvalidArgument if a row is unknown or sizes differ.
[[nodiscard]] GroupFactors group_factors(const FormFactorMatrix& factors, std::span<const double> areas,
                                         std::span<const std::uint32_t> group_of, std::uint32_t groups);

} // namespace hemi
