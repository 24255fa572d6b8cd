#include "cli/cell_data.hpp"

#include "cli/solution.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <utility>

namespace hemi::cli {

namespace {

std::vector<io::CellArray> balance(std::vector<double> row_sum, std::vector<double> environment,
                                   std::vector<double> blocked) {
    return {{"row_sum", std::move(row_sum), {}},
            {"environment", std::move(environment), {}},
            {"blocked", std::move(blocked), {}}};
}

} // namespace

std::vector<io::CellArray> cell_data(const io::ResultFile& result, const PatchMesh& mesh) {
    std::vector<io::CellArray> arrays = balance(result.row_sum, result.environment, result.blocked);
    const std::vector<std::string>& channels = result.scene.channels;
    const std::vector<std::string> names = channels.size() > 1 ? channels : std::vector<std::string>();
    arrays.push_back({"radiosity", result.radiosity, names});
    arrays.push_back({"irradiance", result.irradiance, names});
    arrays.push_back({"exitance", patch_exitance(result.scene, mesh), names});
    arrays.push_back({"reflectance", patch_reflectance(result.scene, mesh), names});
    if (result.factor_error) {
        arrays.push_back({"row_error", result.factor_error->rows, {}});
    }
    if (result.radiosity_error) {
        arrays.push_back({"radiosity_error", result.radiosity_error->patches, names});
    }
    return arrays;
}

std::vector<io::CellArray> cell_data(const io::FactorFile& file) {
    std::vector<double> row_sum;
    std::vector<double> environment;
    std::vector<double> blocked;
    for (std::uint32_t i = 0; i < file.factors.size(); ++i) {
        const RowView row = file.factors.row(i);
        row_sum.push_back(row.sum());
        environment.push_back(row.environment);
        blocked.push_back(row.blocked);
    }
    std::vector<io::CellArray> arrays =
        balance(std::move(row_sum), std::move(environment), std::move(blocked));
    if (file.error) {
        arrays.push_back({"row_error", file.error->rows, {}});
    }
    return arrays;
}

io::CellArray row_data(const FormFactorMatrix& factors, std::uint32_t row) {
    if (row >= factors.size() || !factors.known(row)) {
        throw InvalidArgument(
            row >= factors.size()
                ? fmt::format("--row {}: there are {} rows, counted from 0", row, factors.size())
                : fmt::format("--row {}: was not computed", row));
    }
    io::CellArray array{fmt::format("F_{}", row), std::vector<double>(factors.size(), 0.0), {}};
    const RowView view = factors.row(row);
    for (std::size_t k = 0; k < view.columns.size(); ++k) {
        array.values[view.columns[k]] = static_cast<double>(view.values[k]);
    }
    return array;
}

} // namespace hemi::cli
