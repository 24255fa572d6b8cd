#include "hemi/core/error.hpp"
#include "hemi/io/vtp_file.hpp"
#include "hemi/matrix/product.hpp"
#include "hemi/scene/thermal_exitance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hemi::io {

namespace {

std::vector<CellArray> balance_arrays(std::vector<double> row_sum, std::vector<double> environment,
                                      std::vector<double> back_faces) {
    return {{"row_sum", std::move(row_sum), {}},
            {"environment", std::move(environment), {}},
            {"blocked", std::move(back_faces), {}}};
}

void add_patch_of(const PatchParts& parts, std::vector<CellArray>& arrays) {
    if (parts.any()) {
        arrays.push_back({"patch_of", {parts.patch_of.begin(), parts.patch_of.end()}, {}});
    }
}

} // namespace

std::vector<CellArray> solution_arrays(const ResultFile& result, const PatchMesh& mesh) {
    const Solution& solution = result.solution;
    std::vector<CellArray> arrays =
        balance_arrays(solution.row_sum, solution.environment_share, solution.back_face_share);
    const std::vector<std::string>& channels = result.scene.channels;
    const std::vector<std::string> names = channels.size() > 1 ? channels : std::vector<std::string>();
    arrays.push_back({"radiosity", solution.radiosity, names});
    arrays.push_back({"irradiance", solution.irradiance, names});
    if (!solution.direct.empty()) {
        arrays.push_back({"direct", solution.direct, names});
    }
    arrays.push_back({"exitance",
                      solution.exitance.empty()
                          ? patch_values(mesh, result.scene.materials, &Material::exitance)
                          : solution.exitance,
                      names});
    std::vector<double> reflectance = reflectances_at(mesh, result.scene.materials, solution.temperature);
    arrays.push_back({"reflectance", reflectance, names});
    for (double& value : reflectance) {
        value = 1.0 - value;
    }
    arrays.push_back({"emissivity", std::move(reflectance), names});
    if (solution.factor_error) {
        arrays.push_back({"row_error", solution.factor_error->rows, {}});
    }
    if (solution.error) {
        arrays.push_back({"error", radiosity_errors(solution), names});
    }
    if (solution.error && solution.patch_size_error) {
        arrays.push_back({"error_factors", solution.error->patches, names});
        arrays.push_back({"error_patch_size", solution.patch_size_error->patches, names});
    }
    if (!solution.temperature.empty()) {
        arrays.push_back({"temperature", solution.temperature, {}});
        arrays.push_back({"net_flux", solution.net_flux, {}});
    }
    add_patch_of(result.parts, arrays);
    return arrays;
}

std::vector<CellArray> means_of_cells(std::vector<CellArray> arrays, const PatchParts& parts,
                                      std::span<const double> areas) {
    for (CellArray& array : arrays) {
        const bool is_temperature = array.name == "temperature";
        std::vector<double> known;
        for (double& value : array.values) {
            known.push_back(std::isfinite(value) ? 1.0 : 0.0);
            value = known.back() == 0.0 ? 0.0 : is_temperature ? std::pow(value, 4.0) : value;
        }
        const std::size_t components = std::max<std::size_t>(array.components.size(), 1);
        array.values = means_of_patches(parts, areas, array.values, components);
        known = means_of_patches(parts, areas, known, components);
        for (std::size_t k = 0; k < array.values.size(); ++k) {
            double& value = array.values[k];
            value /= known[k]; // not a number where nothing is
            value = is_temperature ? std::sqrt(std::sqrt(value)) : value;
        }
    }
    return arrays;
}

std::vector<CellArray> factor_arrays(const FormFactors& factors) {
    std::vector<double> row_sum;
    std::vector<double> environment;
    std::vector<double> back_faces;
    for (std::uint32_t i = 0; i < factors.matrix.size(); ++i) {
        const RowView row = factors.matrix.row(i);
        row_sum.push_back(row.sum());
        environment.push_back(row.environment);
        back_faces.push_back(row.blocked);
    }
    std::vector<CellArray> arrays =
        balance_arrays(std::move(row_sum), std::move(environment), std::move(back_faces));
    if (factors.error) {
        arrays.push_back({"row_error", factors.error->rows, {}});
    }
    add_patch_of(factors.parts, arrays);
    return arrays;
}

CellArray row_array(const FormFactors& factors, std::uint32_t patch) {
    if (patch >= factors.patches()) {
        throw InvalidArgument(
            fmt::format("row {}: there are {} rows, counted from 0", patch, factors.patches()), {"row"});
    }
    const FormFactorMatrix& matrix = factors.matrix;
    std::vector<std::uint32_t> parts;
    double area = 0.0;
    for (std::uint32_t i = 0; i < matrix.size(); ++i) {
        if ((factors.parts.any() ? factors.parts.patch_of[i] : i) == patch) {
            parts.push_back(i);
            area += factors.parts.any() ? factors.areas[i] : 0.0;
        }
    }
    CellArray array{fmt::format("F_{}", patch), std::vector<double>(matrix.size(), 0.0), {}};
    for (const std::uint32_t part : parts) {
        if (!matrix.known(part)) {
            throw InvalidArgument(fmt::format("row {} was not computed", patch), {"row"});
        }
        const double share = parts.size() == 1 ? 1.0 : factors.areas[part] / area;
        visit_sources(matrix, matrix.row(part),
                      [&](std::uint32_t j, double factor) { array.values[j] += share * factor; });
    }
    return array;
}

} // namespace hemi::io
