#pragma once

#include "hemi/io/factor_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/vtp_file.hpp"

#include <cstdint>
#include <vector>

/// What `.vtp` files show of every patch.
namespace hemi::cli {

/// Reflectance, exitance, irradiance and radiosity by channel; row balance; estimated errors where stored.
[[nodiscard]] std::vector<io::CellArray> cell_data(const io::ResultFile& result, const PatchMesh& mesh);

/// Row balance and, where it is known, the estimated error of every row.
[[nodiscard]] std::vector<io::CellArray> cell_data(const io::FactorFile& file);

/// F(row, j) at every patch j, named "F_row". @throws InvalidArgument if there is no such row, or it is not
/// known
[[nodiscard]] io::CellArray row_data(const FormFactorMatrix& factors, std::uint32_t row);

} // namespace hemi::cli
