#include "engine/rays/shadow_rays.hpp"

#include "core/splitmix.hpp"
#include "engine/analytic/convex_polygon.hpp"
#include "engine/rays/embree_scene.hpp"
#include "engine/rays/sobol.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
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

ShadowRays::Estimate ShadowRays::visibility_from(const Vec3& at, const std::optional<Vec3>& normal,
                                                 std::uint32_t j, std::uint32_t rays,
                                                 std::uint64_t key) const {
    const Vec3 normal_j = mesh_.normal(j);
    const PatchCorners corners = mesh_.corners(j);
    const BilinearMap to(corners.polygon(), normal_j);
    const EvenPoints points(key << 32 | j);
    Sum sum(*this);
    for (std::uint32_t ray = 0; ray < rays; ++ray) {
        const auto even = points[ray];
        const Vec3 end = to.point(even[0], even[1]);
        const double area = to.jacobian_at(even[0], even[1]);
        if (normal) {
            sum.add(at, *normal, end, normal_j, area);
        } else {
            const Vec3 way = end - at;
            const double length = glm::length(way);
            const double arriving = -glm::dot(way, normal_j);
            if (arriving > 0.0) {
                sum.add(at, end, area * arriving / (length * length * length));
            }
        }
    }
    return sum.finish();
}

namespace {

/// Directions to the disc of a sun.
class SunDisc {
public:
    explicit SunDisc(const Sun& sun)
        : towards_(sun.direction), radius_(std::sin(sun.diameter * std::numbers::pi / 360.0)) {
        const int axis = std::abs(towards_.x) < 0.6 ? 0 : 1;
        Vec3 other(0.0);
        other[axis] = 1.0;
        u_ = glm::normalize(glm::cross(towards_, other));
        v_ = glm::cross(towards_, u_);
    }
    /// Evenly by what an area normal to the beam receives.
    /// @param s  and t: in [-1, 1]
    [[nodiscard]] Vec3 direction(double s, double t) const {
        const double radius = radius_ * std::sqrt(0.5 * (1.0 + s));
        const double angle = std::numbers::pi * t;
        return std::sqrt(1.0 - radius * radius) * towards_ +
               radius * (std::cos(angle) * u_ + std::sin(angle) * v_);
    }
    /// Of an area with this normal, by its like normal to the beam: of light from one direction.
    [[nodiscard]] double cosine(const Vec3& normal, const Vec3& direction) const {
        return std::max(0.0, glm::dot(normal, direction) / glm::dot(towards_, direction));
    }
    /// Whether some of it is in front of a plane.
    [[nodiscard]] bool rises(const Vec3& normal) const { return glm::dot(normal, towards_) > -radius_; }
    [[nodiscard]] bool is_point() const { return radius_ == 0.0; }

private:
    Vec3 towards_;
    double radius_; ///< sine of half the diameter
    Vec3 u_{0.0};
    Vec3 v_{0.0};
};

/// Rays from a point to a disc that are enough where all or none are blocked, and where some are.
constexpr std::uint32_t disc_rays = 512;
constexpr std::uint32_t disc_edge_rays = 4096;

} // namespace

Vec3 ShadowRays::beyond(const Vec3& at, const Vec3& towards) const {
    const Bounds& bounds = mesh_.bounds();
    return at + (glm::length(at - bounds.centre()) + bounds.diagonal()) * towards;
}

ShadowRays::SunShare ShadowRays::sun_by_rays(std::uint32_t i, const Sun& sun, std::uint32_t rays) const {
    const Vec3 normal = mesh_.normal(i);
    const SunDisc disc(sun);
    const PatchCorners corners = mesh_.corners(i);
    const BilinearMap from(corners.polygon(), normal);
    const EvenPoints points(i);
    Sum sum(*this);
    double all = 0.0;
    double unblocked = 0.0;
    for (std::uint32_t ray = 0; ray < rays; ++ray) {
        const auto even = points[ray];
        const Vec3 direction = disc.is_point() ? sun.direction : disc.direction(even[2], even[3]);
        const double area = from.jacobian_at(even[0], even[1]);
        const double weight = area * disc.cosine(normal, direction);
        all += area;
        unblocked += weight;
        if (weight > 0.0) {
            const Vec3 at = from.point(even[0], even[1]);
            sum.add(at, beyond(at, direction), weight);
        }
    }
    const double lit = unblocked > 0.0 ? sum.finish().visibility : 0.0;
    return {lit * unblocked / all, lit};
}

ShadowRays::SunShare ShadowRays::sun_share(std::uint32_t i, const Sun& sun, std::uint32_t rays,
                                           std::uint32_t edge_rays) const {
    if (!SunDisc(sun).rises(mesh_.normal(i))) {
        return {0.0, 0.0};
    }
    const SunShare found = sun_by_rays(i, sun, rays);
    return found.lit > 0.0 && found.lit < 1.0 ? sun_by_rays(i, sun, edge_rays) : found;
}

double ShadowRays::sun_share_at(const Vec3& at, const std::optional<Vec3>& normal, const Sun& sun) const {
    constexpr double cross_section = 0.25;
    const SunDisc disc(sun);
    if (normal && !disc.rises(*normal)) {
        return 0.0;
    }
    const EvenPoints points(0);
    const auto by_rays = [&](std::uint32_t rays) {
        Sum sum(*this);
        double unblocked = 0.0;
        for (std::uint32_t ray = 0; ray < rays; ++ray) {
            const auto even = points[ray];
            const Vec3 direction = disc.is_point() ? sun.direction : disc.direction(even[0], even[1]);
            const double weight = disc.cosine(normal.value_or(direction), direction);
            unblocked += weight / rays;
            if (weight > 0.0) {
                sum.add(at, beyond(at, direction), weight);
            }
        }
        const double lit = unblocked > 0.0 ? sum.finish().visibility : 0.0;
        return SunShare{lit * unblocked * (normal ? 1.0 : cross_section), lit};
    };
    if (disc.is_point()) {
        return by_rays(1).share;
    }
    const SunShare found = by_rays(disc_rays);
    return found.lit > 0.0 && found.lit < 1.0 ? by_rays(disc_edge_rays).share : found.share;
}

} // namespace hemi
