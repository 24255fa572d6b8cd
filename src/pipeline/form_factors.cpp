#include "hemi/pipeline/form_factors.hpp"

#include "engine/environment_verdict.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/engine/clustered_rows.hpp"
#include "hemi/engine/reference_rows.hpp"
#include "hemi/engine/touching_faces.hpp"
#include "hemi/io/factor_file.hpp"
#include "pipeline/kept_clustered_rows.hpp"
#include "pipeline/row_computation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

namespace hemi {

namespace {

/// Whether the table of pairs and the matrix fit; says so where they do not, and what is done instead.
bool pairs_fit(VisibilityProvider& visibility, const PatchMesh& mesh, std::span<const std::uint32_t> patches,
               const FactorSettings& settings, Observer& observer) {
    const bool sample = patches.size() > unsampled_rows;
    const VisibilityWeightedEstimate estimate =
        estimate_pairs(visibility, mesh, patches, sample ? sampled_rows : 0);
    if (sample) {
        observer.detail(fmt::format("{} rows and their pairs will need about {}, and {} for visibility",
                                    count_text(patches.size()), memory_text(estimate.memory_bytes),
                                    seconds_text(estimate.seconds)));
    }
    if (estimate.memory_bytes <= memory_limit(settings)) {
        return true;
    }
    const std::string need = fmt::format(
        "preset {} would need {} for the pairs of {} patches; the limit is {}", to_word(settings.preset),
        memory_text(estimate.memory_bytes), count_text(visibility.size()), memory_limit_text(settings));
    if (settings.clusters == Clusters::automatic) {
        observer.note(fmt::format("{}. Far patches are seen in clusters", need));
    } else {
        observer.warning(fmt::format("{}. Plain hemicube rows are computed instead", need), "max-memory");
    }
    return false;
}

FormFactors compute_baseline_rows(const Scene& scene, const PatchMesh& mesh,
                                  std::span<const std::uint32_t> patches, const FactorSettings& settings,
                                  Observer& observer, RowCheckpoint* checkpoint) {
    FormFactors factors = describe_form_factors(scene, mesh, settings);
    note_unoccluded(settings.method, observer);
    const auto provider = make_row_provider(mesh, settings);
    Computation<RowView> computation(factors, *provider, observer, checkpoint,
                                     raw_row_key(factors, settings));
    factors.matrix = compute_matrix(computation.rows(), patches, computation.progress(Phase::form_factors));
    computation.finish(mesh, patches.size());
    factors.work.seconds = 0.0;
    return factors;
}

FormFactors compute_plain_rows(const Scene& scene, const PatchMesh& mesh,
                               std::span<const std::uint32_t> patches, const FactorSettings& settings,
                               Observer& observer, RowCheckpoint* checkpoint) {
    const auto engine = make_row_provider(mesh, settings);
    check_memory(*engine, patches, settings, observer);
    stop_if_interrupted();
    FormFactors factors = describe_form_factors(scene, mesh, settings);
    Computation<RowView> computation(factors, *engine, observer, checkpoint, raw_row_key(factors, settings));
    factors.matrix =
        compute_matrix(computation.rows(), patches, computation.timed_progress(Phase::form_factors));
    computation.finish(mesh, patches.size());
    return factors;
}

/// What rows of clusters will need, from a few of them.
MatrixEstimate estimate_clustered(VisibilityProvider& engine, const PatchMesh& mesh,
                                  std::span<const std::uint32_t> patches, const ClusterSettings& settings) {
    std::vector<std::uint32_t> sample;
    for (std::size_t k = 0; k < sampled_rows; ++k) {
        sample.push_back(patches[k * patches.size() / sampled_rows]);
    }
    const Stopwatch watch;
    double seconds = 0.0;
    const FormFactorMatrix rows =
        compute_clustered(rows_of_rank(engine), mesh, sample, settings, Enclosure::open,
                          [&](std::size_t /*done*/, std::size_t /*total*/) {
                              seconds = watch.seconds();
                              return true;
                          });
    MatrixEstimate estimate;
    estimate.entries_per_row = static_cast<double>(rows.entries()) / sampled_rows;
    estimate.memory_bytes = clustered_memory(rows, sampled_rows, patches.size());
    estimate.seconds = seconds / sampled_rows * static_cast<double>(patches.size());
    return estimate;
}

FormFactors compute_rows_of_clusters(const Scene& scene, const PatchMesh& mesh,
                                     std::span<const std::uint32_t> patches, const FactorSettings& settings,
                                     Observer& observer, RowCheckpoint* checkpoint) {
    const RowPlan plan = plan_clustered_rows(settings, mesh.size());
    const auto engine = make_visibility_provider(mesh, plan.hemicube, settings);
    FormFactors factors = describe_form_factors(scene, mesh, settings);
    factors.provenance.eye_points = plan.hemicube.eye_points;
    factors.provenance.shadow_rays = plan.weighted->shadow_rays;
    Computation<VisibilityRow> computation(factors, *engine, observer, nullptr, {});
    ClusterSettings clusters;
    clusters.rule = factors.provenance.exchange_rule;
    clusters.opening = cluster_opening(settings.cluster_error);
    clusters.max_memory = memory_limit(settings);
    clusters.apart = emitting_patches(scene, mesh);
    if (patches.size() > unsampled_rows) {
        check_estimate(estimate_clustered(*engine, mesh, patches, clusters), patches.size(), settings,
                       observer, "Larger patches, a larger cluster error or a higher limit");
        stop_if_interrupted();
    }
    std::optional<KeptClusteredRows> kept;
    if (checkpoint != nullptr) {
        io::CheckpointKey key = clustered_row_key(factors, settings, clusters);
        key["renderer"] = engine->renderer(); // others give other bits
        kept.emplace(*checkpoint, std::move(key), observer);
    }
    factors.matrix =
        compute_clustered(computation.rows_of_this_rank(), mesh, patches, clusters, scene.enclosure,
                          computation.timed_progress(Phase::visibility), kept ? &*kept : nullptr);
    computation.finish(mesh, patches.size());
    factors.work.rows -= checkpoint != nullptr ? checkpoint->reused() : 0;
    return factors;
}

FormFactors compute_visibility_weighted_rows(const Scene& scene, const PatchMesh& mesh,
                                             std::span<const std::uint32_t> patches,
                                             const FactorSettings& given, Observer& observer,
                                             RowCheckpoint* checkpoint) {
    FactorSettings settings = given;
    if (mesh.symmetry()) {
        if (settings.clusters == Clusters::on) {
            throw InvalidArgument("clusters are not made of a scene with symmetry, whose images fold into "
                                  "single patches; leave one of them out",
                                  {"clusters"});
        }
        settings.clusters = Clusters::off;
    }
    if (settings.clusters == Clusters::on) {
        return compute_rows_of_clusters(scene, mesh, patches, settings, observer, checkpoint);
    }
    const RowPlan plan = plan_rows(settings, mesh.size());
    const auto engine = make_visibility_provider(mesh, plan.hemicube, settings);
    if (!pairs_fit(*engine, mesh, patches, settings, observer)) {
        if (settings.clusters == Clusters::automatic) {
            stop_if_interrupted();
            return compute_rows_of_clusters(scene, mesh, patches, settings, observer, checkpoint);
        }
        FactorSettings plain = settings;
        plain.preset = Preset::plain;
        return compute_plain_rows(scene, mesh, patches, plain, observer, checkpoint);
    }
    stop_if_interrupted();
    FormFactors factors = describe_form_factors(scene, mesh, settings);
    Computation<VisibilityRow> computation(factors, *engine, observer, checkpoint,
                                           raw_row_key(factors, settings));
    factors.matrix = compute_visibility_weighted(
        computation.rows(), mesh, patches, *plan.weighted, scene.enclosure,
        computation.timed_progress(Phase::visibility), computation.progress(Phase::pairs),
        computation.progress(Phase::form_factors));
    computation.finish(mesh, patches.size());
    return factors;
}

} // namespace

FormFactors compute_raw_form_factors(const Scene& scene, const PatchMesh& mesh,
                                     std::span<const std::uint32_t> patches, const FactorSettings& settings,
                                     Observer& observer, RowCheckpoint* checkpoint) {
    if (settings.method == Method::hemicube && patches.empty()) {
        FormFactors factors = describe_form_factors(scene, mesh, settings);
        factors.provenance.renderer = "none";
        return factors;
    }
    const auto compute = settings.method != Method::hemicube ? compute_baseline_rows
                         : settings.preset == Preset::plain  ? compute_plain_rows
                                                             : compute_visibility_weighted_rows;
    FormFactors factors = compute(scene, mesh, patches, settings, observer, checkpoint);
    if (settings.estimate_error) {
        add_reference_rows(factors, mesh, settings, observer);
    }
    return factors;
}

void add_reference_rows(FormFactors& factors, const PatchMesh& mesh, const FactorSettings& settings,
                        Observer& observer, std::uint32_t most) {
    std::vector<std::uint32_t> known;
    for (std::uint32_t i = 0; i < factors.matrix.size(); ++i) {
        if (factors.matrix.known(i)) {
            known.push_back(i);
        }
    }
    if (known.empty()) {
        return;
    }
    const Stopwatch watch;
    const auto [hemicube, patches] = plan_reference(known, settings, mesh.size(), most);
    if (!observer.progress(Phase::error_estimate, 0, patches.size())) {
        throw Cancelled();
    }
    const auto engine = make_visibility_provider(mesh, hemicube, settings);
    factors.reference =
        compute_reference(*engine, mesh, patches, [&observer](std::size_t done, std::size_t total) {
            return observer.progress(Phase::error_estimate, done, total);
        });
    const double seconds = watch.seconds();
    factors.work.reference_seconds += seconds;
    observer.detail(fmt::format("error estimate: {} compared with better ones in {}",
                                plural(patches.size(), "row", "rows"), seconds_text(seconds)));
}

FormFactors compute_form_factors(const Scene& scene, const PatchMesh& mesh, const FactorSettings& settings,
                                 Observer& observer) {
    FormFactors factors = compute_raw_form_factors(scene, mesh, all_patches(mesh.size()), settings, observer);
    prepare_form_factors(factors, settings.repair, observer);
    return factors;
}

FormFactors compute_form_factors(const Scene& scene, const PatchMesh& mesh, Preset preset,
                                 Observer& observer) {
    FactorSettings settings;
    settings.preset = preset;
    return compute_form_factors(scene, mesh, settings, observer);
}

void prepare_form_factors(FormFactors& factors, std::optional<Repair> wanted, Observer& observer) {
    if (!factors.repair) {
        mark_touching_faces_buried(factors.matrix, factors.touching, factors.enclosure);
        const Repair chosen = wanted.value_or(
            factors.matrix.has_visibility() && factors.matrix.clusters() == nullptr ? Repair::closure
                                                                                    : Repair::none);
        RepairSettings settings;
        if (factors.provenance.exchange_rule == ExchangeRule::exact) {
            settings.unoccluded_error = unoccluded_error(ExchangeRule::exact);
        }
        factors.repair = repair(factors.matrix, factors.areas, chosen, settings,
                                [&observer](std::size_t done, std::size_t total) {
                                    return observer.progress(Phase::closure, done, total);
                                });
    }
    estimate_error(factors);
}

void estimate_error(FormFactors& factors) {
    factors.error.reset();
    if (factors.reference.size() == factors.matrix.size() && factors.reference.entries() > 0) {
        factors.error = estimate_factor_error(factors.matrix, factors.reference);
    }
}

FormFactors read_form_factors(const std::filesystem::path& path, const Scene& scene, const PatchMesh& mesh) {
    FormFactors factors = io::read_hff(path);
    if (factors.geometry_hash != mesh.geometry_hash() || factors.matrix.size() != mesh.size()) {
        throw InputError(fmt::format(
            "{}: these form factors belong to another geometry ({}; this scene has {}); "
            "remove the file or name another one",
            path.string(), plural(factors.matrix.size(), "patch", "patches"), count_text(mesh.size())));
    }
    factors.enclosure = scene.enclosure;
    factors.work.from_file = true;
    return factors;
}

std::vector<std::uint32_t> all_patches(std::uint32_t size) {
    std::vector<std::uint32_t> patches(size);
    std::iota(patches.begin(), patches.end(), 0u);
    return patches;
}

} // namespace hemi
