#include "hemi/core/stopwatch.hpp"
#include "hemi/pipeline/accuracy.hpp"

#include "hemi/core/text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi {

namespace {

constexpr double reference_share = 0.12; // of the budget
constexpr double max_sample_share = 0.5; // of what time is left, for all rows after a sample

// Errors below what float factors can show are compared as this.
constexpr double min_error = 1e-9;
// Errors below this are of no use to anybody: only time counts there.
constexpr double useful_error = 1e-6;

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

/// Whether another entry is as fast and as good, and faster or better.
bool is_beaten(const Trade::Entry& entry, const std::vector<Trade::Entry>& entries) {
    return std::any_of(entries.begin(), entries.end(), [&entry](const Trade::Entry& other) {
        return &other != &entry && other.measurement && other.seconds() <= entry.seconds() &&
               other.error() <= entry.error() &&
               (other.seconds() < entry.seconds() || other.error() < entry.error());
    });
}

double price(const Trade::Entry& entry) {
    return entry.seconds() * std::max(entry.error(), useful_error);
}

class TradeMeasurement {
public:
    TradeMeasurement(const Scene& scene, const PatchMesh& mesh, const FactorSettings& base, double budget,
                     Observer& observer)
        : scene_(scene), mesh_(mesh), base_(base), budget_(budget), observer_(observer) {}

    [[nodiscard]] Trade run() {
        Trade trade;
        trade.entries = all_entries(base_, mesh_.size());
        const auto patches = all_patches(mesh_.size());
        trade.reference = find_reference(mesh_, patches, base_, reference_share * budget_);
        observer_.note(fmt::format("reference: {} by {} sample points of resolution {}, in {}",
                                   plural(trade.reference.patches.size(), "row", "rows"),
                                   trade.reference.settings.eye_points, trade.reference.settings.resolution,
                                   seconds_text(trade.reference.seconds)));
        for (Trade::Entry& entry : trade.entries) {
            measure(entry, trade.reference);
        }
        for (Trade::Entry& entry : trade.entries) {
            entry.front = entry.measurement && !is_beaten(entry, trade.entries);
        }
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
        if (pair_table_bytes(candidate, mesh_.size(), mesh_.size()) > memory_limit(base_)) {
            entry.omitted = "its table of pairs does not fit into the memory";
            return;
        }
        observer_.detail(candidate.label());
        entry.measurement = try_on_sample(scene_, mesh_, candidate, reference, mesh_.size(), radiosity_);
        if (entry.measurement->seconds > max_sample_share * left()) {
            return;
        }
        FormFactors factors;
        entry.measurement = try_on_all(scene_, mesh_, candidate, reference, radiosity_, &factors);
        if (radiosity_.empty() && candidate.settings.method == Method::hemicube) {
            factors.reference = reference.rows;
            estimate_error(factors);
            const Solution solution = solve_radiosity(scene_, mesh_, factors, {}, no_observer(), false);
            radiosity_ = solution.radiosity;
            entry.measurement->radiosity = solution.error->rms;
        }
    }

    const Scene& scene_;
    const PatchMesh& mesh_;
    const FactorSettings& base_;
    double budget_;
    Observer& observer_;
    Stopwatch watch_;
    std::vector<double> radiosity_; ///< of the first rows that were all computed
};

} // namespace

double Trade::Entry::error() const {
    return std::max(measurement->error.row_rms, min_error);
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

const Trade::Entry* Trade::best() const {
    const Entry* best = nullptr;
    for (const Entry& entry : entries) {
        if (entry.front && (best == nullptr || price(entry) < price(*best))) {
            best = &entry;
        }
    }
    return best;
}

const Trade::Entry* Trade::faster() const {
    const Entry* const chosen = best();
    const Entry* faster = nullptr;
    for (const Entry& entry : entries) {
        if (entry.front && entry.seconds() < much_faster * chosen->seconds() &&
            (faster == nullptr || entry.seconds() > faster->seconds())) {
            faster = &entry;
        }
    }
    return faster;
}

const Trade::Entry* Trade::more_accurate() const {
    const Entry* const chosen = best();
    const Entry* better = nullptr;
    for (const Entry& entry : entries) {
        if (entry.front && entry.error() < much_better * chosen->error() && chosen->error() > useful_error &&
            (better == nullptr || entry.seconds() < better->seconds())) {
            better = &entry;
        }
    }
    return better;
}

Trade measure_trade(const Scene& scene, const PatchMesh& mesh, const FactorSettings& base, double budget,
                    Observer& observer) {
    return TradeMeasurement(scene, mesh, base, budget, observer).run();
}

} // namespace hemi
