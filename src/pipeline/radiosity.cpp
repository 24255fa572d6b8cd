#include "hemi/pipeline/radiosity.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/pipeline/daylight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

namespace hemi {

namespace {

bool all_equal(std::span<const double> values) {
    return std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) == values.end();
}

bool all_zero(std::span<const double> values) {
    return std::all_of(values.begin(), values.end(), [](double value) { return value == 0.0; });
}

/// Whether all channels are the same problem.
bool is_grey(const PatchValues& values) {
    const auto grey = [&values](std::span<const double> all) {
        for (std::size_t k = 0; k < all.size(); k += values.channels) {
            if (!all_equal(all.subspan(k, values.channels))) {
                return false;
            }
        }
        return true;
    };
    return all_equal(values.environment) && grey(values.reflectance) && grey(values.exitance) &&
           grey(values.direct);
}

/// Patches that reflect in some channel.
std::vector<std::uint32_t> reflecting(const PatchValues& values, std::uint32_t size) {
    std::vector<std::uint32_t> patches;
    const std::span<const double> reflectance(values.reflectance);
    for (std::uint32_t i = 0; i < size; ++i) {
        if (!all_zero(reflectance.subspan(std::size_t{i} * values.channels, values.channels))) {
            patches.push_back(i);
        }
    }
    return patches;
}

void check_sizes(const PatchValues& values, std::uint32_t size) {
    const std::size_t count = std::size_t{size} * values.channels;
    if (values.channels == 0 || values.reflectance.size() != count || values.exitance.size() != count ||
        (!values.environment.empty() && values.environment.size() != values.channels) ||
        (!values.direct.empty() && values.direct.size() != count)) {
        throw InvalidArgument(
            fmt::format("{} reflectances, {} exitances, {} values of the environment and {} direct "
                        "irradiances for {} in {}",
                        values.reflectance.size(), values.exitance.size(), values.environment.size(),
                        values.direct.size(), plural(size, "patch", "patches"),
                        plural(values.channels, "channel", "channels")));
    }
}

/// The first `solved` of `channels` values a patch.
std::vector<double> first_channels(std::vector<double> values, std::uint32_t channels, std::uint32_t solved) {
    if (solved == channels) {
        return values;
    }
    std::vector<double> first;
    for (std::size_t k = 0; k < values.size(); k += channels) {
        first.insert(first.end(), values.begin() + static_cast<std::ptrdiff_t>(k),
                     values.begin() + static_cast<std::ptrdiff_t>(k + solved));
    }
    return first;
}

/// Every value `times` times.
std::vector<double> repeated(std::vector<double> values, std::uint32_t times) {
    if (times == 1) {
        return values;
    }
    std::vector<double> result;
    result.reserve(values.size() * times);
    for (const double value : values) {
        result.insert(result.end(), times, value);
    }
    return result;
}

void check_rows(const FormFactorMatrix& factors, const std::vector<std::uint32_t>& needed) {
    const auto missing = static_cast<std::size_t>(
        std::count_if(needed.begin(), needed.end(), [&](std::uint32_t i) { return !factors.known(i); }));
    if (missing > 0) {
        throw InputError(fmt::format("the form factors lack {} that this scene needs; compute them again",
                                     plural(missing, "row", "rows")));
    }
}

/// Tells the observer of sweeps. The residual falls about geometrically: its logarithm says how far they are.
SweepWatcher sweep_progress(const SolverSettings& settings, Observer& observer) {
    const double target = std::log(settings.tolerance);
    return [target, &observer, watch = settings.watch](std::uint32_t sweep, double residual,
                                                       const auto& radiosity) {
        const double share = residual > 0.0 ? std::log(residual) / target : 1.0;
        const bool go_on = observer.progress(
            Phase::radiosity, static_cast<std::size_t>(100.0 * std::clamp(share, 0.0, 1.0)), 100);
        return go_on && (!watch || watch(sweep, residual, radiosity));
    };
}

} // namespace

std::vector<std::uint32_t> reflecting_patches(const Scene& scene, const PatchMesh& mesh) {
    std::vector<std::uint32_t> patches;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (!all_zero(scene.materials[mesh.material(i)].reflectance)) {
            patches.push_back(i);
        }
    }
    return patches;
}

PatchValues patch_values(const Scene& scene, const PatchMesh& mesh) {
    return {static_cast<std::uint32_t>(scene.channels.size()),
            patch_values(mesh, scene.materials, &Material::reflectance),
            patch_values(mesh, scene.materials, &Material::exitance),
            scene.environment,
            {},
            scene.sun,
            scene.sky,
            scene.up};
}

Solution solve_radiosity(const Scene& scene, const PatchMesh& mesh, const FormFactors& factors,
                         const SolverSettings& settings, Observer& observer, bool with_irradiance) {
    PatchValues values = patch_values(scene, mesh);
    values.direct = direct_irradiance(scene, mesh, factors.matrix);
    return solve_radiosity(factors, std::move(values), settings, observer, with_irradiance);
}

Solution solve_radiosity(const FormFactors& factors, PatchValues values, const SolverSettings& settings,
                         Observer& observer, bool with_irradiance) {
    const Stopwatch watch;
    const FormFactorMatrix& matrix = factors.matrix;
    check_sizes(values, matrix.size());
    check_rows(matrix, reflecting(values, matrix.size()));
    const std::uint32_t channels = values.channels;
    const std::uint32_t solved = is_grey(values) ? 1 : channels;
    const auto reflectance = first_channels(values.reflectance, channels, solved);
    const auto exitance = first_channels(values.exitance, channels, solved);
    const auto direct = first_channels(values.direct, channels, solved);
    const std::span<const double> environment(values.environment);
    const RadiosityProblem problem{&matrix,
                                   solved,
                                   reflectance,
                                   exitance,
                                   environment.first(std::min<std::size_t>(solved, environment.size())),
                                   factors.areas,
                                   direct};
    if (all_zero(exitance) && all_zero(environment) && all_zero(direct)) {
        observer.warning("nothing radiates: no material has exitance, and the environment is dark",
                         "environment");
    }
    SolverSettings watched = settings;
    watched.watch = sweep_progress(settings, observer);
    Solution solution = solve_radiosity(problem, watched);
    if (with_irradiance) {
        solution.irradiance = repeated(irradiance(problem, solution.radiosity), channels / solved);
    }
    solution.channels = channels;
    solution.radiosity = repeated(std::move(solution.radiosity), channels / solved);
    solution.exitance = std::move(values.exitance);
    solution.direct = std::move(values.direct);
    for (std::uint32_t i = 0; i < matrix.size(); ++i) {
        const RowView row = matrix.row(i);
        solution.row_sum.push_back(row.sum());
        solution.environment_share.push_back(row.environment);
        solution.back_face_share.push_back(row.blocked);
    }
    solution.renderer = factors.provenance.renderer;
    solution.chosen_for = factors.provenance.chosen_for;
    solution.factor_error = factors.error;
    solution.seconds = watch.seconds();
    stop_if_interrupted();
    if (factors.error) {
        solution.error = estimate_radiosity_error(matrix, factors.reference, factors.areas, channels,
                                                  values.reflectance, solution.exitance, solution.radiosity);
    }
    return solution;
}

} // namespace hemi
