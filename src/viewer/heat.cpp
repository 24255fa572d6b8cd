#include "viewer/heat.hpp"

#include "hemi/core/black_body.hpp"
#include "hemi/core/error.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>

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

/// Patches may have been cut since.
bool is_of_these_patches(const ViewerInput& input) {
    return input.heat->condition_of.size() == input.mesh->size();
}

HeatProblem problem_of(const ViewerInput& input, const Light& light) {
    if (!is_of_these_patches(input)) {
        throw InvalidArgument("what the scene says of heat is of other patches than these");
    }
    HeatProblem problem = *input.heat;
    if (!light.conditions.empty()) {
        problem.conditions = light.conditions;
    }
    const std::uint32_t channels = input.channels();
    const std::vector<double> reflectance =
        patch_values(*input.mesh, input.scene->materials, &Material::reflectance);
    const std::vector<double> exitance =
        patch_values(*input.mesh, input.scene->materials, &Material::exitance);
    const std::vector<double> opened = input.environment();
    for (std::uint32_t k = 0; k < problem.bands && !light.environment.empty() && !opened.empty(); ++k) {
        problem.environment.resize(problem.bands, 0.0);
        problem.environment[k] += of_band(light.environment, 0, k, channels, problem.bands) -
                                  of_band(opened, 0, k, channels, problem.bands);
    }
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

std::vector<std::string> condition_names(const ViewerInput& input) {
    const PatchMesh& mesh = *input.mesh;
    std::vector<std::string> names(input.heat->conditions.size());
    std::vector<std::uint32_t> last(names.size(), no_heat);
    for (std::uint32_t i = 0; i < mesh.size() && is_of_these_patches(input); ++i) {
        const std::uint32_t condition = input.heat->condition_of[i];
        if (condition == no_heat || last[condition] == mesh.group(i)) {
            continue;
        }
        std::string& name = names[condition];
        if (name.empty()) {
            name = mesh.groups()[mesh.group(i)];
        } else if (!name.ends_with(", ...")) {
            name += ", ...";
        }
        last[condition] = mesh.group(i);
    }
    return names;
}

void radiate_by_conditions(const ViewerInput& input, Light& light) {
    if (light.conditions.empty() || !is_of_these_patches(input)) {
        return;
    }
    const HeatProblem& heat = *input.heat;
    const std::size_t channels = input.channels();
    const std::vector<double> of_scene =
        patch_values(*input.mesh, input.scene->materials, &Material::reflectance);
    for (std::uint32_t i = 0; i < input.mesh->size(); ++i) {
        const std::uint32_t condition = heat.condition_of[i];
        if (condition == no_heat || !heat.conditions[condition].temperature) {
            continue;
        }
        const double before = *heat.conditions[condition].temperature;
        const double now = *light.conditions[condition].temperature;
        const auto first = static_cast<std::ptrdiff_t>(i * channels);
        const bool same_material =
            std::equal(of_scene.begin() + first, of_scene.begin() + first + std::ptrdiff_t(channels),
                       light.reflectance.begin() + first);
        if (before == now && same_material) {
            continue;
        }
        const std::vector<double> shares_before = band_fractions(before, heat.band_limits);
        const std::vector<double> shares_now = band_fractions(now, heat.band_limits);
        for (std::size_t c = 0; c < channels; ++c) {
            const std::size_t at = i * channels + c;
            const std::size_t band = heat.bands == 1 ? 0 : c;
            if (same_material && heat.table_of[i] != no_heat) {
                light.reflectance[at] = 1.0 - emissivity_at(heat.tables[heat.table_of[i]], now);
            }
            light.exitance[at] = std::max(
                0.0, light.exitance[at] -
                         (1.0 - of_scene[at]) * shares_before[band] * black_body_exitance(before) +
                         (1.0 - light.reflectance[at]) * shares_now[band] * black_body_exitance(now));
        }
    }
}

Heat find_heat(const ViewerInput& input, const Light& light, Observer& observer) {
    Heat heat;
    if (input.factors->matrix.clusters() != nullptr) {
        heat.problem = "far patches stand in clusters, but the exchange of heat needs factors of single "
                       "patches; --clusters off makes them";
        return heat;
    }
    try {
        const HeatProblem problem = problem_of(input, light);
        const HeatSolution solution = solve_heat(*input.factors, problem, {}, observer);
        heat.groups = group_heat(*input.factors, problem, solution);
        heat.solution = heat_as_solution(*input.factors, problem, solution, input.channels());
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& error) {
        heat.problem = error.what();
    }
    return heat;
}

} // namespace hemi::viewer
