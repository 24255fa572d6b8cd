#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/engine/reference_rows.hpp"
#include "hemi/pipeline/accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi {

namespace {

/// Seconds that one row takes of many: where the sample went by in a moment, of more rows, so that workers
/// and batches are as busy as they will be.
template <class Provider>
double seconds_a_row(Provider& provider, std::size_t sampled, double seconds) {
    constexpr double min_seconds = 0.4;
    constexpr double max_rows = 1024.0;
    const auto all = all_patches(provider.size());
    const double one = seconds / static_cast<double>(sampled);
    const auto more = static_cast<std::uint32_t>(std::min(min_seconds / std::max(one, 1e-6), max_rows));
    if (more <= sampled || all.size() <= sampled) {
        return one;
    }
    const auto patches = reference_patches(all, more);
    const Stopwatch watch;
    provider.rows(patches, [](std::uint32_t, const auto&) {});
    return watch.seconds() / static_cast<double>(patches.size());
}

/// Tells the observer what a phase is at.
Progress progress_of(Observer& observer, Phase phase) {
    return [&observer, phase](std::size_t done, std::size_t total) {
        stop_if_interrupted();
        return observer.progress(phase, done, total);
    };
}

bool is_weighted(const FactorSettings& settings) {
    return settings.method == Method::hemicube && settings.preset != Preset::plain;
}

/// Rows of a sample, and what all rows will take.
/// @param count     number of rows that `seconds` are to be for
/// @param progress  of the rows
/// @param compute   makes rows of a provider, and calls back after each
template <class Provider, class Compute>
FormFactorMatrix timed_rows(Provider& provider, std::span<const std::uint32_t> patches, std::size_t count,
                            double& seconds, const Progress& progress, const Compute& compute) {
    // The first row also pays for contexts and workers, which do not grow with the number of rows.
    const Stopwatch start_watch;
    provider.rows(patches.first(1), [](std::uint32_t, const auto&) {});
    const double start = start_watch.seconds();
    const Stopwatch watch;
    double rows_seconds = 0.0;
    FormFactorMatrix rows = compute([&](std::size_t done, std::size_t total) {
        rows_seconds = watch.seconds();
        return progress(done, total);
    });
    const double pair_seconds = watch.seconds() - rows_seconds; // 0 where rows are all there is
    // Each pair is computed once.
    const double size = provider.size();
    const auto some = static_cast<double>(patches.size());
    const auto all = static_cast<double>(count);
    const double pairs = all * (size - 0.5 * all) / (some * (size - 0.5 * some));
    seconds = start + all * seconds_a_row(provider, patches.size(), rows_seconds) + pairs * pair_seconds;
    return rows;
}

FormFactorMatrix rows_of(const Scene& scene, const PatchMesh& mesh, const FactorSettings& settings,
                         std::span<const std::uint32_t> patches, std::size_t count, double& seconds,
                         Observer& observer) {
    const auto progress = [&observer](Phase phase) { return progress_of(observer, phase); };
    if (!is_weighted(settings)) {
        const auto provider = make_row_provider(mesh, settings);
        return timed_rows(
            *provider, patches, count, seconds, progress(Phase::form_factors),
            [&](const Progress& rows_done) { return compute_matrix(*provider, patches, rows_done); });
    }
    const RowPlan plan = plan_rows(settings, mesh.size());
    const auto provider = make_visibility_provider(mesh, plan.hemicube, settings);
    return timed_rows(
        *provider, patches, count, seconds, progress(Phase::visibility), [&](const Progress& rows_done) {
            return compute_visibility_weighted(*provider, mesh, patches, *plan.weighted, scene.enclosure,
                                               rows_done, progress(Phase::pairs),
                                               progress(Phase::form_factors));
        });
}

void judge(Measurement& measurement, const Scene& scene, const PatchMesh& mesh, const FormFactorMatrix& rows,
           const Reference& reference, std::span<const double> radiosity) {
    measurement.error = estimate_factor_error(rows, reference.rows);
    if (!radiosity.empty()) {
        measurement.radiosity =
            estimate_radiosity_error(rows, reference.rows, mesh.areas(),
                                     static_cast<std::uint32_t>(scene.channels.size()),
                                     patch_values(mesh, scene.materials, &Material::reflectance),
                                     patch_values(mesh, scene.materials, &Material::exitance), radiosity)
                .rms;
    }
}

} // namespace

std::string Candidate::description() const {
    if (settings.method != Method::hemicube) {
        std::string text = fmt::format("method {}", to_word(settings.method));
        return settings.rays ? text + fmt::format(", {} rays", *settings.rays) : text;
    }
    std::string text = fmt::format("preset {}", to_word(settings.preset));
    text += settings.eye_points ? fmt::format(", eye points {}", *settings.eye_points) : "";
    text += settings.resolution ? fmt::format(", resolution {}", *settings.resolution) : "";
    text += settings.shadow_rays ? fmt::format(", shadow rays {}", *settings.shadow_rays) : "";
    return text;
}

bool Candidate::is_preset() const {
    return settings.method == Method::hemicube && !settings.eye_points && !settings.resolution &&
           !settings.shadow_rays;
}

Candidate hemicube_candidate(const FactorSettings& base, Preset preset, std::uint32_t patches,
                             std::optional<std::uint32_t> eye_points, std::optional<std::uint32_t> resolution,
                             std::optional<std::uint32_t> shadow_rays) {
    Candidate candidate;
    candidate.settings = base;
    candidate.settings.preset = preset;
    candidate.settings.method = Method::hemicube;
    candidate.settings.eye_points = eye_points;
    candidate.settings.resolution = resolution;
    candidate.settings.shadow_rays = shadow_rays;
    const HemicubeSettings hemicube = plan_rows(candidate.settings, patches).hemicube;
    const std::string points_and_texels = fmt::format("{}x{}", hemicube.eye_points, hemicube.resolution);
    candidate.family = preset != Preset::plain    ? "visibility-weighted"
                       : hemicube.eye_points == 1 ? "plain"
                                                  : "plain, more points";
    candidate.variant = preset == Preset::plain || eye_points || resolution
                            ? points_and_texels
                            : fmt::format("{} ({})", to_word(preset), points_and_texels);
    if (shadow_rays) {
        candidate.variant += *shadow_rays == 0 ? ", no rays" : fmt::format(", {} rays", *shadow_rays);
    }
    return candidate;
}

Candidate baseline_candidate(const FactorSettings& base, Method method, std::uint32_t rays) {
    Candidate candidate;
    candidate.settings = base;
    candidate.settings.method = method;
    candidate.settings.resolution.reset();
    candidate.settings.rays.reset();
    candidate.family = to_word(method);
    if (method == Method::montecarlo) {
        candidate.family = "Monte Carlo";
        candidate.settings.rays = rays;
        candidate.variant = fmt::format("{} rays", rays);
    }
    return candidate;
}

Reference find_reference(const PatchMesh& mesh, std::span<const std::uint32_t> patches,
                         const FactorSettings& base, double seconds, Observer& observer) {
    constexpr std::uint32_t min_rows = 8;
    constexpr std::uint32_t max_rows = 32;
    constexpr std::uint32_t min_resolution = 128;
    const Stopwatch watch;
    FactorSettings best = base;
    best.preset = Preset::exact;
    best.eye_points.reset();
    best.resolution.reset();
    best.shadow_rays.reset();
    Reference reference;
    reference.settings = reference_settings(plan_rows(best, mesh.size()).hemicube);
    reference.settings.eye_points = reference.settings.near_eye_points; // as many as there can be
    reference.settings.resolution = std::max(reference.settings.resolution, min_resolution);
    const auto engine = make_visibility_provider(mesh, reference.settings, base);
    const auto first = reference_patches(patches, 1);
    (void)compute_reference(*engine, mesh, first); // pays for the start
    const Stopwatch one;
    (void)compute_reference(*engine, mesh, first);
    const auto count = static_cast<std::uint32_t>(
        std::clamp<double>(seconds / std::max(one.seconds(), 1e-4), min_rows, max_rows));
    reference.patches = reference_patches(patches, count);
    reference.rows =
        compute_reference(*engine, mesh, reference.patches, progress_of(observer, Phase::error_estimate));
    reference.renderer = engine->renderer();
    reference.seconds = watch.seconds();
    stop_if_interrupted();
    return reference;
}

Measurement try_on_sample(const Scene& scene, const PatchMesh& mesh, const Candidate& candidate,
                          const Reference& reference, std::size_t count, std::span<const double> radiosity,
                          Observer& observer) {
    Measurement measurement;
    const FormFactorMatrix rows =
        rows_of(scene, mesh, candidate.settings, reference.patches, count, measurement.seconds, observer);
    judge(measurement, scene, mesh, rows, reference, radiosity);
    stop_if_interrupted();
    return measurement;
}

Measurement try_on_all(const Scene& scene, const PatchMesh& mesh, const Candidate& candidate,
                       const Reference& reference, std::span<const double> radiosity, FormFactors* rows,
                       Observer& observer) {
    const auto patches = all_patches(mesh.size());
    const Stopwatch watch;
    Measurement measurement;
    measurement.all_rows = true;
    FormFactors factors;
    if (candidate.settings.method != Method::hemicube) { // as the method has them
        factors.matrix = compute_matrix(*make_row_provider(mesh, candidate.settings), patches,
                                        progress_of(observer, Phase::form_factors));
        factors.areas.assign(mesh.areas().begin(), mesh.areas().end());
    } else {
        FactorSettings settings = candidate.settings;
        settings.estimate_error = false;
        factors = compute_form_factors(scene, mesh, settings, observer);
    }
    stop_if_interrupted();
    measurement.seconds = watch.seconds();
    judge(measurement, scene, mesh, factors.matrix, reference, radiosity);
    if (rows != nullptr) {
        *rows = std::move(factors);
    }
    return measurement;
}

std::uint64_t pair_table_bytes(const Candidate& candidate, std::uint32_t patches, std::size_t rows) {
    constexpr std::uint64_t bytes_of_pair = 4; // while both tables are there
    return is_weighted(candidate.settings) ? bytes_of_pair * patches * static_cast<std::uint64_t>(rows) : 0;
}

} // namespace hemi
