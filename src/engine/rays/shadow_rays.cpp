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

bool ShadowRays::occluded(const Vec3& from, const Vec3& to) const {
    Query query{};
    rtcInitIntersectContext(&query.context);
    query.context.filter = Query::filter;
    query.rays = this;
    query.from = &from;
    query.to = &to;
    RTCRay ray = scene_->ray(from, (to - from) * scene_->scale(), 1.0F);
    rtcOccluded1(scene_->handle(), &query.context, &ray);
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
