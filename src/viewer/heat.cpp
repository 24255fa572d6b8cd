#include "viewer/heat.hpp"

#include "hemi/core/error.hpp"

#include <cstddef>
#include <cstdint>

namespace hemi::viewer {

namespace {

/// What a band has of the channels: its own, or the mean of all where there is one band.
double of_band(const std::vector<double>& values, std::uint32_t i, std::uint32_t band, std::uint32_t channels,
               std::uint32_t bands) {
    if (bands == channels) {
        return values[std::size_t{i} * channels + band];
    }
    double sum = 0.0;
    for (std::uint32_t c = 0; c < channels; ++c) {
        sum += values[std::size_t{i} * channels + c];
    }
    return sum / channels;
}

HeatProblem problem_of(const ViewerInput& input, const Light& light) {
    HeatProblem problem = *input.heat;
    const std::uint32_t channels = input.channels();
    const std::vector<double> reflectance =
        patch_values(*input.mesh, input.scene->materials, &Material::reflectance);
    const std::vector<double> exitance =
        patch_values(*input.mesh, input.scene->materials, &Material::exitance);
    const bool lit = !input.solution.direct.empty();
    for (std::uint32_t i = 0; i < input.mesh->size(); ++i) {
        for (std::uint32_t k = 0; k < problem.bands; ++k) {
            const std::size_t at = std::size_t{i} * problem.bands + k;
            const double now = of_band(light.reflectance, i, k, channels, problem.bands);
            if (now != of_band(reflectance, i, k, channels, problem.bands)) { // a table counts no more
                problem.emissivity[at] = 1.0 - now;
                problem.table_of[i] = no_heat;
            }
            // What a temperature makes is no exitance here.
            if (problem.condition_of[i] == no_heat) {
                problem.exitance[at] += of_band(light.exitance, i, k, channels, problem.bands) -
                                        of_band(exitance, i, k, channels, problem.bands);
            }
            if (lit) {
                problem.direct.push_back(of_band(input.solution.direct, i, k, channels, problem.bands));
            }
        }
    }
    return problem;
}

} // namespace

Heat find_heat(const ViewerInput& input, const Light& light, Observer& observer) {
    Heat heat;
    try {
        const HeatProblem problem = problem_of(input, light);
        const HeatSolution solution = solve_heat(*input.factors, problem, {}, observer);
        heat.groups = group_heat(*input.factors, problem, solution);
        heat.solution = heat_as_solution(*input.factors, problem, solution, input.channels());
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& error) {
        heat.problem = error.what();
    }
    return heat;
}

} // namespace hemi::viewer
