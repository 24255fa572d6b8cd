#include "cli/solution.hpp"

#include "cli/progress_bar.hpp"
#include "cli/signals.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hemi::cli {

namespace {

bool all_equal(const std::vector<double>& values) {
    return std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) == values.end();
}

/// Whether all channels are the same problem.
bool is_grey(const Scene& scene) {
    return all_equal(scene.environment) &&
           std::all_of(scene.materials.begin(), scene.materials.end(), [](const Material& material) {
               return all_equal(material.reflectance) && all_equal(material.exitance);
           });
}

std::vector<double> spread_materials(const Scene& scene, const PatchMesh& mesh, std::uint32_t channels,
                                     std::vector<double> Material::*property) {
    std::vector<double> values(std::size_t{mesh.size()} * channels);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::vector<double>& of_material = scene.materials[mesh.material(i)].*property;
        std::copy_n(of_material.begin(), channels, values.begin() + std::ptrdiff_t{i} * channels);
    }
    return values;
}

/// One value a patch becomes `channels` equal values a patch.
std::vector<double> spread_channels(const std::vector<double>& values, std::uint32_t channels) {
    std::vector<double> spread;
    spread.reserve(values.size() * channels);
    for (const double value : values) {
        spread.insert(spread.end(), channels, value);
    }
    return spread;
}

void check_rows(const FormFactorMatrix& factors, const std::vector<std::uint32_t>& needed) {
    const auto missing = static_cast<std::size_t>(
        std::count_if(needed.begin(), needed.end(), [&](std::uint32_t i) { return !factors.known(i); }));
    if (missing > 0) {
        throw InputError(fmt::format("the form factors lack {} that this scene needs; compute them again",
                                     plural(missing, "row", "rows")));
    }
}

} // namespace

std::vector<std::uint32_t> reflecting_patches(const LoadedScene& loaded) {
    std::vector<std::uint32_t> patches;
    for (std::uint32_t i = 0; i < loaded.mesh.size(); ++i) {
        const auto& reflectance = loaded.scene.materials[loaded.mesh.material(i)].reflectance;
        if (std::any_of(reflectance.begin(), reflectance.end(), [](double rho) { return rho != 0.0; })) {
            patches.push_back(i);
        }
    }
    return patches;
}

std::vector<double> patch_exitance(const Scene& scene, const PatchMesh& mesh) {
    return spread_materials(scene, mesh, static_cast<std::uint32_t>(scene.channels.size()),
                            &Material::exitance);
}

std::vector<double> patch_reflectance(const Scene& scene, const PatchMesh& mesh) {
    return spread_materials(scene, mesh, static_cast<std::uint32_t>(scene.channels.size()),
                            &Material::reflectance);
}

Solution solve_scene(const LoadedScene& loaded, const FormFactorMatrix& factors,
                     const SolverSettings& settings, bool with_irradiance, const Terminal& terminal) {
    const Stopwatch watch;
    const Scene& scene = loaded.scene;
    check_rows(factors, reflecting_patches(loaded));

    Solution solution;
    solution.channels = static_cast<std::uint32_t>(scene.channels.size());
    solution.channels_solved = is_grey(scene) ? 1 : solution.channels;
    const std::uint32_t channels = solution.channels_solved;
    const auto reflectance = spread_materials(scene, loaded.mesh, channels, &Material::reflectance);
    const auto exitance = spread_materials(scene, loaded.mesh, channels, &Material::exitance);
    const std::span<const double> environment(scene.environment);
    const RadiosityProblem problem{&factors,
                                   channels,
                                   reflectance,
                                   exitance,
                                   environment.first(std::min<std::size_t>(channels, environment.size())),
                                   loaded.mesh.areas()};

    const auto dark = [](std::span<const double> values) {
        return std::all_of(values.begin(), values.end(), [](double value) { return value == 0.0; });
    };
    if (dark(exitance) && dark(environment)) {
        terminal.warn(
            "nothing radiates: no material has exitance and the environment is dark; --environment 1 "
            "lights an open scene");
    }

    // The residual falls about geometrically: its logarithm tells how far the sweeps are.
    ProgressBar bar(terminal, "radiosity", "");
    const double target = std::log(settings.tolerance);
    const RadiositySolution found = solve_radiosity(problem, settings, [&](std::uint32_t, double residual) {
        const double share = residual > 0.0 ? std::log(residual) / target : 1.0;
        return bar.update(static_cast<std::size_t>(100.0 * std::clamp(share, 0.0, 1.0)), 100);
    });
    solution.exitance = spread_channels(exitance, solution.channels / channels);
    solution.radiosity = spread_channels(found.radiosity, solution.channels / channels);
    if (with_irradiance) {
        solution.irradiance =
            spread_channels(irradiance(problem, found.radiosity), solution.channels / channels);
    }
    solution.blocked.resize(factors.size());
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        solution.blocked[i] = factors.row(i).blocked;
    }
    solution.solver = solver_name(found.method);
    solution.why = found.why;
    solution.sweeps = found.sweeps;
    solution.residual = found.residual;
    solution.dominance = found.dominance;
    solution.seconds = watch.seconds();
    stop_if_interrupted();
    return solution;
}

io::ResultFile make_result(const LoadedScene& loaded, const SceneOptions& options, const Rows& rows,
                           const Solution& solution) {
    io::ResultFile result;
    result.scene = loaded.scene;
    result.subdivision = options.subdivision;
    result.radiosity = solution.radiosity;
    result.irradiance = solution.irradiance;
    for (std::uint32_t i = 0; i < loaded.mesh.size(); ++i) {
        const RowView row = rows.file.factors.row(i);
        result.row_sum.push_back(row.sum());
        result.environment.push_back(row.environment);
        result.blocked.push_back(row.blocked);
    }
    result.solver = solution.solver;
    result.sweeps = solution.sweeps;
    result.residual = solution.residual;
    result.renderer = rows.file.renderer;
    result.chosen_for = rows.file.chosen_for;
    result.factor_error = rows.file.error;
    result.radiosity_error = solution.error;
    return result;
}

} // namespace hemi::cli
