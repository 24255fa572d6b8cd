#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/pipeline/accuracy.hpp"
#include "pipeline/image_count.hpp"

#include <fmt/format.h>

#include <utility>

namespace hemi {

namespace {

constexpr double reference_seconds = 1.5;

/// Cheap ones first, each better than those before, as a rule.
std::vector<Candidate> all_candidates(const FactorSettings& base, std::uint32_t patches) {
    return {hemicube_candidate(base, Preset::plain, patches, 1, 64),
            hemicube_candidate(base, Preset::plain, patches, 1, 128),
            hemicube_candidate(base, Preset::fast, patches),
            hemicube_candidate(base, Preset::standard, patches),
            hemicube_candidate(base, Preset::standard, patches, 4, 64),
            hemicube_candidate(base, Preset::standard, patches, 9, 128),
            hemicube_candidate(base, Preset::exact, patches),
            hemicube_candidate(base, Preset::exact, patches, 16, 128),
            hemicube_candidate(base, Preset::exact, patches, 36, 128)};
}

/// Goes through settings, the cheapest first. Each is judged by a few rows before all are computed.
class TargetSearch {
public:
    TargetSearch(const Scene& scene, const PatchMesh& mesh, std::span<const std::uint32_t> patches,
                 const FactorSettings& base, double target, Observer& observer)
        : scene_(scene), mesh_(mesh), patches_(patches), target_(target), observer_(observer),
          memory_limit_(memory_limit(base)),
          reference_(find_reference(mesh, patches, base, reference_seconds, observer)),
          candidates_(all_candidates(base, mesh.size())) {}

    /// The cheapest candidate, whatever it is good for.
    [[nodiscard]] const Candidate& first() { return candidates_[next_++]; }

    /// The next candidate that meets the target on the sample.
    /// @param radiosity  N·channels of about what it is; empty: rows are judged
    /// @throws TargetMissed if none does within the limits.
    [[nodiscard]] const Candidate& next(std::span<const double> radiosity) {
        while (next_ < candidates_.size()) {
            const Candidate& candidate = candidates_[next_++];
            if (image_count(mesh_) * pair_table_bytes(candidate, mesh_.size(), patches_.size()) >
                memory_limit_) {
                too_large_ = candidate.description();
                continue;
            }
            const Measurement measurement =
                try_on_sample(scene_, mesh_, candidate, reference_, patches_.size(), radiosity, observer_);
            const double error = measurement.radiosity.value_or(measurement.error.row_rms);
            observer_.detail(fmt::format("{}: error {:.2g} on {}, {} for all rows", candidate.description(),
                                         error, plural(reference_.patches.size(), "row", "rows"),
                                         seconds_text(measurement.seconds)));
            remember(error);
            if (error <= target_) {
                return candidate;
            }
        }
        give_up();
    }

    /// Whether what came of the last candidate in the end, all rows and prepared, meets the target.
    [[nodiscard]] bool met(double error) {
        remember(error);
        if (error > target_) {
            observer_.detail(fmt::format("{}: error {:.2g} with all rows, more than {:.6g}",
                                         last().description(), error, target_));
        }
        return error <= target_;
    }

    [[nodiscard]] const Reference& reference() const { return reference_; }

    /// Raw rows of a candidate with the search's own reference.
    [[nodiscard]] FormFactors compute(const Candidate& candidate) const {
        FactorSettings settings = candidate.settings;
        settings.estimate_error = false;
        FormFactors factors = compute_raw_form_factors(scene_, mesh_, patches_, settings, observer_);
        factors.reference = reference_.rows;
        factors.provenance.chosen_for =
            fmt::format("{}, for an error target of {:.6g}", candidate.description(), target_);
        return factors;
    }

private:
    [[nodiscard]] const Candidate& last() const { return candidates_[next_ - 1]; }

    void remember(double error) {
        if (best_.empty() || error < best_error_) {
            best_error_ = error;
            best_ = last().description();
        }
    }

    [[noreturn]] void give_up() const {
        std::string message = fmt::format("an error target of {:.6g} cannot be met", target_);
        if (!best_.empty()) {
            message += fmt::format(": the best settings, {}, have an error of {:.2g}", best_, best_error_);
        }
        if (!too_large_.empty()) {
            message += fmt::format("; {} needs more than the {} of memory that it may take", too_large_,
                                   memory_text(memory_limit_));
        }
        throw TargetMissed(message, {"error-target"});
    }

    const Scene& scene_;
    const PatchMesh& mesh_;
    std::span<const std::uint32_t> patches_;
    double target_;
    Observer& observer_;
    std::uint64_t memory_limit_;
    Reference reference_;
    std::vector<Candidate> candidates_;
    std::size_t next_ = 0;
    double best_error_ = 0.0;
    std::string best_;
    std::string too_large_; ///< candidates that do not fit the memory
};

} // namespace

TargetResult factors_to_target(const Scene& scene, const PatchMesh& mesh, const FactorSettings& base,
                               double target, Observer& observer) {
    const auto patches = all_patches(mesh.size());
    TargetResult result;
    const Stopwatch search_watch;
    TargetSearch search(scene, mesh, patches, base, target, observer);
    result.search_seconds = search_watch.seconds();
    for (;;) {
        const Stopwatch next_watch;
        const Candidate& candidate = search.next({});
        result.search_seconds += next_watch.seconds();
        const Stopwatch watch;
        result.raw = search.compute(candidate);
        result.factors = result.raw;
        prepare_form_factors(result.factors, base.repair, observer);
        result.factor_seconds += watch.seconds();
        if (search.met(result.factors.error ? result.factors.error->row_rms : 0.0)) {
            return result;
        }
    }
}

TargetResult solve_to_target(const Scene& scene, const PatchMesh& mesh,
                             std::span<const std::uint32_t> patches, const FactorSettings& base,
                             const SolverSettings& solver, double target, Observer& observer,
                             bool with_irradiance) {
    if (patches.empty()) {
        throw InvalidArgument(
            "nothing in the scene reflects, so that no form factors are needed and nothing can be "
            "in error",
            {"error-target"});
    }
    TargetResult result;
    const Stopwatch search_watch;
    TargetSearch search(scene, mesh, patches, base, target, observer);
    const Candidate* candidate = &search.first();
    result.search_seconds = search_watch.seconds();
    for (;;) {
        const Stopwatch watch;
        result.raw = search.compute(*candidate);
        result.factor_seconds = watch.seconds();
        result.factors = result.raw;
        prepare_form_factors(result.factors, base.repair, observer);
        result.solution = solve_radiosity(scene, mesh, result.factors, solver, observer, with_irradiance);
        if (search.met(result.solution.error ? result.solution.error->rms : 0.0)) {
            return result;
        }
        const Stopwatch next_watch;
        candidate = &search.next(result.solution.radiosity);
        result.search_seconds += next_watch.seconds();
    }
}

} // namespace hemi
