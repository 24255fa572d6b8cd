#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"
#include "matrix/pair_product.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Products with the symmetric matrix of exchange areas, X = A F: x_ij = A_i F(i, j) = A_j F(j, i) is taken
/// from the entry right of the diagonal, so that X is symmetric to the last bit. The rows must be reciprocal.
///
/// Rows with clusters are not: of these, X is the mean of A F and its transpose, in which what a patch gives
/// a cluster is shared out among its patches by their weights. It is symmetric but for rounding. What goes
/// through clusters can be scaled, by d_i d_j.
class ExchangeProduct {
public:
    /// @param factors  N rows, which must outlive the product; all known if they have clusters
    /// @param areas    N areas, likewise
    /// @param stride   values a patch, side by side: 1, 2 or a multiple of 4
    /// @param scale    d of rows with clusters, N values, which must outlive the product, too; empty: 1
    /// @throws InvalidArgument for unknown rows with clusters
    ExchangeProduct(const FormFactorMatrix& factors, std::span<const double> areas, std::size_t stride,
                    std::span<const double> scale = {});

    /// y_i = sum_j x_ij z_j for every known row i; y of unknown rows lacks part of their pairs.
    /// @param diagonal      N factors F(i, i) to be used, x_ii = A_i diagonal[i]
    /// @param z             N·stride values
    /// @param y             N·stride values, overwritten
    /// @param with_unknown  whether z is not 0 in rows that are unknown
    /// @throws InvalidArgument for spans of other sizes
    void apply(std::span<const double> diagonal, std::span<const double> z, std::span<double> y,
               bool with_unknown);

private:
    void apply_clusters(std::span<const double> z, std::span<double> y);
    [[nodiscard]] double scale(std::uint32_t i) const { return scale_.empty() ? 1.0 : scale_[i]; }

    const FormFactorMatrix& factors_;
    std::span<const double> areas_;
    std::size_t stride_;
    std::span<const double> scale_;
    bool all_known_;
    PairProduct<FormFactorMatrix> pairs_;
    std::vector<double> from_; ///< z with the means of clusters, if there are any
    std::vector<double> to_;   ///< what patches and clusters get
};

} // namespace hemi
