#include "hemi/core/text.hpp"
#include "hemi/pipeline/heat.hpp"
#include "hemi/pipeline/patch_size_error.hpp"
#include "pipeline/heat_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace hemi {

namespace {

/// Reflectance in place of 1, for what takes none of that.
constexpr double nearly_all = 1.0 - 1e-6;

/// The scene with the reflectances by which light goes on from its surfaces: what a flux is given for gives
/// back all that it gets.
Scene reflecting_scene(const Scene& scene, const PatchMesh& mesh, const HeatProblem& problem,
                       const HeatSolution& solution) {
    Scene result = scene;
    result.materials.clear();
    result.environment = environment_exitance(problem);
    result.channels.resize(problem.bands);
    for (std::uint32_t k = 0; k < problem.bands; ++k) {
        result.channels[k] = count_text(k);
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> found; // by material and condition
    for (std::uint32_t s = 0; s < result.surfaces.size(); ++s) {
        Surface& surface = result.surfaces[s];
        const auto [entry, is_new] = found.try_emplace({surface.material, surface.heat},
                                                       static_cast<std::uint32_t>(result.materials.size()));
        if (is_new) {
            const std::uint32_t patch = mesh.first_patch(s);
            Material material{
                scene.materials[surface.material].name, {}, std::vector<double>(problem.bands, 0.0)};
            for (std::uint32_t k = 0; k < problem.bands; ++k) {
                const bool all = problem.bands == 1 && has_flux(problem, patch);
                const double eps = all ? 0.0 : emissivity(problem, patch, k, solution.temperature[patch]);
                material.reflectance.push_back(std::clamp(1.0 - eps, 0.0, nearly_all));
            }
            result.materials.push_back(std::move(material));
        }
        surface.material = entry->second;
        surface.heat = no_heat;
    }
    result.thermal.reset();
    result.sun.reset();
    result.sky.reset();
    return result;
}

} // namespace

std::vector<double> patch_size_flux_errors(const Scene& scene, const PatchMesh& mesh,
                                           const Subdivision& subdivision, const FormFactors& factors,
                                           const HeatProblem& problem, const HeatSolution& solution,
                                           const FactorSettings& settings, Observer& observer) {
    const std::size_t groups = factors.groups.size();
    std::vector<double> errors(groups, std::numeric_limits<double>::quiet_NaN());
    const Scene reflecting = reflecting_scene(scene, mesh, problem, solution);
    const PatchMesh same(reflecting, subdivision); // with the materials of that scene
    if (same.size() != mesh.size()) {
        return errors;
    }
    Solution light;
    light.channels = problem.bands;
    light.radiosity = zero_where_unknown(solution.radiosity);
    light.irradiance = zero_where_unknown(solution.irradiation);
    const std::vector<double> reflectance = patch_values(same, reflecting.materials, &Material::reflectance);
    if (std::all_of(reflectance.begin(), reflectance.end(), [](double rho) { return rho == 0.0; })) {
        return std::vector<double>(groups, 0.0); // every surface is as bright all over as it is
    }
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const RowView row = factors.matrix.row(i);
        light.row_sum.push_back(row.sum());
        light.environment_share.push_back(row.environment);
        light.back_face_share.push_back(row.blocked);
        for (std::uint32_t k = 0; k < problem.bands; ++k) {
            const std::size_t at = std::size_t{i} * problem.bands + k;
            // What sun and sky give counts as reflected before the light goes from patch to patch.
            light.irradiance[at] -= problem.direct.empty() ? 0.0 : problem.direct[at];
            light.exitance.push_back(light.radiosity[at] - reflectance[at] * light.irradiance[at]);
        }
    }
    const auto estimate = try_estimate_patch_size_error(reflecting, same, factors, light, settings, observer);
    if (!estimate || estimate->groups.size() != groups) {
        return errors;
    }
    std::vector<double> absorbed(groups, 0.0);
    std::vector<double> area(groups, 0.0);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::uint32_t g = factors.group_of[i];
        if (solution.buried[i] == 0) {
            area[g] += factors.areas[i];
            absorbed[g] += is_held(problem, i) ? factors.areas[i] * solution.absorbed[i] : 0.0;
        }
    }
    for (std::size_t g = 0; g < groups; ++g) {
        const double relative = estimate->groups[g].patch_size;
        if (absorbed[g] == 0.0) {
            errors[g] = 0.0; // the fluxes are given
        } else if (std::isfinite(relative)) {
            errors[g] = relative * absorbed[g] / area[g];
        }
    }
    return errors;
}

} // namespace hemi
