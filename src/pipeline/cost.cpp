#include "hemi/pipeline/cost.hpp"

#include "engine/visibility_weighted/factor_assembly.hpp"
#include "engine/visibility_weighted/pair_combination.hpp"
#include "engine/visibility_weighted/visibility_table.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/engine/clustered_rows.hpp"
#include "hemi/engine/visibility_weighted.hpp"
#include "hemi/matrix/repair.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "pipeline/row_computation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>

namespace hemi {

namespace {

constexpr std::uint32_t usual_rows = 64;
constexpr double most_seconds = 1.0; // for them

unsigned usable_cores(const FactorSettings& settings) {
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    return settings.engine.jobs > 0 ? std::min(cores, settings.engine.jobs) : cores;
}

/// So many patches, spread evenly.
std::vector<std::uint32_t> spread(std::uint32_t samples, std::uint32_t patches) {
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t k = 0; k < std::min(samples, patches); ++k) {
        chosen.push_back(static_cast<std::uint32_t>(std::uint64_t{k} * patches / std::min(samples, patches)));
    }
    return chosen;
}

/// @param estimate  what up to so many sampled rows show
template <class Estimate>
FactorCost measure(const Estimate& estimate, std::uint32_t patches, const FactorSettings& settings) {
    FactorCost cost;
    cost.cores = usable_cores(settings);
    const std::uint32_t few = std::min(usual_rows, 2 * cost.cores);
    // Starts contexts and workers, which do not count.
    const double row_seconds = estimate(few).seconds / patches;
    const auto samples =
        static_cast<std::uint32_t>(std::clamp<double>(most_seconds / row_seconds, few, usual_rows));
    const auto found = estimate(samples);
    cost.sampled_rows = std::min(samples, patches);
    cost.entries_per_row = found.entries_per_row;
    cost.memory = found.memory_bytes;
    cost.seconds = found.seconds;
    return cost;
}

/// Seconds of one of many, from what a few and more of them took: what is made once does not count, unless
/// the machine's other work hides the difference.
double seconds_of_one(double few, double for_few, double more, double for_more) {
    return more > few && for_more > for_few ? (for_more - for_few) / (more - few) : for_more / more;
}

/// What single stages take for some rows, the least of several times: others may have been at work as well.
struct StageTimes {
    double pairs = std::numeric_limits<double>::infinity();
    double factors = std::numeric_limits<double>::infinity();
    double closure = std::numeric_limits<double>::infinity(); ///< an iteration and an entry
};

StageTimes time_stages(VisibilityProvider& provider, const ImageMesh& images,
                       std::span<const std::uint32_t> patches, const VisibilityWeightedSettings& settings) {
    constexpr int times = 3;
    constexpr double other_passes = 3.0; // over the entries, besides iterations
    const VisibilityTable table = sample_visibility(provider, patches, images.mesh().size(), false, {});
    StageTimes least;
    const auto lower = [](double& least_time, double time) { least_time = std::min(least_time, time); };
    for (int k = 0; k < times; ++k) {
        VisibilityTable samples = table;
        const Stopwatch combining;
        const PairTable pairs = combine_pairs(std::move(samples), images, settings.shadow_rays, {});
        lower(least.pairs, combining.seconds());
        const Stopwatch assembling;
        FormFactorMatrix matrix = assemble_factors(pairs, images, settings.rule, Enclosure::automatic, {});
        lower(least.factors, assembling.seconds());
        if (k == 0 || matrix.entries() == 0) {
            continue; // memory that is touched for the first time
        }
        const Stopwatch closing;
        const std::span<const double> areas = images.mesh().areas();
        const RepairReport report = repair(matrix, areas.first(images.size()), Repair::closure);
        lower(least.closure, closing.seconds() / (static_cast<double>(matrix.entries()) *
                                                  (report.iterations + other_passes)));
    }
    return least;
}

/// Stages after the visibility of all rows, from a few rows and from more: what is made once does not count.
void add_stages(FactorCost& cost, VisibilityProvider& provider, const PatchMesh& mesh, const RowPlan& plan,
                const FactorSettings& settings) {
    constexpr double usual_passes = 40.0; // of closing rows; rooms take 20 to 50
    const ImageMesh images(mesh);
    const std::vector<std::uint32_t> more = spread(cost.sampled_rows, mesh.size());
    const std::vector<std::uint32_t> few = spread(std::max(1u, cost.sampled_rows / 4), mesh.size());
    const bool all = few.size() == more.size();
    const StageTimes first = time_stages(provider, images, few, *plan.weighted);
    const StageTimes last = all ? first : time_stages(provider, images, more, *plan.weighted);
    // A pair of two rows is looked at once, one with a patch without a row as well.
    const auto pairs = [&images](std::size_t rows) {
        const auto count = static_cast<double>(rows);
        return count * (images.mesh().size() - 0.5 * count);
    };
    const auto whole = [&](double StageTimes::*of) {
        return pairs(mesh.size()) *
               seconds_of_one(pairs(few.size()), first.*of, pairs(more.size()), last.*of);
    };
    cost.stages.push_back({Phase::pairs, whole(&StageTimes::pairs)});
    cost.stages.push_back({Phase::form_factors, whole(&StageTimes::factors)});
    if (settings.repair.value_or(Repair::closure) == Repair::closure) {
        const double entries = cost.entries_per_row * mesh.size();
        cost.stages.push_back(
            {Phase::closure, std::isfinite(last.closure) ? last.closure * entries * usual_passes : 0.0});
    }
}

/// Rows with far patches in clusters, from a few rows and from more.
void measure_clusters(FactorCost& cost, const PatchMesh& mesh, const FactorSettings& settings) {
    const RowPlan plan = plan_clustered_rows(settings, mesh.size());
    const auto provider = make_visibility_provider(mesh, plan.hemicube, settings);
    ClusterSettings clusters;
    clusters.rule = plan.weighted ? plan.weighted->rule : clusters.rule;
    clusters.opening = cluster_opening(settings.cluster_error);
    const auto time = [&](std::uint32_t samples) {
        const std::vector<std::uint32_t> rows = spread(samples, mesh.size());
        const Stopwatch watch;
        FormFactorMatrix matrix =
            compute_clustered(rows_of_rank(*provider), mesh, rows, clusters, Enclosure::automatic);
        return std::pair(watch.seconds(), std::move(matrix));
    };
    const std::uint32_t few = std::max(1u, cost.sampled_rows / 4);
    double first = time(few).first;
    auto [last, sample] = time(cost.sampled_rows);
    constexpr int most_times = 3; // where other work hides that more rows take longer
    for (int k = 1; k < most_times && few < cost.sampled_rows && last <= first; ++k) {
        first = std::min(first, time(few).first);
        last = std::min(last, time(cost.sampled_rows).first);
    }
    cost.clusters = true;
    cost.entries_per_row = static_cast<double>(sample.entries()) / cost.sampled_rows;
    cost.memory = clustered_memory(sample, cost.sampled_rows, mesh.size());
    cost.seconds = mesh.size() * seconds_of_one(few, first, cost.sampled_rows, last);
    cost.stages = {{Phase::visibility, cost.seconds}};
}

} // namespace

double FactorCost::all_seconds() const {
    double sum = 0.0;
    for (const StageCost& stage : stages) {
        sum += stage.seconds;
    }
    return sum;
}

bool needs_clusters(const PatchMesh& mesh, const FactorSettings& settings, double entries_per_row) {
    if (settings.method != Method::hemicube || settings.preset == Preset::plain || mesh.symmetry()) {
        return false;
    }
    return settings.clusters == Clusters::on ||
           (settings.clusters == Clusters::automatic &&
            visibility_weighted_memory(entries_per_row, mesh.size(), mesh.size()) > memory_limit(settings));
}

std::vector<Phase> factor_phases(const PatchMesh& mesh, const FactorSettings& settings) {
    const bool weighted = settings.method == Method::hemicube && settings.preset != Preset::plain;
    if (weighted && needs_clusters(mesh, settings)) { // whose rows come at once, and balance
        return {Phase::visibility};
    }
    std::vector<Phase> phases;
    if (weighted) {
        phases = {Phase::visibility, Phase::pairs};
    }
    phases.push_back(Phase::form_factors);
    if (settings.repair.value_or(weighted ? Repair::closure : Repair::none) == Repair::closure) {
        phases.push_back(Phase::closure);
    }
    return phases;
}

FactorCost measure_cost(const PatchMesh& mesh, const FactorSettings& settings, bool all_stages) {
    const RowPlan plan = plan_rows(settings, mesh.size());
    const auto patches = all_patches(mesh.size());
    const auto measure_on = [&](auto& provider, const auto& estimate) {
        FactorCost cost = measure([&](std::uint32_t samples) { return estimate(provider, patches, samples); },
                                  mesh.size(), settings);
        cost.renderer = provider.renderer();
        return cost;
    };
    FactorCost cost;
    if (settings.method == Method::hemicube && plan.weighted) {
        const auto provider = make_visibility_provider(mesh, plan.hemicube, settings);
        cost = measure_on(*provider,
                          [&mesh](VisibilityProvider& rows, std::span<const std::uint32_t> of,
                                  std::uint32_t samples) { return estimate_pairs(rows, mesh, of, samples); });
        cost.stages = {{Phase::visibility, cost.seconds}};
        if (all_stages && needs_clusters(mesh, settings, cost.entries_per_row)) {
            measure_clusters(cost, mesh, settings);
        } else if (all_stages) {
            add_stages(cost, *provider, mesh, plan, settings);
        }
        return cost;
    }
    cost = measure_on(*make_row_provider(mesh, settings), estimate_matrix);
    cost.stages = {{Phase::form_factors, cost.seconds}};
    return cost;
}

} // namespace hemi
