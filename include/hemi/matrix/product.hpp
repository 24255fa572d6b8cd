#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <span>

namespace hemi {

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
