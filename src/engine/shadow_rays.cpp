#include "engine/shadow_rays.hpp"

#include "core/splitmix.hpp"
#include "engine/convex_polygon.hpp"
#include "engine/sobol.hpp"
#include "hemi/core/error.hpp"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace hemi {

struct ShadowRays::Handles {
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

struct ShadowRays::Query {
    RTCIntersectContext context; ///< first, so that Embree's pointer to it is one to the query
    const ShadowRays* rays;
    const Vec3* from;
    const Vec3* to;

    static void filter(const RTCFilterFunctionNArguments* arguments) {
        const auto* query = reinterpret_cast<const Query*>(arguments->context);
        const std::uint32_t s = RTCHitN_primID(arguments->hit, arguments->N, 0);
        const PatchMesh& mesh = query->rays->mesh_;
        const Vec3& normal = mesh.surface_normal(s);
        const Vec3& corner = mesh.surfaces()[s].vertices[0];
        const double from = glm::dot(*query->from - corner, normal);
        const double to = glm::dot(*query->to - corner, normal);
        const double rounding = query->rays->rounding_;
        if (std::abs(from) <= rounding || std::abs(to) <= rounding || (from > 0.0) == (to > 0.0)) {
            arguments->valid[0] = 0;
        }
    }
};

ShadowRays::ShadowRays(const PatchMesh& mesh)
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
    const auto& surfaces = mesh.surfaces();
    RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_QUAD);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 4 * surfaces.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned), surfaces.size()));
    if (vertices == nullptr || indices == nullptr) {
        rtcReleaseGeometry(geometry);
        throw Error("Embree: no memory for the scene");
    }
    for (std::uint32_t s = 0; s < surfaces.size(); ++s) {
        // A triangle is a quadrilateral whose last two corners are equal.
        const std::uint32_t count = surfaces[s].vertex_count;
        for (std::uint32_t c = 0; c < 4; ++c) {
            const Vec3 corner = (surfaces[s].vertices[std::min(c, count - 1)] - centre_) * scale_;
            for (int axis = 0; axis < 3; ++axis) {
                *vertices++ = static_cast<float>(corner[axis]);
            }
            *indices++ = 4 * s + c;
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

ShadowRays::~ShadowRays() = default;

bool ShadowRays::occluded(const Vec3& from, const Vec3& to) const {
    const Vec3 start = (from - centre_) * scale_;
    const Vec3 way = (to - from) * scale_;
    Query query{};
    rtcInitIntersectContext(&query.context);
    query.context.filter = Query::filter;
    query.rays = this;
    query.from = &from;
    query.to = &to;
    RTCRay ray{};
    ray.org_x = static_cast<float>(start.x);
    ray.org_y = static_cast<float>(start.y);
    ray.org_z = static_cast<float>(start.z);
    ray.dir_x = static_cast<float>(way.x);
    ray.dir_y = static_cast<float>(way.y);
    ray.dir_z = static_cast<float>(way.z);
    ray.tfar = 1.0F;
    ray.mask = 0xFFFFFFFFu;
    rtcOccluded1(handles_->scene, &query.context, &ray);
    return ray.tfar < 0.0F;
}

ShadowRays::Estimate ShadowRays::visibility(std::uint32_t i, std::uint32_t j, std::uint32_t rays) const {
    if (i > j) {
        std::swap(i, j);
    }
    const Vec3& normal_i = mesh_.normal(i);
    const Vec3& normal_j = mesh_.normal(j);
    const PatchCorners corners_i = mesh_.corners(i);
    const PatchCorners corners_j = mesh_.corners(j);
    const BilinearMap from(corners_i.polygon(), normal_i);
    const BilinearMap to(corners_j.polygon(), normal_j);
    // Every pair has shifts of its own.
    std::array<std::uint32_t, 4> shift{};
    std::uint64_t state = splitmix(std::uint64_t{i} << 32 | j);
    for (std::uint32_t& bits : shift) {
        state = splitmix(state);
        bits = static_cast<std::uint32_t>(state >> 32);
    }
    double seen = 0.0;
    double all = 0.0;
    double squares = 0.0;
    for (std::uint32_t ray = 0; ray < rays; ++ray) {
        const auto bits = sobol_point(ray);
        std::array<double, 4> even{};
        for (std::size_t d = 0; d < even.size(); ++d) {
            even[d] = (static_cast<double>(bits[d] ^ shift[d]) + 0.5) * 0x1p-31 - 1.0;
        }
        const Vec3 a = from.point(even[0], even[1]);
        const Vec3 b = to.point(even[2], even[3]);
        const Vec3 way = b - a;
        const double leaving = glm::dot(way, normal_i);
        const double arriving = -glm::dot(way, normal_j);
        if (leaving <= 0.0 || arriving <= 0.0) {
            continue;
        }
        const double squared = glm::dot(way, way);
        const double weight = from.jacobian_at(even[0], even[1]) * to.jacobian_at(even[2], even[3]) *
                              leaving * arriving / (squared * squared);
        all += weight;
        squares += weight * weight;
        seen += occluded(a, b) ? 0.0 : weight;
    }
    return all > 0.0 ? Estimate{seen / all, all * all / squares} : Estimate{1.0, 0.0};
}

} // namespace hemi
