#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"
#include "python/arrays.hpp"

#include <vector>

namespace hemi::python {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A scipy.sparse.csr_matrix of all rows, a copy.
py::object csr_matrix(const FormFactorMatrix& matrix);
/// Codes of visibility of all entries, a copy; None where they are not known.
py::object visibility_codes(const FormFactorMatrix& matrix);
/// F @ right, without the GIL.
/// @param right  [N] or [N, channels]
Doubles multiply(const FormFactorMatrix& matrix, const Doubles& right);
/// &RowBlock::environment or &RowBlock::blocked of all rows.
py::array_t<double> share_of_rows(const FormFactorMatrix& matrix, std::vector<double> RowBlock::*share);
/// Which rows were computed.
py::array_t<bool> known_rows(const FormFactorMatrix& matrix);
/// Sums of all rows.
py::array_t<double> row_sums_of(const FormFactorMatrix& matrix);

} // namespace hemi::python
