#include "hemi/pipeline/cost.hpp"

#include "hemi/pipeline/form_factors.hpp"
#include "pipeline/row_computation.hpp"

#include <algorithm>
#include <thread>

namespace hemi {

namespace {

constexpr std::uint32_t usual_rows = 64;
constexpr double most_seconds = 1.0; // for them

unsigned usable_cores(const FactorSettings& settings) {
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    return settings.engine.jobs > 0 ? std::min(cores, settings.engine.jobs) : cores;
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

} // namespace

FactorCost measure_cost(const PatchMesh& mesh, const FactorSettings& settings) {
    const RowPlan plan = plan_rows(settings, mesh.size());
    const auto patches = all_patches(mesh.size());
    const auto measure_on = [&](auto& provider, const auto& estimate) {
        FactorCost cost = measure([&](std::uint32_t samples) { return estimate(provider, patches, samples); },
                                  mesh.size(), settings);
        cost.renderer = provider.renderer();
        return cost;
    };
    if (settings.method == Method::hemicube && plan.weighted) {
        return measure_on(
            *make_visibility_provider(mesh, plan.hemicube, settings),
            [&mesh](VisibilityProvider& provider, std::span<const std::uint32_t> of, std::uint32_t samples) {
                return estimate_pairs(provider, mesh, of, samples);
            });
    }
    return measure_on(*make_row_provider(mesh, settings), estimate_matrix);
}

} // namespace hemi
