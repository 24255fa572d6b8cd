#include "hemi/pipeline/cost.hpp"

#include "hemi/pipeline/form_factors.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

namespace hemi {

FactorCost estimate_cost(const PatchMesh& mesh, const FactorSettings& settings) {
    // On the software rasteriser a hemicube of resolution 128 takes a core 0.5 ms and 1 µs more for every
    // polygon drawn, a third more where what is hidden is counted too; then a pair takes 0.1 µs.
    constexpr double fixed_seconds = 0.1e-3;
    constexpr double texel_seconds = 0.4e-3 / (128.0 * 128.0);
    constexpr double polygon_seconds = 1e-6;
    constexpr double visibility_factor = 1.33;
    constexpr double pair_seconds = 0.1e-6;
    // A patch sees about half of the others; texels show only one of those that share one.
    constexpr double share_in_view = 0.5;
    constexpr double spare_memory = 1.2;

    const double patches = mesh.size();
    const RowPlan plan = plan_rows(settings, mesh.size());
    const double resolution = plan.hemicube.resolution;
    const double texels = 3.0 * resolution * resolution;
    const double in_view = share_in_view * patches;
    FactorCost cost;
    cost.cores =
        settings.engine.jobs > 0 ? settings.engine.jobs : std::max(1u, std::thread::hardware_concurrency());
    const auto polygons = static_cast<double>(count_draw_polygons(mesh, settings.merge_lattices));
    const double hemicube =
        fixed_seconds + texel_seconds * resolution * resolution + polygon_seconds * polygons;
    const double hemicubes = patches * plan.hemicube.eye_points;
    if (plan.weighted) {
        const double pairs = 0.5 * patches * patches;
        cost.entries_per_row = in_view;
        cost.memory =
            static_cast<std::uint64_t>(patches * (spare_memory * (9.0 * in_view + 25.0) + 4.0 * patches));
        cost.seconds = (visibility_factor * hemicube * hemicubes + pair_seconds * pairs) / cost.cores;
    } else {
        cost.entries_per_row = texels * -std::expm1(-in_view / texels);
        cost.memory =
            static_cast<std::uint64_t>(spare_memory * patches * (8.0 * cost.entries_per_row + 25.0));
        cost.seconds = hemicube * hemicubes / cost.cores;
    }
    return cost;
}

FactorCost measure_cost(const PatchMesh& mesh, const FactorSettings& settings) {
    const RowPlan plan = plan_rows(settings, mesh.size());
    const auto take = [](const auto& estimate, const std::string& renderer) {
        FactorCost cost;
        cost.entries_per_row = estimate.entries_per_row;
        cost.memory = estimate.memory_bytes;
        cost.seconds = estimate.seconds;
        cost.renderer = renderer;
        return cost;
    };
    const auto patches = all_patches(mesh.size());
    if (plan.weighted) {
        const auto engine = make_visibility_provider(mesh, plan.hemicube, settings);
        return take(estimate_visibility_weighted(*engine, patches), engine->renderer());
    }
    const auto engine = make_row_provider(mesh, settings);
    return take(estimate_matrix(*engine, patches), engine->renderer());
}

} // namespace hemi
