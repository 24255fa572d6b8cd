#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"
#include "matrix/pair_product.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace hemi {

/// Products with the symmetric matrix of exchange areas, X = A F: x_ij = A_i F(i, j) = A_j F(j, i) is taken
/// from the entry right of the diagonal, so that X is symmetric to the last bit. The rows must be reciprocal.
class ExchangeProduct {
public:
    /// @param factors  N rows, which must outlive the product
    /// @param areas    N areas, likewise
    /// @param stride   values a patch, side by side: 1, 2 or a multiple of 4
    ExchangeProduct(const FormFactorMatrix& factors, std::span<const double> areas, std::size_t stride);

    /// y_i = sum_j x_ij z_j for every known row i; y of unknown rows lacks part of their pairs.
    /// @param diagonal      N factors F(i, i) to be used, x_ii = A_i diagonal[i]
    /// @param z             N·stride values
    /// @param y             N·stride values, overwritten
    /// @param with_unknown  whether z is not 0 in rows that are unknown
    /// @throws InvalidArgument for spans of other sizes
    void apply(std::span<const double> diagonal, std::span<const double> z, std::span<double> y,
               bool with_unknown);

private:
    const FormFactorMatrix& factors_;
    std::span<const double> areas_;
    std::size_t stride_;
    bool all_known_;
    PairProduct pairs_;
};

} // namespace hemi
