#include "hemi/pipeline/settings.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/ranks.hpp"
#include "pipeline/divided_rows.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <utility>

namespace hemi {

namespace {

// Hemicubes that a preset spends on a scene, as far as the limits of sample points a patch allow.
constexpr std::uint32_t standard_hemicubes = 6000;
constexpr std::uint32_t exact_hemicubes = 20000;

/// The largest square up to `max_points` of which `hemicubes` allow every patch that many; at least
/// `min_points`.
std::uint32_t eye_points_for(std::uint32_t hemicubes, std::uint32_t patches, std::uint32_t min_points,
                             std::uint32_t max_points) {
    const double side = std::floor(std::sqrt(static_cast<double>(hemicubes) / std::max(patches, 1u)));
    const auto k = static_cast<std::uint32_t>(std::clamp(side, 1.0, 8.0));
    return std::clamp(k * k, min_points, max_points);
}

/// MemAvailable of /proc/meminfo in bytes; without it nothing is refused.
std::uint64_t available_memory() {
    std::ifstream meminfo("/proc/meminfo");
    std::string name;
    std::uint64_t kibibytes = 0;
    std::string unit;
    while (meminfo >> name >> kibibytes) {
        if (name == "MemAvailable:") {
            return kibibytes * 1024;
        }
        std::getline(meminfo, unit);
    }
    return std::numeric_limits<std::uint64_t>::max();
}

EngineSettings with_workers(EngineSettings engine) {
    if (engine.worker_program.empty()) {
        engine.worker_program = find_worker_program();
    }
    return engine;
}

/// The rows of a provider, shared out where there are several ranks.
template <class Row>
std::unique_ptr<BasicRowProvider<Row>> divided(std::unique_ptr<BasicRowProvider<Row>> rows) {
    if (ranks().size() > 1) {
        rows = std::make_unique<DividedRows<Row>>(std::move(rows));
    }
    return rows;
}

} // namespace

RowPlan plan_rows(const FactorSettings& settings, std::uint32_t patches) {
    RowPlan plan;
    HemicubeSettings& hemicube = plan.hemicube;
    if (settings.preset != Preset::plain) {
        plan.weighted.emplace();
    }
    switch (settings.preset) {
    case Preset::plain:
        break;
    case Preset::fast:
        hemicube.resolution = 64;
        hemicube.near_eye_points = 4;
        break;
    case Preset::standard:
        hemicube.eye_points = eye_points_for(standard_hemicubes, patches, 4, 16);
        hemicube.resolution = 64;
        hemicube.near_eye_points = 16;
        plan.weighted->shadow_rays = 16;
        break;
    case Preset::exact:
        hemicube.eye_points = eye_points_for(exact_hemicubes, patches, 4, 64);
        hemicube.resolution = 128;
        hemicube.near_eye_points = 64;
        plan.weighted->rule = ExchangeRule::exact;
        plan.weighted->shadow_rays = 64;
        break;
    }
    hemicube.resolution = settings.resolution.value_or(hemicube.resolution);
    if (settings.eye_points) { // every patch as many as were asked for
        hemicube.eye_points = *settings.eye_points;
        hemicube.near_eye_points = 1;
    }
    if (plan.weighted) {
        plan.weighted->shadow_rays = settings.shadow_rays.value_or(plan.weighted->shadow_rays);
    }
    hemicube.seed = settings.seed.value_or(hemicube.seed);
    hemicube.merge_lattices = settings.merge_lattices;
    return plan;
}

RowPlan plan_clustered_rows(const FactorSettings& settings, std::uint32_t patches) {
    RowPlan plan = plan_rows(settings, patches);
    if (!settings.eye_points && settings.preset == Preset::standard) {
        plan.hemicube.eye_points = eye_points_for(standard_hemicubes, patches, 1, 16);
    }
    plan.hemicube.joint = true;
    if (plan.weighted) {
        plan.weighted->shadow_rays = 0;
    }
    return plan;
}

BaselineSettings plan_baseline(const FactorSettings& settings) {
    if (settings.method == Method::hemicube) {
        throw InvalidArgument("hemicube is no baseline method", {"method"});
    }
    BaselineSettings baseline;
    baseline.method = settings.method;
    baseline.rays = settings.rays.value_or(baseline.rays);
    baseline.resolution = settings.resolution.value_or(baseline.resolution);
    baseline.seed = settings.seed.value_or(baseline.seed);
    return baseline;
}

Provenance provenance_of(const FactorSettings& settings, std::uint32_t patches) {
    Provenance provenance;
    provenance.method = settings.method;
    if (settings.method != Method::hemicube) {
        const BaselineSettings baseline = plan_baseline(settings);
        provenance.preset.reset();
        provenance.resolution = settings.method == Method::hemisphere ? baseline.resolution : 0;
        provenance.seed = baseline.seed;
        return provenance;
    }
    const RowPlan plan = plan_rows(settings, patches);
    provenance.preset = settings.preset;
    provenance.resolution = plan.hemicube.resolution;
    provenance.eye_points = plan.hemicube.eye_points;
    provenance.near_eye_points = plan.hemicube.near_eye_points;
    provenance.seed = plan.hemicube.seed;
    if (plan.weighted) {
        provenance.shadow_rays = plan.weighted->shadow_rays;
        provenance.exchange_rule = plan.weighted->rule;
    }
    return provenance;
}

std::uint64_t memory_limit(const FactorSettings& settings) {
    return settings.max_memory ? *settings.max_memory : available_memory() / 10 * 8;
}

std::unique_ptr<RowProvider> make_row_provider(const PatchMesh& mesh, const FactorSettings& settings) {
    return divided(settings.method == Method::hemicube
                       ? make_hemicube_engine(mesh, plan_rows(settings, mesh.size()).hemicube,
                                              with_workers(settings.engine))
                       : make_baseline(mesh, plan_baseline(settings)));
}

std::unique_ptr<VisibilityProvider> make_visibility_provider(const PatchMesh& mesh,
                                                             const HemicubeSettings& hemicube,
                                                             const FactorSettings& settings) {
    return divided(make_visibility_engine(mesh, hemicube, with_workers(settings.engine)));
}

std::unique_ptr<VisibilityProvider> make_point_visibility_provider(const PatchMesh& mesh,
                                                                   std::span<const SurfacePoint> points,
                                                                   const HemicubeSettings& hemicube,
                                                                   const FactorSettings& settings,
                                                                   DirectionMeasure measure) {
    return make_point_visibility_engine(mesh, points, hemicube, with_workers(settings.engine), measure);
}

} // namespace hemi
