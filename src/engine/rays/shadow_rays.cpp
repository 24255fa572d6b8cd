#include "engine/rays/shadow_rays.hpp"

#include "core/splitmix.hpp"
#include "engine/analytic/convex_polygon.hpp"
#include "engine/rays/embree_scene.hpp"
#include "engine/rays/sobol.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

/// Rays of one pair of patches, traced side by side: they pass through much the same part of the scene.
struct ShadowRays::Packet {
    static constexpr std::uint32_t size = 16;

    RTCIntersectContext context; ///< first, so that Embree's pointer to it is one to the packet
    const ShadowRays* rays;
    std::uint32_t count = 0;
    std::array<Vec3, size> from, to;
    std::array<double, size> weight;

    /// Surfaces in whose plane either end lies, or that both ends are on the same side of, hide nothing.
    static void filter(const RTCFilterFunctionNArguments* arguments) {
        const auto* packet = reinterpret_cast<const Packet*>(arguments->context);
        const PatchMesh& mesh = packet->rays->mesh_;
        const double rounding = packet->rays->rounding_;
        for (unsigned k = 0; k < arguments->N; ++k) {
            if (arguments->valid[k] == 0) {
                continue;
            }
            const std::uint32_t s = RTCHitN_primID(arguments->hit, arguments->N, k);
            const std::uint32_t ray = RTCRayN_id(arguments->ray, arguments->N, k);
            const Vec3& normal = mesh.surface_normal(s);
            const Vec3& corner = mesh.surfaces()[s].vertices[0];
            const double from = glm::dot(packet->from[ray] - corner, normal);
            const double to = glm::dot(packet->to[ray] - corner, normal);
            if (std::abs(from) <= rounding || std::abs(to) <= rounding || (from > 0.0) == (to > 0.0)) {
                arguments->valid[k] = 0;
            }
        }
    }

    /// Weights of the rays that nothing hides; the packet is empty afterwards.
    double trace() {
        const EmbreeScene& scene = *rays->scene_;
        alignas(64) std::array<int, size> valid{};
        alignas(64) RTCRay16 all{};
        for (std::uint32_t k = 0; k < count; ++k) {
            const RTCRay ray = scene.ray(from[k], (to[k] - from[k]) * scene.scale(), 1.0F);
            valid[k] = -1;
            all.org_x[k] = ray.org_x;
            all.org_y[k] = ray.org_y;
            all.org_z[k] = ray.org_z;
            all.dir_x[k] = ray.dir_x;
            all.dir_y[k] = ray.dir_y;
            all.dir_z[k] = ray.dir_z;
            all.tfar[k] = ray.tfar;
            all.mask[k] = ray.mask;
            all.id[k] = k;
        }
        rtcOccluded16(valid.data(), scene.handle(), &context, &all);
        double seen = 0.0;
        for (std::uint32_t k = 0; k < count; ++k) {
            seen += all.tfar[k] < 0.0F ? 0.0 : weight[k];
        }
        count = 0;
        return seen;
    }
};

ShadowRays::ShadowRays(const PatchMesh& mesh) : mesh_(mesh), rounding_(mesh.rounding()) {
    std::vector<EmbreeScene::Quad> quads;
    for (const Surface& surface : mesh.surfaces()) {
        quads.push_back(EmbreeScene::quad(std::span(surface.vertices).first(surface.vertex_count)));
    }
    scene_ = std::make_unique<EmbreeScene>(
        mesh.bounds(), quads,
        static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
}

ShadowRays::~ShadowRays() = default;

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
    Packet packet;
    rtcInitIntersectContext(&packet.context);
    packet.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    packet.context.filter = Packet::filter;
    packet.rays = this;
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
        packet.from[packet.count] = a;
        packet.to[packet.count] = b;
        packet.weight[packet.count] = weight;
        if (++packet.count == Packet::size) {
            seen += packet.trace();
        }
    }
    if (packet.count > 0) {
        seen += packet.trace();
    }
    return all > 0.0 ? Estimate{seen / all, all * all / squares} : Estimate{1.0, 0.0};
}

} // namespace hemi
