#include "engine/analytic/sky_integral.hpp"

#include "engine/analytic/convex_polygon.hpp"
#include "hemi/engine/exchange_area.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hemi {

namespace {

constexpr double pi = std::numbers::pi;

/// Integral of (n·w)(u·w) / pi over the directions w to a polygon that lies in front of both planes.
double double_moment(const Vec3& at, const Vec3& normal, std::span<const Vec3> polygon, const Vec3& up) {
    double boundary = 0.0;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec3 a = glm::normalize(polygon[k] - at);
        const Vec3 b = glm::normalize(polygon[(k + 1) % polygon.size()] - at);
        const Vec3 cross = glm::cross(a, b);
        const double sine = glm::length(cross);
        if (!(sine > 0.0)) {
            continue;
        }
        const double cosine = glm::dot(a, b);
        const Vec3 axis = cross / sine;
        const Vec3 along = glm::cross(axis, a);
        // The directions of an arc, summed: a sin + along (1 - cos), without the difference of the latter.
        const Vec3 sum = sine * a + (sine * sine / (1.0 + std::max(cosine, -1.0 + 1e-15))) * along;
        boundary += glm::dot(normal, sum) * glm::dot(up, axis);
    }
    // Seen from the front the corners run clockwise: the arcs' axes point out of the polygon.
    return (glm::dot(normal, up) * solid_angle(at, polygon) - boundary) / (3.0 * pi);
}

} // namespace

SkyMoments open_sky(const Vec3& normal, const Vec3& up) {
    const double cosine = std::clamp(glm::dot(normal, up), -1.0, 1.0);
    const double sine = std::sqrt(1.0 - cosine * cosine);
    return {0.5 * (1.0 + cosine), 2.0 * (cosine * (pi - std::acos(cosine)) + sine) / (3.0 * pi)};
}

SkyMoments open_sky() {
    return {0.5, 0.25};
}

SkyMoments sky_behind(const Vec3& at, const Vec3& normal, std::span<const Vec3> polygon, const Vec3& up) {
    SkyMoments moments;
    const ConvexPolygon above = clip(polygon, {at, up});
    for (std::size_t k = 0; above.count >= 3 && k < above.pieces(); ++k) {
        const ConvexPolygon piece = above.piece(k);
        const double share = point_factor(at, normal, piece.span());
        if (!(share > 0.0)) {
            continue;
        }
        moments.share += share;
        const ConvexPolygon front = clip(piece.span(), {at, normal});
        for (std::size_t l = 0; front.count >= 3 && l < front.pieces(); ++l) {
            const ConvexPolygon part = front.piece(l);
            moments.elevation += std::clamp(double_moment(at, normal, part.span(), up), 0.0, share);
        }
    }
    return moments;
}

SkyMoments sky_behind(const Vec3& at, std::span<const Vec3> polygon, const Vec3& up) {
    SkyMoments moments;
    const ConvexPolygon above = clip(polygon, {at, up});
    for (std::size_t k = 0; above.count >= 3 && k < above.pieces(); ++k) {
        const ConvexPolygon piece = above.piece(k);
        moments += {solid_angle(at, piece.span()) / (4.0 * pi), 0.25 * point_factor(at, up, piece.span())};
    }
    return moments;
}

double sky_irradiance(SkyDistribution distribution, const SkyMoments& moments) {
    return distribution == SkyDistribution::uniform ? moments.share
                                                    : 3.0 / 7.0 * (moments.share + 2.0 * moments.elevation);
}

} // namespace hemi
