#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <span>

namespace hemi {

/// Rows of a mesh some of whose patches were split: the parts have new rows; the rows of the other patches go
/// on, and what they send to parts follows from those rows by reciprocity, A_i F(i, j) = A_j F(j, i). Where
/// such a row sees the environment, e takes up the difference of the sums.
/// @param old      rows of the coarser mesh, those of patches that were not split known
/// @param fresh    rows of the finer mesh, those of the parts known
/// @param parents  of every patch of the finer mesh the patch of the coarser one that it lies in
/// @param areas    of the patches of the finer mesh
/// @throws InvalidArgument if sizes do not fit, or if one of them has visibilities and the other has not
[[nodiscard]] FormFactorMatrix split_rows(const FormFactorMatrix& old, const FormFactorMatrix& fresh,
                                          std::span<const std::uint32_t> parents,
                                          std::span<const double> areas);

} // namespace hemi
