#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/pipeline/heat.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <limits>

namespace hemi {

namespace {

bool all_equal(const std::vector<double>& values) {
    return std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) == values.end();
}

/// Temperatures that are nearly those of a room in °C, in a scene whose others are hot.
void warn_of_celsius(const Scene& scene, const HeatProblem& problem, Observer& observer) {
    constexpr double cold = 150.0;
    constexpr double warm = 250.0;
    constexpr double space = 5.0; // the sky beyond the atmosphere has 2.7 K
    double hottest = problem.environment_temperature.value_or(0.0);
    for (const HeatCondition& condition : problem.conditions) {
        hottest = std::max(hottest, condition.temperature.value_or(0.0));
    }
    if (!(hottest > warm)) {
        return;
    }
    std::vector<bool> told(scene.groups.size(), false);
    for (const Surface& surface : scene.surfaces) {
        if (surface.heat == no_heat || told[surface.group]) {
            continue;
        }
        const auto& kelvin = problem.conditions[surface.heat].temperature;
        if (kelvin && *kelvin < cold) {
            told[surface.group] = true;
            observer.warning(fmt::format("group {} has {} K, while others have up to {} K; if °C is meant, "
                                         "write \"{} C\"",
                                         scene.groups[surface.group], *kelvin, hottest, *kelvin),
                             "temperature");
        }
    }
    const double sky = problem.environment_temperature.value_or(hottest);
    if (sky < cold && sky > space) {
        observer.warning(fmt::format("the environment has {} K, while others have up to {} K; if °C is "
                                     "meant, write \"{} C\"",
                                     sky, hottest, sky),
                         "environment-temperature");
    }
}

/// Groups that radiate as if they had 0 K because nothing is said of them.
void warn_of_unknown(const Scene& scene, const PatchMesh& mesh, const HeatProblem& problem,
                     Observer& observer) {
    std::vector<bool> unknown(scene.groups.size(), false);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const auto eps = problem.emissivity.begin() + static_cast<std::ptrdiff_t>(i) * problem.bands;
        const auto exitance = problem.exitance.begin() + static_cast<std::ptrdiff_t>(i) * problem.bands;
        const auto positive = [](double value) { return value > 0.0; };
        if (problem.condition_of[i] == no_heat && std::any_of(eps, eps + problem.bands, positive) &&
            std::none_of(exitance, exitance + problem.bands, positive)) {
            unknown[mesh.group(i)] = true;
        }
    }
    std::vector<std::string> names;
    for (std::size_t g = 0; g < unknown.size(); ++g) {
        if (unknown[g]) {
            names.push_back(scene.groups[g]);
        }
    }
    if (!names.empty()) {
        constexpr std::size_t most = 6;
        const std::size_t count = names.size();
        if (count > most) {
            names.resize(most);
            names.push_back("...");
        }
        observer.warning(
            fmt::format("{} without temperature, heat flux, power and exitance absorb{} as if at "
                        "0 K: {}",
                        plural(count, "group", "groups"), count == 1 ? "s" : "", fmt::join(names, ", ")),
            "temperature");
    }
}

/// Whether the values of materials that surfaces use are equal in all channels.
bool is_grey(const Scene& scene) {
    return std::all_of(scene.surfaces.begin(), scene.surfaces.end(), [&scene](const Surface& surface) {
        const Material& material = scene.materials[surface.material];
        return all_equal(material.reflectance) && all_equal(material.exitance);
    });
}

/// The same of sun and sky.
bool has_grey_sky(const Scene& scene) {
    return (!scene.sun || all_equal(scene.sun->irradiance)) &&
           (!scene.sky || (all_equal(scene.sky->horizontal) && all_equal(scene.sky->ground)));
}

void warn_of_unit(const Scene& scene, Observer& observer) {
    constexpr double large = 500.0;
    const double across = scene.bounds().diagonal();
    if (!scene.unit && across > large) {
        observer.warning(fmt::format("the scene is {:.6g} m across, as no unit is given; powers go with the "
                                     "square of the unit",
                                     across),
                         "unit");
    }
}

} // namespace

HeatProblem heat_problem(const Scene& scene, const PatchMesh& mesh, Observer& observer, bool conditions) {
    if (conditions && scene.photometric) {
        throw InputError("the scene's light is in lumens (luminous_flux, *_illuminance); heat needs watts");
    }
    const Thermal thermal = scene.thermal.value_or(Thermal{});
    const auto channels = static_cast<std::uint32_t>(scene.channels.size());
    HeatProblem problem;
    problem.band_limits = thermal.band_limits;
    problem.bands = static_cast<std::uint32_t>(thermal.band_limits.size()) + 1;
    problem.conditions = thermal.conditions;
    problem.environment_temperature = thermal.environment_temperature;
    problem.unit = scene.unit.value_or(1.0);
    if (problem.bands != channels) { // one for all, where they do not differ
        if (problem.bands > 1 || !all_equal(scene.environment) || !is_grey(scene) || !has_grey_sky(scene)) {
            throw InputError(fmt::format(
                "the scene has {} ({}) and {}; heat needs one channel a band (\"bands\"), or equal channels",
                plural(channels, "channel", "channels"), fmt::join(scene.channels, ", "),
                plural(problem.bands, "wavelength band", "wavelength bands")));
        }
    }
    problem.environment = scene.environment;
    problem.environment.resize(problem.bands, 0.0);
    for (const Material& material : scene.materials) {
        problem.tables.push_back(material.emissivity_table);
    }
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const Surface& surface = scene.surfaces[mesh.surface_of()[i]];
        const Material& material = scene.materials[surface.material];
        for (std::uint32_t k = 0; k < problem.bands; ++k) {
            problem.emissivity.push_back(1.0 - material.reflectance[k]);
            problem.exitance.push_back(material.exitance[k]);
        }
        problem.table_of.push_back(material.emissivity_table.empty() ? no_heat : surface.material);
        problem.condition_of.push_back(surface.heat);
    }
    warn_of_unit(scene, observer);
    if (conditions) {
        warn_of_celsius(scene, problem, observer);
        warn_of_unknown(scene, mesh, problem, observer);
    }
    return problem;
}

} // namespace hemi
