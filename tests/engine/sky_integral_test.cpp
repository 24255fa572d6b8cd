#include "engine/analytic/sky_integral.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <vector>

using namespace hemi;

namespace {

const Vec3 up(0.0, 0.0, 1.0);

/// The moments by midpoints of a fine grid on a parallelogram.
SkyMoments by_midpoints(const Vec3& at, const Vec3* normal, const std::vector<Vec3>& polygon) {
    constexpr int cells = 400;
    const Vec3 u = (polygon[1] - polygon[0]) / double(cells);
    const Vec3 v = (polygon[3] - polygon[0]) / double(cells);
    const Vec3 area = glm::cross(u, v);
    SkyMoments moments;
    for (int i = 0; i < cells; ++i) {
        for (int j = 0; j < cells; ++j) {
            const Vec3 way = polygon[0] + (i + 0.5) * u + (j + 0.5) * v - at;
            const double distance = glm::length(way);
            const Vec3 direction = way / distance;
            const double solid_angle = -glm::dot(direction, area) / (distance * distance);
            const double weight =
                normal != nullptr ? glm::dot(direction, *normal) / std::numbers::pi : 0.25 / std::numbers::pi;
            if (direction.z > 0.0 && weight > 0.0 && solid_angle > 0.0) {
                moments += (weight * solid_angle) * SkyMoments{1.0, direction.z};
            }
        }
    }
    return moments;
}

} // namespace

TEST_CASE("moments of the sky behind a polygon are those of a fine grid", "[engine][sky]") {
    const std::vector<Vec3> wall{{-1.0, 2.0, -0.5}, {1.5, 2.0, -0.5}, {1.5, 2.4, 1.5}, {-1.0, 2.4, 1.5}};
    const std::vector<Vec3> roof{{-1.0, -1.0, 1.0}, {-1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}, {1.0, -1.0, 1.0}};
    const Vec3 at(0.1, 0.2, 0.3);
    for (const Vec3& normal : {Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0), glm::normalize(Vec3(1.0, 0.5, 0.3)),
                               glm::normalize(Vec3(0.2, 1.0, -0.8))}) {
        for (const std::vector<Vec3>& polygon : {wall, roof}) {
            const SkyMoments exact = sky_behind(at, normal, polygon, up);
            const SkyMoments grid = by_midpoints(at, &normal, polygon);
            CHECK(exact.share == Approx(grid.share).margin(2e-4));
            CHECK(exact.elevation == Approx(grid.elevation).margin(2e-4));
        }
    }
    for (const std::vector<Vec3>& polygon : {wall, roof}) {
        const SkyMoments exact = sky_behind(at, polygon, up);
        const SkyMoments grid = by_midpoints(at, nullptr, polygon);
        CHECK(exact.share == Approx(grid.share).margin(2e-4));
        CHECK(exact.elevation == Approx(grid.elevation).margin(2e-4));
    }
    CHECK(sky_behind({0.0, 0.0, 3.0}, {0.0, 1.0, 0.0}, wall, up).share == 0.0); // below the horizon
}

TEST_CASE("an overcast sky lights an unobstructed wall by 3/14 + 4/(7 pi)", "[engine][sky]") {
    const auto light = [](const Vec3& normal) {
        return sky_irradiance(SkyDistribution::overcast, open_sky(normal, up));
    };
    CHECK(light({0.0, 0.0, 1.0}) == Approx(1.0).epsilon(1e-14));
    CHECK(light({1.0, 0.0, 0.0}) == Approx(3.0 / 14.0 + 4.0 / (7.0 * std::numbers::pi)).epsilon(1e-14));
    CHECK(light({0.0, 0.0, -1.0}) == Approx(0.0).margin(1e-15));
    CHECK(sky_irradiance(SkyDistribution::uniform, open_sky({0.0, 1.0, 0.0}, up)) == 0.5);
    CHECK(sky_irradiance(SkyDistribution::overcast, open_sky()) == Approx(3.0 / 7.0)); // a small sphere
    // The roof of a large tent hides nearly all of the sky.
    const std::vector<Vec3> roof{{-1e5, -1e5, 1.0}, {-1e5, 1e5, 1.0}, {1e5, 1e5, 1.0}, {1e5, -1e5, 1.0}};
    const SkyMoments hidden = sky_behind({0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, roof, up);
    CHECK(hidden.share == Approx(1.0).epsilon(1e-8));
    CHECK(hidden.elevation == Approx(2.0 / 3.0).epsilon(1e-8));
}

TEST_CASE("moments of the sky turn with the axis that points upwards", "[engine][sky]") {
    const std::vector<Vec3> wall{{-1.0, 2.0, -0.5}, {1.5, 2.0, -0.5}, {1.5, 2.4, 1.5}, {-1.0, 2.4, 1.5}};
    std::vector<Vec3> turned;
    for (const Vec3& corner : wall) {
        turned.push_back(turned_upright(corner, UpAxis::y));
    }
    const Vec3 at(0.1, 0.2, 0.3);
    const Vec3 normal = glm::normalize(Vec3(1.0, 0.5, 0.3));
    const Vec3 y(0.0, 1.0, 0.0);
    REQUIRE(upwards(UpAxis::y) == y);
    const auto same = [](const SkyMoments& a, const SkyMoments& b) {
        CHECK(a.share == Approx(b.share).epsilon(1e-12));
        CHECK(a.elevation == Approx(b.elevation).epsilon(1e-12));
    };
    const Vec3 turned_at = turned_upright(at, UpAxis::y);
    const Vec3 turned_normal = turned_upright(normal, UpAxis::y);
    same(sky_behind(turned_at, turned_normal, turned, y), sky_behind(at, normal, wall, up));
    same(sky_behind(turned_at, turned, y), sky_behind(at, wall, up));
    same(open_sky(turned_normal, y), open_sky(normal, up));
}
