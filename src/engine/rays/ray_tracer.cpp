#include "engine/rays/ray_tracer.hpp"

#include "engine/rays/embree_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemi {

namespace {

/// Depths closer than this, relative and absolute (the scene is about 1), are the same in float.
constexpr float depth_tolerance = 2e-6f;

} // namespace

RayTracer::RayTracer(const PatchMesh& mesh) : mesh_(mesh), rounding_(mesh.rounding()) {
    std::vector<EmbreeScene::Quad> quads;
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        if (!mesh.is_back(patch)) {
            patch_of_.push_back(patch);
            quads.push_back(EmbreeScene::quad(mesh.corners(patch).polygon()));
        }
    }
    scene_ = std::make_unique<EmbreeScene>(
        mesh.bounds(), quads,
        static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
}

RayTracer::~RayTracer() = default;

/// What a ray may meet.
struct RayTracer::Query {
    RTCIntersectContext context; ///< first, so that Embree's pointer to it is one to the query
    const RayTracer* tracer;
    const Vec3* origin;
    bool fronts_only;

    static void filter(const RTCFilterFunctionNArguments* arguments) {
        const auto* query = reinterpret_cast<const Query*>(arguments->context);
        const std::uint32_t primitive = RTCHitN_primID(arguments->hit, arguments->N, 0);
        const Side side = query->tracer->side(*query->origin, query->tracer->patch_of_[primitive]);
        if (side == Side::nothing || (query->fronts_only && side == Side::back)) {
            arguments->valid[0] = 0;
        }
    }
};

RayTracer::Side RayTracer::side(const Vec3& origin, std::uint32_t patch) const {
    const std::uint32_t s = mesh_.surface_of()[patch];
    const Surface& surface = mesh_.surfaces()[s];
    const double height = glm::dot(origin - surface.vertices[0], mesh_.surface_normal(s));
    if (std::abs(height) <= rounding_) {
        return Side::nothing;
    }
    return height > 0.0 || surface.two_sided ? Side::front : Side::back;
}

RayTracer::Hit RayTracer::trace(const Vec3& origin, const Vec3& direction) const {
    Query query{};
    rtcInitIntersectContext(&query.context);
    query.context.filter = Query::filter;
    query.tracer = this;
    query.origin = &origin;
    RTCRayHit ray{};
    ray.ray = scene_->ray(origin, glm::normalize(direction), std::numeric_limits<float>::infinity());
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_->handle(), &query.context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        return {};
    }
    std::uint32_t patch = patch_of_[ray.hit.primID];
    if (side(origin, patch) == Side::back) {
        // A front at the same depth wins: sheets are often modelled as two faces back to back.
        const float depth = ray.ray.tfar;
        query.fronts_only = true;
        ray.ray.tnear = std::max(0.0f, depth * (1.0f - depth_tolerance) - depth_tolerance);
        ray.ray.tfar = depth * (1.0f + depth_tolerance) + depth_tolerance;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_->handle(), &query.context, &ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
            return {Side::back, patch};
        }
        patch = patch_of_[ray.hit.primID];
    }
    const std::uint32_t s = mesh_.surface_of()[patch];
    const bool behind = glm::dot(origin - mesh_.surfaces()[s].vertices[0], mesh_.surface_normal(s)) < 0.0;
    return {Side::front, behind ? patch + mesh_.patches_per_side(s) : patch};
}

std::string RayTracer::name() {
    return "Embree " RTC_VERSION_STRING;
}

} // namespace hemi
