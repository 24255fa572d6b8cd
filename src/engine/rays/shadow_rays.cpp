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

/// Rays so far, and the share of their weights that nothing hides.
class ShadowRays::Sum {
public:
    explicit Sum(const ShadowRays& rays) {
        rtcInitIntersectContext(&packet_.context);
        packet_.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        packet_.context.filter = Packet::filter;
        packet_.rays = &rays;
    }
    /// @param area  what the two ends stand for, up to a factor that all rays have
    void add(const Vec3& a, const Vec3& normal_a, const Vec3& b, const Vec3& normal_b, double area) {
        const Vec3 way = b - a;
        const double leaving = glm::dot(way, normal_a);
        const double arriving = -glm::dot(way, normal_b);
        if (leaving <= 0.0 || arriving <= 0.0) {
            return;
        }
        const double squared = glm::dot(way, way);
        add(a, b, area * leaving * arriving / (squared * squared));
    }
    void add(const Vec3& a, const Vec3& b, double weight) {
        all_ += weight;
        squares_ += weight * weight;
        packet_.from[packet_.count] = a;
        packet_.to[packet_.count] = b;
        packet_.weight[packet_.count] = weight;
        if (++packet_.count == Packet::size) {
            seen_ += packet_.trace();
        }
    }
    [[nodiscard]] Estimate finish() {
        if (packet_.count > 0) {
            seen_ += packet_.trace();
        }
        return all_ > 0.0 ? Estimate{seen_ / all_, all_ * all_ / squares_} : Estimate{1.0, 0.0};
    }

private:
    Packet packet_;
    double seen_ = 0.0;
    double all_ = 0.0;
    double squares_ = 0.0;
};

namespace {

/// Sobol points in [-1, 1]^4, with shifts of their own for every key.
class EvenPoints {
public:
    explicit EvenPoints(std::uint64_t key) {
        std::uint64_t state = splitmix(key);
        for (std::uint32_t& bits : shift_) {
            state = splitmix(state);
            bits = static_cast<std::uint32_t>(state >> 32);
        }
    }
    [[nodiscard]] std::array<double, 4> operator[](std::uint32_t index) const {
        const auto bits = sobol_point(index);
        std::array<double, 4> even{};
        for (std::size_t d = 0; d < even.size(); ++d) {
            even[d] = (static_cast<double>(bits[d] ^ shift_[d]) + 0.5) * 0x1p-31 - 1.0;
        }
        return even;
    }

private:
    std::array<std::uint32_t, 4> shift_{};
};

} // namespace

ShadowRays::Estimate ShadowRays::visibility(std::uint32_t i, std::uint32_t j, std::uint32_t rays) const {
    if (i > j) {
        std::swap(i, j);
    }
    const Vec3 normal_i = mesh_.normal(i);
    const Vec3 normal_j = mesh_.normal(j);
    const PatchCorners corners_i = mesh_.corners(i);
    const PatchCorners corners_j = mesh_.corners(j);
    const BilinearMap from(corners_i.polygon(), normal_i);
    const BilinearMap to(corners_j.polygon(), normal_j);
    const EvenPoints points(std::uint64_t{i} << 32 | j);
    Sum sum(*this);
    for (std::uint32_t ray = 0; ray < rays; ++ray) {
        const auto [s, t, u, v] = points[ray];
        sum.add(from.point(s, t), normal_i, to.point(u, v), normal_j,
                from.jacobian_at(s, t) * to.jacobian_at(u, v));
    }
    return sum.finish();
}

ShadowRays::Estimate ShadowRays::visibility_from(const Vec3& at, const Vec3& normal, std::uint32_t j,
                                                 std::uint32_t rays, std::uint64_t key) const {
    const Vec3 normal_j = mesh_.normal(j);
    const PatchCorners corners = mesh_.corners(j);
    const BilinearMap to(corners.polygon(), normal_j);
    const EvenPoints points(key << 32 | j);
    Sum sum(*this);
    for (std::uint32_t ray = 0; ray < rays; ++ray) {
        const auto even = points[ray];
        sum.add(at, normal, to.point(even[0], even[1]), normal_j, to.jacobian_at(even[0], even[1]));
    }
    return sum.finish();
}

Vec3 ShadowRays::beyond(const Vec3& at, const Vec3& towards) const {
    const Bounds& bounds = mesh_.bounds();
    return at + (glm::length(at - bounds.centre()) + bounds.diagonal()) * towards;
}

double ShadowRays::lit_share(std::uint32_t i, const Vec3& towards, std::uint32_t rays) const {
    const Vec3 normal = mesh_.normal(i);
    if (!(glm::dot(normal, towards) > 0.0)) {
        return 0.0;
    }
    const PatchCorners corners = mesh_.corners(i);
    const BilinearMap from(corners.polygon(), normal);
    const EvenPoints points(i);
    Sum sum(*this);
    for (std::uint32_t ray = 0; ray < rays; ++ray) {
        const auto even = points[ray];
        const Vec3 at = from.point(even[0], even[1]);
        sum.add(at, beyond(at, towards), from.jacobian_at(even[0], even[1]));
    }
    return sum.finish().visibility;
}

bool ShadowRays::is_lit(const Vec3& at, const Vec3& towards) const {
    Sum sum(*this);
    sum.add(at, beyond(at, towards), 1.0);
    return sum.finish().visibility > 0.5;
}

} // namespace hemi
