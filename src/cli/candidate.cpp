#include "cli/candidate.hpp"

#include "cli/repair_rows.hpp"
#include "cli/signals.hpp"
#include "cli/solution.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/engine/reference_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

namespace hemi::cli {

namespace {

/// Seconds that one row takes of many: where the sample went by in a moment, of more rows, so that workers
/// and batches are as busy as they will be.
template <class Row>
double seconds_a_row(BasicRowProvider<Row>& provider, std::size_t sampled, double seconds) {
    constexpr double long_enough = 0.4;
    const auto all = all_patches(provider.size());
    const double one = seconds / static_cast<double>(sampled);
    const auto more = static_cast<std::uint32_t>(std::min<double>(long_enough / std::max(one, 1e-6), 1024.0));
    if (more <= sampled || all.size() <= sampled) {
        return one;
    }
    const auto patches = reference_patches(all, more);
    const Stopwatch watch;
    provider.rows(patches, [](std::uint32_t, const Row&) {});
    return watch.seconds() / static_cast<double>(patches.size());
}

/// @param count    of rows that `seconds` are to be for
/// @param compute  rows and what is made of them
template <class Row, class Compute>
FormFactorMatrix timed_rows(BasicRowProvider<Row>& provider, std::span<const std::uint32_t> patches,
                            std::size_t count, const Compute& compute, double& seconds) {
    // The first row also pays for contexts and workers, which do not grow with the number of rows.
    const Stopwatch start_watch;
    provider.rows(patches.first(1), [](std::uint32_t, const Row&) {});
    const double start = start_watch.seconds();
    const Stopwatch watch;
    double rows_taken = 0.0;
    FormFactorMatrix rows = compute([&](std::size_t, std::size_t) {
        rows_taken = watch.seconds();
        return !interrupted();
    });
    const double pairs_taken = std::is_same_v<Row, VisibilityRow> ? watch.seconds() - rows_taken : 0.0;
    // Each pair is taken once.
    const double size = provider.size();
    const auto some = static_cast<double>(patches.size());
    const auto all = static_cast<double>(count);
    const double pairs = all * (size - 0.5 * all) / (some * (size - 0.5 * some));
    seconds = start + all * seconds_a_row(provider, patches.size(), rows_taken) + pairs * pairs_taken;
    return rows;
}

/// @param count    of rows that `seconds` are to be for
FormFactorMatrix rows_of(const LoadedScene& loaded, const Candidate& candidate,
                         std::span<const std::uint32_t> patches, std::size_t count, double& seconds) {
    const RowPlan plan = plan_rows(candidate.options, loaded.mesh.size());
    if (!candidate.yardstick && plan.hybrid) {
        const auto visibility = make_visibility(loaded.mesh, plan.hemicube, candidate.options);
        const auto compute = [&](const Progress& rows_done) {
            const auto go_on = [](std::size_t, std::size_t) { return !interrupted(); };
            return compute_visibility_weighted(*visibility, loaded.mesh, patches, *plan.hybrid,
                                               loaded.scene.enclosure, rows_done, go_on, go_on);
        };
        return timed_rows(*visibility, patches, count, compute, seconds);
    }
    const auto provider = candidate.yardstick ? make_baseline(loaded.mesh, *candidate.yardstick)
                                              : make_engine(loaded.mesh, plan.hemicube, candidate.options);
    const auto compute = [&](const Progress& rows_done) {
        return compute_matrix(*provider, patches, rows_done);
    };
    return timed_rows(*provider, patches, count, compute, seconds);
}

void judge(Measurement& measurement, const LoadedScene& loaded, const FormFactorMatrix& rows,
           const Reference& reference, std::span<const double> radiosity) {
    measurement.error = estimate_factor_error(rows, reference.rows);
    if (!radiosity.empty()) {
        measurement.radiosity =
            estimate_radiosity_error(rows, reference.rows, loaded.mesh.areas(),
                                     static_cast<std::uint32_t>(loaded.scene.channels.size()),
                                     patch_reflectance(loaded.scene, loaded.mesh),
                                     patch_exitance(loaded.scene, loaded.mesh), radiosity)
                .rms;
    }
}

} // namespace

Candidate hemicube_candidate(const RowOptions& base, const std::string& preset, std::uint32_t patches,
                             std::uint32_t eye_points, std::uint32_t resolution,
                             std::optional<std::uint32_t> shadow_rays) {
    Candidate candidate;
    candidate.options = base;
    candidate.options.preset = preset;
    candidate.options.method = "hemicube";
    candidate.options.eye_points.reset();
    candidate.options.resolution.reset();
    candidate.command = "--preset " + preset;
    if (eye_points > 0) {
        candidate.options.eye_points = eye_points;
        candidate.command += fmt::format(" --eye-points {}", eye_points);
    }
    if (resolution > 0) {
        candidate.options.resolution = resolution;
        candidate.command += fmt::format(" --resolution {}", resolution);
    }
    candidate.options.shadow_rays = shadow_rays;
    if (shadow_rays) {
        candidate.command += fmt::format(" --shadow-rays {}", *shadow_rays);
    }
    const HemicubeSettings hemicube = plan_rows(candidate.options, patches).hemicube;
    const std::string eyes_and_texels = fmt::format("{}x{}", hemicube.eye_points, hemicube.resolution);
    candidate.family = preset != "plain" ? "hybrid" : hemicube.eye_points == 1 ? "plain" : "plain, more eyes";
    candidate.settings = preset == "plain" || eye_points + resolution > 0
                             ? eyes_and_texels
                             : fmt::format("{} ({})", preset, eyes_and_texels);
    if (shadow_rays) {
        candidate.settings += *shadow_rays == 0 ? ", no rays" : fmt::format(", {} rays", *shadow_rays);
    }
    return candidate;
}

Candidate baseline_candidate(const RowOptions& base, BaselineMethod method, std::uint32_t rays) {
    Candidate candidate;
    candidate.options = base;
    candidate.yardstick = BaselineSettings{};
    candidate.yardstick->method = method;
    candidate.yardstick->seed = base.seed.value_or(0);
    switch (method) {
    case BaselineMethod::direct:
        candidate.family = candidate.options.method = "direct";
        break;
    case BaselineMethod::contour:
        candidate.family = candidate.options.method = "contour";
        break;
    case BaselineMethod::montecarlo:
        candidate.family = "Monte Carlo";
        candidate.options.method = "montecarlo";
        candidate.options.rays = rays;
        candidate.yardstick->rays = rays;
        candidate.settings = fmt::format("{} rays", rays);
        break;
    case BaselineMethod::hemisphere:
        candidate.family = candidate.options.method = "hemisphere";
        break;
    }
    candidate.command = "--method " + candidate.options.method;
    if (method == BaselineMethod::montecarlo) {
        candidate.command += fmt::format(" --rays {}", rays);
    }
    return candidate;
}

Reference find_reference(const LoadedScene& loaded, std::span<const std::uint32_t> patches,
                         const RowOptions& base, double seconds) {
    constexpr std::uint32_t fewest = 8;
    constexpr std::uint32_t most = 32;
    const Stopwatch watch;
    RowOptions best = base;
    best.preset = "exact";
    best.eye_points.reset();
    best.resolution.reset();
    best.shadow_rays.reset();
    Reference reference;
    reference.settings = reference_settings(plan_rows(best, loaded.mesh.size()).hemicube);
    reference.settings.eye_points = reference.settings.near_eye_points; // as many as there can be
    reference.settings.resolution = std::max(reference.settings.resolution, 128u);
    const auto engine = make_visibility(loaded.mesh, reference.settings, base);
    const auto first = reference_patches(patches, 1);
    (void)compute_reference(*engine, loaded.mesh, first); // pays for the start
    const Stopwatch one;
    (void)compute_reference(*engine, loaded.mesh, first);
    const auto count =
        static_cast<std::uint32_t>(std::clamp<double>(seconds / std::max(one.seconds(), 1e-4), fewest, most));
    reference.patches = reference_patches(patches, count);
    reference.rows = compute_reference(*engine, loaded.mesh, reference.patches);
    reference.renderer = engine->renderer();
    reference.seconds = watch.seconds();
    stop_if_interrupted();
    return reference;
}

Measurement try_on_sample(const LoadedScene& loaded, const Candidate& candidate, const Reference& reference,
                          std::size_t count, std::span<const double> radiosity) {
    Measurement measurement;
    const FormFactorMatrix rows = rows_of(loaded, candidate, reference.patches, count, measurement.seconds);
    judge(measurement, loaded, rows, reference, radiosity);
    stop_if_interrupted();
    return measurement;
}

Measurement try_on_all(const LoadedScene& loaded, const Candidate& candidate, const Reference& reference,
                       std::span<const double> radiosity, io::FactorFile* rows) {
    const auto patches = all_patches(loaded.mesh.size());
    const Stopwatch watch;
    Measurement measurement;
    measurement.all_rows = true;
    io::FactorFile file;
    if (candidate.yardstick) {
        file.factors = compute_matrix(*make_baseline(loaded.mesh, *candidate.yardstick), patches,
                                      [](std::size_t, std::size_t) { return !interrupted(); });
    } else {
        const Terminal silent(true);
        file = compute_rows(loaded, patches, candidate.options, silent).file;
        settle_contacts(file);
        (void)repair_rows(file, candidate.options.repair);
    }
    measurement.seconds = watch.seconds();
    judge(measurement, loaded, file.factors, reference, radiosity);
    if (rows != nullptr) {
        *rows = std::move(file);
    }
    return measurement;
}

std::uint64_t table_of_pairs(const Candidate& candidate, std::uint32_t patches, std::size_t rows) {
    constexpr std::uint64_t bytes_a_pair = 4; // while both tables are there
    return candidate.yardstick || !plan_rows(candidate.options, patches).hybrid
               ? 0
               : bytes_a_pair * patches * static_cast<std::uint64_t>(rows);
}

} // namespace hemi::cli
