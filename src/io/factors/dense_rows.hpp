#pragma once

#include "hemi/io/output_file.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

namespace hemi::io {

/// Writes N rows of N 32-bit floats, zeros included, little endian.
void write_dense_rows(OutputFile& output, const FormFactorMatrix& factors);

} // namespace hemi::io
