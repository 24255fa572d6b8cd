#include "engine/rays/embree_scene.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi {

EmbreeScene::Quad EmbreeScene::quad(std::span<const Vec3> polygon) {
    Quad corners;
    for (std::size_t c = 0; c < corners.size(); ++c) {
        corners[c] = polygon[std::min(c, polygon.size() - 1)];
    }
    return corners;
}

EmbreeScene::EmbreeScene(const Bounds& bounds, std::span<const Quad> polygons, RTCSceneFlags flags)
    : centre_(bounds.centre()), scale_(2.0 / bounds.diagonal()) {
    // One thread: the trees are small, and rays are traced by the caller's threads. AVX2, so that rays which
    // graze an edge meet the same on processors with more.
    device_ = rtcNewDevice("threads=1,max_isa=avx2");
    if (device_ == nullptr) {
        throw Error(
            fmt::format("Embree: no device (error {})", static_cast<int>(rtcGetDeviceError(nullptr))));
    }
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, flags);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_QUAD);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 4 * polygons.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned), polygons.size()));
    if (vertices != nullptr && indices != nullptr) {
        unsigned next = 0;
        for (const Quad& polygon : polygons) {
            for (const Vec3& corner : polygon) {
                const Vec3 inside = (corner - centre_) * scale_;
                for (int axis = 0; axis < 3; ++axis) {
                    *vertices++ = static_cast<float>(inside[axis]);
                }
                *indices++ = next++;
            }
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcCommitScene(scene_);
    }
    rtcReleaseGeometry(geometry);
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
        if (error == RTC_ERROR_OUT_OF_MEMORY) {
            throw OutOfMemory("Embree: no memory for the scene");
        }
        throw Error(fmt::format("Embree: the scene cannot be built (error {})", static_cast<int>(error)));
    }
}

EmbreeScene::~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

RTCRay EmbreeScene::ray(const Vec3& origin, const Vec3& direction, float far) const {
    const Vec3 start = (origin - centre_) * scale_;
    RTCRay ray{};
    ray.org_x = static_cast<float>(start.x);
    ray.org_y = static_cast<float>(start.y);
    ray.org_z = static_cast<float>(start.z);
    ray.dir_x = static_cast<float>(direction.x);
    ray.dir_y = static_cast<float>(direction.y);
    ray.dir_z = static_cast<float>(direction.z);
    ray.tfar = far;
    ray.mask = 0xFFFFFFFFu;
    return ray;
}

} // namespace hemi
