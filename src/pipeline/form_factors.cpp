#include "hemi/pipeline/form_factors.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/engine/reference_rows.hpp"
#include "hemi/engine/touching_faces.hpp"
#include "hemi/io/factor_file.hpp"
#include "pipeline/observed_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace hemi {

namespace {

// Rows that tell what all of them will need, where there are more than so many.
constexpr std::uint32_t sample_rows = 64;
constexpr std::size_t sample_above = 256;

// Of the time that the rows took, spent on reference rows.
constexpr double reference_share = 0.08;

// Relative error of unoccluded factors by the exact rule, see RepairSettings.
constexpr double exact_unoccluded_error = 3e-5;

FormFactors describe(const Scene& scene, const PatchMesh& mesh, const FactorSettings& settings) {
    FormFactors factors;
    factors.areas.assign(mesh.areas().begin(), mesh.areas().end());
    factors.groups = mesh.groups();
    factors.group_of.reserve(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        factors.group_of.push_back(mesh.group(i));
    }
    factors.geometry_hash = mesh.geometry_hash();
    factors.enclosure = scene.enclosure;
    factors.provenance = provenance_of(settings, mesh.size());
    factors.matrix = FormFactorMatrix(mesh.size());
    return factors;
}

/// What raw rows depend on, besides the renderer.
io::CheckpointKey checkpoint_key(const FormFactors& factors, const RowPlan& plan) {
    const HemicubeSettings& hemicube = plan.hemicube;
    return {{"hemi", HEMI_VERSION},
            {"geometry", fmt::format("{:016x}", factors.geometry_hash)},
            {"method", std::string(to_word(factors.provenance.method))},
            {"rows of", plan.weighted ? "visibility" : "form factors"},
            {"resolution", std::to_string(factors.provenance.resolution)},
            {"seed", std::to_string(factors.provenance.seed)},
            {"eye points", std::to_string(hemicube.eye_points)},
            {"eye points near surfaces", std::to_string(hemicube.near_eye_points)},
            {"merging", hemicube.merge_lattices ? "on" : "off"}};
}

std::string limit_text(const FactorSettings& settings) {
    return memory_text(memory_limit(settings)) +
           (settings.max_memory ? "" : ", 80 % of the memory that is free");
}

/// Whether the table of pairs and the matrix fit; says so where they do not.
bool pairs_fit(VisibilityProvider& visibility, std::span<const std::uint32_t> patches,
               const FactorSettings& settings, Observer& observer) {
    const bool sample = patches.size() > sample_above;
    const VisibilityWeightedEstimate estimate =
        estimate_visibility_weighted(visibility, patches, sample ? sample_rows : 0);
    if (sample) {
        observer.detail(fmt::format("{} rows and their pairs will need about {}, and {} for visibility",
                                    count_text(patches.size()), memory_text(estimate.memory_bytes),
                                    seconds_text(estimate.seconds)));
    }
    if (estimate.memory_bytes <= memory_limit(settings)) {
        return true;
    }
    observer.warning(
        fmt::format("preset {} would need {} for the pairs of {} patches; the limit is {}. Plain "
                    "hemicube rows are computed instead",
                    to_word(settings.preset), memory_text(estimate.memory_bytes),
                    count_text(visibility.size()), limit_text(settings)),
        "max-memory");
    return false;
}

void check_memory(RowProvider& engine, std::span<const std::uint32_t> patches, const FactorSettings& settings,
                  Observer& observer) {
    if (patches.size() <= sample_above) {
        return;
    }
    const MatrixEstimate estimate = estimate_matrix(engine, patches, sample_rows);
    observer.detail(fmt::format("{} rows will need about {} and {}", count_text(patches.size()),
                                memory_text(estimate.memory_bytes), seconds_text(estimate.seconds)));
    if (estimate.memory_bytes > memory_limit(settings)) {
        throw OutOfMemory(
            fmt::format("{} rows of about {:.0f} entries would need {}; the limit is {}. Larger "
                        "patches, a lower resolution or a higher limit would help",
                        count_text(patches.size()), estimate.entries_per_row,
                        memory_text(estimate.memory_bytes), limit_text(settings)),
            {"patch-size", "resolution", "max-memory"});
    }
}

/// The provider's part of computed rows: observed, kept, timed.
/// @tparam Row  RowView or VisibilityRow
template <class Row>
class Computation {
public:
    Computation(FormFactors& factors, BasicRowProvider<Row>& provider, Observer& observer,
                RowCheckpoint* checkpoint, io::CheckpointKey key)
        : factors_(factors), provider_(provider), observer_(observer), checkpoint_(checkpoint),
          hemicubes_before_(provider.hemicubes()), rows_(provider, observer, checkpoint, std::move(key)) {}

    [[nodiscard]] BasicRowProvider<Row>& rows() { return rows_; }

    [[nodiscard]] Progress progress(Phase phase) {
        return [this, phase](std::size_t done, std::size_t total) {
            return observer_.progress(phase, done, total);
        };
    }
    /// The same for rows of the engine, whose time counts.
    [[nodiscard]] Progress timed_progress(Phase phase) {
        return [this, phase](std::size_t done, std::size_t total) {
            factors_.work.seconds = watch_.seconds();
            return observer_.progress(phase, done, total);
        };
    }

    void finish(const PatchMesh& mesh, std::size_t patches) {
        factors_.work.hemicubes = provider_.hemicubes() - hemicubes_before_;
        factors_.work.rows = patches - (checkpoint_ != nullptr ? checkpoint_->reused() : 0);
        factors_.provenance.renderer = provider_.renderer();
        factors_.touching = find_touching_faces(factors_.matrix, mesh);
        stop_if_interrupted();
    }

private:
    FormFactors& factors_;
    BasicRowProvider<Row>& provider_;
    Observer& observer_;
    RowCheckpoint* checkpoint_;
    std::uint64_t hemicubes_before_; ///< of samples
    Stopwatch watch_;
    ObservedRows<Row> rows_;
};

FormFactors compute_baseline_rows(const Scene& scene, const PatchMesh& mesh,
                                  std::span<const std::uint32_t> patches, const FactorSettings& settings,
                                  Observer& observer, RowCheckpoint* checkpoint) {
    FormFactors factors = describe(scene, mesh, settings);
    if (settings.method == Method::direct || settings.method == Method::contour) {
        observer.note(fmt::format("method {} finds unoccluded factors", to_word(settings.method)));
    }
    const auto provider = make_row_provider(mesh, settings);
    io::CheckpointKey key = checkpoint_key(factors, {});
    key["rays"] = std::to_string(plan_baseline(settings).rays);
    Computation<RowView> computation(factors, *provider, observer, checkpoint, std::move(key));
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
    FormFactors factors = describe(scene, mesh, settings);
    Computation<RowView> computation(factors, *engine, observer, checkpoint,
                                     checkpoint_key(factors, plan_rows(settings, mesh.size())));
    factors.matrix =
        compute_matrix(computation.rows(), patches, computation.timed_progress(Phase::form_factors));
    computation.finish(mesh, patches.size());
    return factors;
}

FormFactors compute_visibility_weighted_rows(const Scene& scene, const PatchMesh& mesh,
                                             std::span<const std::uint32_t> patches,
                                             const FactorSettings& settings, Observer& observer,
                                             RowCheckpoint* checkpoint) {
    const RowPlan plan = plan_rows(settings, mesh.size());
    const auto engine = make_visibility_provider(mesh, plan.hemicube, settings);
    if (!pairs_fit(*engine, patches, settings, observer)) {
        FactorSettings plain = settings;
        plain.preset = Preset::plain;
        return compute_plain_rows(scene, mesh, patches, plain, observer, checkpoint);
    }
    stop_if_interrupted();
    FormFactors factors = describe(scene, mesh, settings);
    Computation<VisibilityRow> computation(factors, *engine, observer, checkpoint,
                                           checkpoint_key(factors, plan));
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
        FormFactors factors = describe(scene, mesh, settings);
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
                        Observer& observer) {
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
    FactorSettings hemicubes = settings;
    hemicubes.method = Method::hemicube;
    const HemicubeSettings hemicube = plan_rows(hemicubes, mesh.size()).hemicube;
    const auto patches = reference_patches(known, reference_count(hemicube, known.size(), reference_share));
    if (!observer.progress(Phase::error_estimate, 0, patches.size())) {
        throw Cancelled();
    }
    const auto engine = make_visibility_provider(mesh, reference_settings(hemicube), settings);
    factors.reference =
        compute_reference(*engine, mesh, patches, [&observer](std::size_t done, std::size_t total) {
            return observer.progress(Phase::error_estimate, done, total);
        });
    factors.work.reference_seconds = watch.seconds();
    observer.detail(fmt::format("error estimate: {} compared with better ones in {}",
                                plural(patches.size(), "row", "rows"),
                                seconds_text(factors.work.reference_seconds)));
}

FormFactors compute_form_factors(const Scene& scene, const PatchMesh& mesh, const FactorSettings& settings,
                                 Observer& observer) {
    FormFactors factors = compute_raw_form_factors(scene, mesh, all_patches(mesh.size()), settings, observer);
    prepare_form_factors(factors, settings.repair);
    return factors;
}

FormFactors compute_form_factors(const Scene& scene, const PatchMesh& mesh, Preset preset,
                                 Observer& observer) {
    FactorSettings settings;
    settings.preset = preset;
    return compute_form_factors(scene, mesh, settings, observer);
}

void prepare_form_factors(FormFactors& factors, std::optional<Repair> wanted) {
    if (!factors.repair) {
        mark_touching_faces_buried(factors.matrix, factors.touching, factors.enclosure);
        const Repair chosen =
            wanted.value_or(factors.matrix.has_visibility() ? Repair::closure : Repair::none);
        RepairSettings settings;
        if (factors.provenance.exchange_rule == ExchangeRule::exact) {
            settings.unoccluded_error = exact_unoccluded_error;
        }
        factors.repair = repair(factors.matrix, factors.areas, chosen, settings);
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
