#include "hemi/pipeline/trade.hpp"

#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "pipeline/answers.hpp"
#include "pipeline/failure.hpp"
#include "pipeline/image_count.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi {

namespace {

constexpr double share_of_reference = 0.06; // of the budget
constexpr double least_factors_share = 0.1; // for form factors, whatever solutions took
constexpr double max_sample_share = 0.5;    // of what time is left, for all rows after a sample

// Errors below what float factors can show are compared as this.
constexpr double min_error = 1e-9;
// Less than these is of no use to anybody.
constexpr Offer useful_factors{0.0, 1e-6};
constexpr Offer useful_answer{1.0, 1e-3};

// What makes a difference to the best entry.
constexpr double much_faster = 0.7;
constexpr double much_better = 0.6;

bool same_rows(const FactorSettings& a, const FactorSettings& b, std::uint32_t patches) {
    if (a.method != Method::hemicube || b.method != Method::hemicube) {
        return false;
    }
    const RowPlan plan_a = plan_rows(a, patches);
    RowPlan plan_b = plan_rows(b, patches);
    // More points near surfaces are no reason to try the same points twice.
    plan_b.hemicube.near_eye_points = plan_a.hemicube.near_eye_points;
    return plan_a.hemicube == plan_b.hemicube && plan_a.weighted == plan_b.weighted;
}

std::vector<Trade::Entry> all_entries(const FactorSettings& base, std::uint32_t patches) {
    std::vector<Trade::Entry> entries;
    const auto add = [&entries](Candidate candidate) {
        entries.push_back({std::move(candidate), {}, "", false});
    };
    const auto hemicube = [&](Preset preset, std::optional<std::uint32_t> points = {},
                              std::optional<std::uint32_t> resolution = {},
                              std::optional<std::uint32_t> rays = {}) {
        Candidate candidate = hemicube_candidate(base, preset, patches, points, resolution, rays);
        if (std::none_of(entries.begin(), entries.end(), [&](const Trade::Entry& entry) {
                return same_rows(entry.candidate.settings, candidate.settings, patches);
            })) {
            add(std::move(candidate));
        }
    };
    hemicube(Preset::plain, 1, 32);
    hemicube(Preset::plain, 1, 64);
    hemicube(Preset::plain, 1, 128);
    hemicube(Preset::fast);
    hemicube(Preset::standard, {}, {}, 0);
    hemicube(Preset::standard);
    const bool few = patches <= max_baseline_patches;
    if (few) {
        add(baseline_candidate(base, Method::montecarlo, 1024));
        add(baseline_candidate(base, Method::montecarlo, 4096));
    }
    hemicube(Preset::plain, 1, 256);
    hemicube(Preset::plain, 4, 64);
    hemicube(Preset::standard, 4, 64);
    if (few) {
        add(baseline_candidate(base, Method::montecarlo, 16384));
        add(baseline_candidate(base, Method::hemisphere));
    }
    hemicube(Preset::plain, 1, 512);
    hemicube(Preset::plain, 16, 64);
    hemicube(Preset::standard, 9, 64);
    hemicube(Preset::exact);
    if (few) {
        add(baseline_candidate(base, Method::montecarlo, 65536));
        add(baseline_candidate(base, Method::contour));
        add(baseline_candidate(base, Method::direct));
    }
    return entries;
}

class TradeMeasurement {
public:
    TradeMeasurement(const Answers::Subject& subject, double budget, Observer& observer)
        : scene_(subject.scene), mesh_(subject.mesh), base_(subject.base), budget_(budget),
          observer_(observer), answers_(subject, budget, observer) {}

    [[nodiscard]] Trade run() {
        Trade trade;
        trade.entries = all_entries(base_, mesh_.size());
        const auto patches = all_patches(mesh_.size());
        trade.reference = find_reference(mesh_, patches, base_, share_of_reference * budget_, observer_);
        observer_.note(fmt::format("reference: {} by {} sample points of resolution {}, in {}",
                                   plural(trade.reference.patches.size(), "row", "rows"),
                                   trade.reference.settings.eye_points, trade.reference.settings.resolution,
                                   seconds_text(trade.reference.seconds)));
        trade.unanswered = answers_.obstacle();
        if (trade.unanswered.empty()) {
            answers_.solve_uniform([&](Preset preset) {
                for (Trade::Entry& entry : trade.entries) {
                    if (entry.candidate.is_preset() && entry.candidate.settings.preset == preset) {
                        measure_all(entry, trade.reference);
                    }
                }
            });
            answers_.refine();
            budget_ = std::max(budget_ - answers_.reference_seconds(),
                               watch_.seconds() + least_factors_share * budget_);
        }
        for (Trade::Entry& entry : trade.entries) {
            if (!entry.measurement && entry.omitted.empty()) {
                measure(entry, trade.reference);
            }
        }
        if (trade.unanswered.empty()) {
            answers_.judge(trade);
        }
        find_fronts(trade);
        return trade;
    }

private:
    [[nodiscard]] double left() const { return budget_ - watch_.seconds(); }

    /// On a sample first; then on all rows if half of what time is left will do.
    void measure(Trade::Entry& entry, const Reference& reference) {
        const Candidate& candidate = entry.candidate;
        if (left() <= 0.0) {
            entry.omitted = "no time was left";
            return;
        }
        if (image_count(mesh_) * pair_table_bytes(candidate, mesh_.size(), mesh_.size()) >
            memory_limit(base_)) {
            entry.omitted = "its table of pairs does not fit into the memory";
            return;
        }
        observer_.detail(candidate.label());
        if (const auto why = failure([&] {
                entry.measurement =
                    try_on_sample(scene_, mesh_, candidate, reference, mesh_.size(), radiosity_, observer_);
            })) {
            entry.omitted = *why;
            return;
        }
        if (entry.measurement->seconds <= max_sample_share * left()) {
            measure_all(entry, reference);
        }
    }

    void measure_all(Trade::Entry& entry, const Reference& reference) {
        const Candidate& candidate = entry.candidate;
        FormFactors factors;
        if (const auto why = failure([&] {
                entry.measurement =
                    try_on_all(scene_, mesh_, candidate, reference, radiosity_, &factors, observer_);
            })) {
            entry.omitted = *why; // of no matter where there is a sample
            return;
        }
        answers_.add_own(candidate, factors, entry.measurement->seconds, entry.measurement->error.row_rms);
        if (radiosity_.empty() && candidate.settings.method == Method::hemicube) {
            (void)failure([&] { // then nothing is said about radiosity
                factors.reference = reference.rows;
                estimate_error(factors);
                const Solution solution = solve_radiosity(scene_, mesh_, factors, {}, observer_, false);
                radiosity_ = solution.radiosity;
                if (solution.error) {
                    entry.measurement->radiosity = solution.error->rms;
                }
            });
        }
    }

    static void find_fronts(Trade& trade) {
        std::vector<Offer> offers;
        std::vector<Trade::Entry*> measured;
        for (Trade::Entry& entry : trade.entries) {
            if (entry.measurement) {
                measured.push_back(&entry);
                offers.push_back({entry.seconds(), entry.error()});
            }
        }
        std::vector<bool> front = pareto_front(offers);
        for (std::size_t k = 0; k < measured.size(); ++k) {
            measured[k]->front = front[k];
        }
        offers.clear();
        for (const Trade::Answer& answer : trade.answers) {
            offers.push_back({answer.seconds, answer.vertices()});
        }
        front = pareto_front(offers);
        for (std::size_t k = 0; k < trade.answers.size(); ++k) {
            trade.answers[k].front = front[k];
        }
    }

    const Scene& scene_;
    const PatchMesh& mesh_;
    const FactorSettings& base_;
    double budget_;
    Observer& observer_;
    Stopwatch watch_;
    Answers answers_;
    std::vector<double> radiosity_; ///< of the first rows that were all computed
};

} // namespace

std::vector<bool> pareto_front(std::span<const Offer> offers) {
    std::vector<bool> front;
    for (const Offer& offer : offers) {
        front.push_back(std::none_of(offers.begin(), offers.end(), [&offer](const Offer& other) {
            return other.seconds <= offer.seconds && other.error <= offer.error &&
                   (other.seconds < offer.seconds || other.error < offer.error);
        }));
    }
    return front;
}

Recommendation recommend(std::span<const Offer> offers, const Offer& useful) {
    const std::vector<bool> front = pareto_front(offers);
    Recommendation result;
    const auto price = [&](std::size_t k) {
        return std::max(offers[k].seconds, useful.seconds) * std::max(offers[k].error, useful.error);
    };
    for (std::size_t k = 0; k < offers.size(); ++k) {
        if (front[k] && (!result.best || price(k) < price(*result.best))) {
            result.best = k;
        }
    }
    if (!result.best) {
        return result;
    }
    const Offer& best = offers[*result.best];
    for (std::size_t k = 0; k < offers.size(); ++k) {
        if (!front[k]) {
            continue;
        }
        if (offers[k].seconds < much_faster * best.seconds && best.seconds > useful.seconds &&
            (!result.faster || offers[k].seconds > offers[*result.faster].seconds)) {
            result.faster = k;
        }
        if (offers[k].error < much_better * best.error && best.error > useful.error &&
            (!result.more_accurate || offers[k].seconds < offers[*result.more_accurate].seconds)) {
            result.more_accurate = k;
        }
    }
    return result;
}

double Trade::Entry::error() const {
    return std::max(measurement->error.row_rms, min_error);
}

double Trade::Answer::vertices() const {
    return std::max(error.vertices.rms, useful_factors.error);
}

std::vector<const Trade::Entry*> Trade::by_time() const {
    std::vector<const Entry*> measured;
    for (const Entry& entry : entries) {
        if (entry.measurement) {
            measured.push_back(&entry);
        }
    }
    std::stable_sort(measured.begin(), measured.end(),
                     [](const Entry* a, const Entry* b) { return a->seconds() < b->seconds(); });
    return measured;
}

std::vector<const Trade::Answer*> Trade::answers_by_time() const {
    std::vector<const Answer*> sorted;
    for (const Answer& answer : answers) {
        sorted.push_back(&answer);
    }
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Answer* a, const Answer* b) { return a->seconds < b->seconds; });
    return sorted;
}

Recommendation Trade::recommended_answers() const {
    std::vector<Offer> offers;
    for (const Answer* const answer : answers_by_time()) {
        offers.push_back({answer->seconds, answer->vertices()});
    }
    return recommend(offers, useful_answer);
}

Recommendation Trade::recommended_entries() const {
    std::vector<Offer> offers;
    for (const Entry* const entry : by_time()) {
        offers.push_back({entry->seconds(), entry->error()});
    }
    return recommend(offers, useful_factors);
}

Trade measure_trade(const Scene& scene, const PatchMesh& mesh, const Subdivision& subdivision,
                    bool with_imprint, const FactorSettings& base, double budget, Observer& observer) {
    return TradeMeasurement({scene, mesh, subdivision, with_imprint, base}, budget, observer).run();
}

} // namespace hemi
