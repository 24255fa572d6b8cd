#include "benchmark/embree_rows.hpp"

#include "benchmark/naive_rows.hpp"
#include "engine/rays/embree_scene.hpp"
#include "engine/rays/patch_rays.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace hemi::bench {

namespace {

/// Nothing is met before this, in Embree's coordinates: the patch itself above all.
constexpr float nearest = 2e-4F;
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr int packet = 16;

/// Traces a full packet; `hit` gets primitives, or RTC_INVALID_GEOMETRY_ID.
void trace(const EmbreeScene& scene, RTCRayHit16& rays, bool coherent) {
    alignas(64) static constexpr std::array<int, packet> all{-1, -1, -1, -1, -1, -1, -1, -1,
                                                             -1, -1, -1, -1, -1, -1, -1, -1};
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(all.data(), scene.handle(), &context, &rays);
}

void set_ray(RTCRayHit16& rays, int k, const RTCRay& ray) {
    rays.ray.org_x[k] = ray.org_x;
    rays.ray.org_y[k] = ray.org_y;
    rays.ray.org_z[k] = ray.org_z;
    rays.ray.dir_x[k] = ray.dir_x;
    rays.ray.dir_y[k] = ray.dir_y;
    rays.ray.dir_z[k] = ray.dir_z;
    rays.ray.tnear[k] = nearest;
    rays.ray.tfar[k] = ray.tfar;
    rays.ray.time[k] = 0.0F;
    rays.ray.mask[k] = ray.mask;
    rays.ray.flags[k] = 0;
    rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    rays.hit.primID[k] = RTC_INVALID_GEOMETRY_ID;
}

std::vector<std::uint32_t> first_numbers(std::size_t count) {
    std::vector<std::uint32_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0U);
    return numbers;
}

} // namespace

EmbreeRows::EmbreeRows(const PatchMesh& mesh, const HemicubeSettings& settings, Rays rays)
    : mesh_(mesh), settings_(settings), rays_(rays), eyes_(make_eye_points(mesh, 1)),
      weights_(settings.resolution), identity_(first_numbers(item_first_patch + mesh.size())),
      accumulator_(identity_, mesh.size()) {
    if (settings.resolution % 8 != 0) {
        throw InvalidArgument(
            fmt::format("resolution {}; rays in tiles of 4 x 4 need a multiple of 8", settings.resolution));
    }
    std::vector<EmbreeScene::Quad> quads;
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        if (!mesh.is_back(patch)) {
            patch_of_.push_back(patch);
            quads.push_back(EmbreeScene::quad(mesh.corners(patch).polygon()));
        }
    }
    scene_ = std::make_unique<EmbreeScene>(mesh.bounds(), quads, RTC_SCENE_FLAG_NONE);
    items_.resize(std::size_t{3} * settings.resolution * settings.resolution);
    counts_.resize(identity_.size());
}

EmbreeRows::~EmbreeRows() = default;

std::string EmbreeRows::renderer() const {
    return "Embree " RTC_VERSION_STRING;
}

void EmbreeRows::rows(std::span<const std::uint32_t> patches, const RowSink& sink) {
    for (const std::uint32_t patch : patches) {
        if (rays_ == Rays::texels) {
            trace_texels(patch);
            accumulator_.add(items_.data(), weights_);
            sink(patch, accumulator_.take());
            continue;
        }
        trace_random(patch);
        const double unit = 1.0 / static_cast<double>(items_.size());
        columns_.clear();
        values_.clear();
        for (std::uint32_t other = 0; other < mesh_.size(); ++other) {
            if (const std::uint32_t count = std::exchange(counts_[item_first_patch + other], 0U); count > 0) {
                columns_.push_back(other);
                values_.push_back(static_cast<float>(count * unit));
            }
        }
        sink(patch, {.columns = columns_,
                     .values = values_,
                     .environment = std::exchange(counts_[item_nothing], 0U) * unit,
                     .blocked = std::exchange(counts_[item_blocked], 0U) * unit});
    }
}

std::uint32_t EmbreeRows::item(std::uint32_t primitive, const Vec3& direction) const {
    if (primitive == RTC_INVALID_GEOMETRY_ID) {
        return item_nothing;
    }
    const std::uint32_t patch = patch_of_[primitive];
    return glm::dot(direction, mesh_.normal(patch)) < 0.0 ? item_first_patch + patch
                                                          : item_of_back(mesh_, patch);
}

void EmbreeRows::trace_texels(std::uint32_t patch) {
    const EyePoint& eye = eyes_.of(patch)[0];
    const EyeFrame frame(eye.normal, patch, 0, settings_.seed);
    const std::uint32_t resolution = settings_.resolution;
    RTCRayHit16 rays;
    std::array<Vec3, packet> directions;
    std::uint32_t first_row = 0;
    for (int face = 0; face < hemicube_faces; ++face) {
        const std::uint32_t height = face == 0 ? resolution : resolution / 2;
        for (std::uint32_t y = 0; y < height; y += 4) {
            for (std::uint32_t x = 0; x < resolution; x += 4) {
                for (std::uint32_t k = 0; k < packet; ++k) {
                    const std::uint32_t texel_x = x + k % 4;
                    const std::uint32_t texel_y = y + k / 4;
                    const double right = (texel_x + 0.5) / resolution * 2.0 - 1.0;
                    const double row = (texel_y + 0.5) / resolution * 2.0;
                    const Vec3 v = face_direction(face, right, face == 0 ? row - 1.0 : row);
                    directions[k] = v.x * frame.x + v.y * frame.y + v.z * frame.z;
                    set_ray(rays, static_cast<int>(k), scene_->ray(eye.position, directions[k], infinity));
                }
                trace(*scene_, rays, true);
                for (std::uint32_t k = 0; k < packet; ++k) {
                    const std::size_t texel = std::size_t{first_row + y + k / 4} * resolution + x + k % 4;
                    items_[texel] = item(rays.hit.primID[k], directions[k]);
                }
            }
        }
        first_row += height;
    }
}

void EmbreeRows::trace_random(std::uint32_t patch) {
    const PatchRays sequence(mesh_, patch, settings_.seed);
    RTCRayHit16 rays;
    std::array<Vec3, packet> directions;
    for (std::uint32_t index = 0; index < items_.size();) {
        for (std::uint32_t k = 0; k < packet; ++k) {
            const PatchRays::Ray ray = sequence[index++];
            directions[k] = ray.direction;
            set_ray(rays, static_cast<int>(k), scene_->ray(ray.origin, ray.direction, infinity));
        }
        trace(*scene_, rays, false);
        for (std::uint32_t k = 0; k < packet; ++k) {
            ++counts_[item(rays.hit.primID[k], directions[k])];
        }
    }
}

} // namespace hemi::bench
