#include "engine/ray_tracer.hpp"

#include "hemi/core/error.hpp"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemi {

struct RayTracer::Handles {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    Handles() = default;
    Handles(const Handles&) = delete;
    Handles& operator=(const Handles&) = delete;
    ~Handles() {
        if (scene != nullptr) {
            rtcReleaseScene(scene);
        }
        if (device != nullptr) {
            rtcReleaseDevice(device);
        }
    }
};

namespace {

/// Depths closer than this, relative and absolute (the scene is about 1), are the same in float.
constexpr float depth_tolerance = 2e-6f;

} // namespace

RayTracer::RayTracer(const PatchMesh& mesh)
    : mesh_(mesh), centre_(mesh.bounds().centre()), scale_(2.0 / mesh.bounds().diagonal()),
      rounding_(mesh.rounding()), handles_(std::make_unique<Handles>()) {
    // One thread: the trees are small, and rays are traced by the caller's threads.
    handles_->device = rtcNewDevice("threads=1");
    if (handles_->device == nullptr) {
        throw Error(
            fmt::format("Embree: no device (error {})", static_cast<int>(rtcGetDeviceError(nullptr))));
    }
    handles_->scene = rtcNewScene(handles_->device);
    rtcSetSceneFlags(handles_->scene, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST |
                                                                 RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));

    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        if (!mesh.is_back(patch)) {
            patch_of_.push_back(patch);
        }
    }
    // A triangle is a quadrilateral whose last two corners are equal.
    RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_QUAD);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 4 * patch_of_.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned), patch_of_.size()));
    if (vertices == nullptr || indices == nullptr) {
        rtcReleaseGeometry(geometry);
        throw Error("Embree: no memory for the scene");
    }
    for (std::uint32_t k = 0; k < patch_of_.size(); ++k) {
        const PatchCorners corners = mesh.corners(patch_of_[k]);
        for (std::uint32_t c = 0; c < 4; ++c) {
            const Vec3 corner = (corners.points[std::min(c, corners.count - 1)] - centre_) * scale_;
            for (int axis = 0; axis < 3; ++axis) {
                *vertices++ = static_cast<float>(corner[axis]);
            }
            *indices++ = 4 * k + c;
        }
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(handles_->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(handles_->scene);
    if (const RTCError error = rtcGetDeviceError(handles_->device); error != RTC_ERROR_NONE) {
        throw Error(fmt::format("Embree: the scene cannot be built (error {})", static_cast<int>(error)));
    }
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
    const Vec3 start = (origin - centre_) * scale_;
    const Vec3 towards = glm::normalize(direction);
    Query query{};
    rtcInitIntersectContext(&query.context);
    query.context.filter = Query::filter;
    query.tracer = this;
    query.origin = &origin;
    RTCRayHit ray{};
    ray.ray.org_x = static_cast<float>(start.x);
    ray.ray.org_y = static_cast<float>(start.y);
    ray.ray.org_z = static_cast<float>(start.z);
    ray.ray.dir_x = static_cast<float>(towards.x);
    ray.ray.dir_y = static_cast<float>(towards.y);
    ray.ray.dir_z = static_cast<float>(towards.z);
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = 0xFFFFFFFFu;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(handles_->scene, &query.context, &ray);
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
        rtcIntersect1(handles_->scene, &query.context, &ray);
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
