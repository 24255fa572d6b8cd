#include "pipeline/group_factor_errors.hpp"

#include "hemi/matrix/error_estimate.hpp"
#include "hemi/pipeline/daylight.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace hemi {

namespace {

/// What rows let through too much of the sky, W/m²: channel c of the k-th row at [k·channels + c]; empty
/// where there is none.
std::vector<double> sky_errors(const Scene& scene, const PatchMesh& mesh, const FormFactors& factors,
                               std::span<const std::uint32_t> rows) {
    if (!scene.sky) {
        return {};
    }
    std::vector<double> errors = direct_irradiances(scene, mesh, factors.matrix, rows).sky;
    const std::vector<double> better = direct_irradiances(scene, mesh, factors.reference, rows).sky;
    for (std::size_t k = 0; k < errors.size(); ++k) {
        errors[k] -= better[k];
    }
    return errors;
}

} // namespace

std::vector<SampledSum> factor_error_sums(const Scene& scene, const PatchMesh& mesh,
                                          const FormFactors& factors, const Solution& solution,
                                          const GroupImportance& importance) {
    const std::uint32_t channels = solution.channels;
    std::vector<SampledSum> sums(std::size_t{importance.groups()} * channels);
    if (factors.reference.size() != mesh.size()) {
        return sums;
    }
    const IrradianceErrors errors =
        irradiance_errors(factors.matrix, factors.reference, channels, solution.radiosity, scene.environment);
    const std::vector<double> sky = sky_errors(scene, mesh, factors, errors.rows);
    double known = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        known += factors.matrix.known(i) ? 1.0 : 0.0;
    }
    const double weight = known / static_cast<double>(errors.rows.size());
    for (std::size_t k = 0; k < errors.rows.size(); ++k) {
        const std::uint32_t i = errors.rows[k];
        const std::span<const double> of_row = importance.of(i);
        for (std::size_t column = 0; column < sums.size(); ++column) {
            const std::size_t value = k * channels + column % channels;
            sums[column].add(mesh.areas()[i] * of_row[column] *
                                 (errors.errors[value] + (sky.empty() ? 0.0 : sky[value])),
                             weight);
        }
    }
    return sums;
}

} // namespace hemi
