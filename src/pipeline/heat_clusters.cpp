#include "hemi/matrix/product.hpp"
#include "pipeline/heat_rows.hpp"

namespace hemi {

namespace {

/// What arrives at every patch by its row as it is, less what arrives by the symmetric exchange, W/m²,
/// N·bands. What a row lacks comes back, as in the network.
std::vector<double> irradiation_gaps(const FormFactors& factors, const HeatProblem& problem,
                                     const HeatSolution& solution) {
    const std::uint32_t size = factors.matrix.size();
    const std::uint32_t bands = problem.bands;
    const std::uint32_t columns = bands + 1; // radiosities, and 1 where there are any
    std::vector<double> leaving(std::size_t{size} * columns, 0.0);
    for (std::uint32_t i = 0; i < size; ++i) {
        for (std::uint32_t k = 0; k < columns && solution.buried[i] == 0; ++k) {
            leaving[std::size_t{i} * columns + k] =
                k < bands ? solution.radiosity[std::size_t{i} * bands + k] : 1.0;
        }
    }
    std::vector<double> arriving(leaving.size());
    multiply(factors.matrix, leaving, columns, arriving);
    const std::vector<double> environment = shares_of_environment(factors);
    const std::vector<double> bright = environment_exitance(problem);
    std::vector<double> gaps(std::size_t{size} * bands, 0.0);
    for (std::uint32_t i = 0; i < size; ++i) {
        const double* const of_row = arriving.data() + std::size_t{i} * columns;
        const double back = 1.0 - of_row[bands] - environment[i];
        for (std::uint32_t k = 0; k < bands && solution.buried[i] == 0; ++k) {
            const std::size_t at = std::size_t{i} * bands + k;
            const double direct = problem.direct.empty() ? 0.0 : problem.direct[at];
            gaps[at] = of_row[k] + back * solution.radiosity[at] + environment[i] * bright[k] + direct -
                       solution.irradiation[at];
        }
    }
    return gaps;
}

} // namespace

std::vector<double> asymmetry_changes(const ExchangeNetwork& network, const FormFactors& factors,
                                      const HeatProblem& problem, const HeatSolution& solution,
                                      Observer& observer) {
    constexpr double tolerance = 1e-4; // of an error
    const std::uint32_t size = factors.matrix.size();
    const std::uint32_t bands = problem.bands;
    NetworkSources sources;
    sources.columns = bands;
    sources.emissivity.assign(std::size_t{size} * bands, 0.0);
    sources.source = sources.emissivity;
    sources.environment.assign(bands, 0.0);
    sources.direct = irradiation_gaps(factors, problem, solution);
    for (std::uint32_t i = 0; i < size; ++i) {
        for (std::uint32_t k = 0; k < bands && !has_flux(problem, i); ++k) {
            sources.emissivity[std::size_t{i} * bands + k] =
                emissivity(problem, i, k, solution.temperature[i]);
        }
    }
    const NetworkFluxes fluxes = network.solve(sources, tolerance, heat_progress(observer, tolerance));
    std::vector<double> changes(size, 0.0);
    for (std::uint32_t i = 0; i < size; ++i) {
        for (std::uint32_t k = 0; k < bands && solution.buried[i] == 0; ++k) {
            changes[i] += fluxes.irradiation[std::size_t{i} * bands + k];
        }
    }
    return changes;
}

} // namespace hemi
