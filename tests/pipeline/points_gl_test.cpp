#include "hemi/pipeline/points.hpp"

#include "support/device.hpp"
#include "support/polygon_factors.hpp"
#include "support/scenes.hpp"

#include "hemi/core/black_body.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

FactorSettings settings_here() {
    FactorSettings settings;
    settings.estimate_error = false;
    settings.engine.device = test_device();
    settings.engine.jobs = 2;
    return settings;
}

/// Patches of group g send out values[g].
Radiation by_group(const PatchMesh& mesh, const std::vector<double>& values, double environment = 0.0) {
    Radiation radiation;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        radiation.radiosity.push_back(values.at(mesh.group(i)));
    }
    radiation.environment = {environment};
    return radiation;
}

Radiation all_alike(const PatchMesh& mesh, double value, double environment = 0.0) {
    return by_group(mesh, std::vector<double>(mesh.groups().size(), value), environment);
}

PointValues values_at(const PatchMesh& mesh, const std::vector<Receiver>& points, const Radiation& radiation,
                      Enclosure enclosure = Enclosure::automatic,
                      std::optional<double> facing = std::nullopt) {
    return compute_point_values(mesh, points, radiation, enclosure, settings_here(), facing);
}

/// Depth of the bowl's floor.
double depth(std::uint32_t down) {
    return std::sin(0.5 * std::numbers::pi * (down - 1) / down);
}

/// A bowl of radius 1 about the origin, open above, with a flat floor.
Scene bowl(std::uint32_t around, std::uint32_t down) {
    Scene scene = empty_scene();
    const auto at = [&](std::uint32_t i, std::uint32_t k) {
        const double turn = 2.0 * std::numbers::pi * (i % around) / around;
        const double dip = 0.5 * std::numbers::pi * k / down;
        return Vec3(std::cos(turn) * std::cos(dip), std::sin(turn) * std::cos(dip), -std::sin(dip));
    };
    const Vec3 middle(0.0, 0.0, -depth(down));
    for (std::uint32_t i = 0; i < around; ++i) {
        for (std::uint32_t k = 0; k + 1 < down; ++k) {
            add_polygon(scene, "bowl", {at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)});
        }
        add_polygon(scene, "bowl", {at(i, down - 1), at(i + 1, down - 1), middle});
    }
    return scene;
}

/// Factor of a horizontal element to the bowl's opening: triangles about its middle that look down.
double opening_seen(const Vec3& at, std::uint32_t around) {
    double sum = 0.0;
    for (std::uint32_t i = 0; i < around; ++i) {
        const auto rim = [&](std::uint32_t k) {
            const double turn = 2.0 * std::numbers::pi * k / around;
            return Vec3(std::cos(turn), std::sin(turn), 0.0);
        };
        const std::vector<Vec3> part{Vec3(0.0), rim(i + 1), rim(i)};
        sum += hemi::point_factor(at, Vec3(0, 0, 1), part);
    }
    return sum;
}

} // namespace

TEST_CASE("solid_angle: a cube's face from its middle, octants, and nothing from behind", "[engine]") {
    const std::vector<Vec3> upward{{1, 1, -1}, {-1, 1, -1}, {-1, -1, -1}, {1, -1, -1}};
    const std::vector<Vec3> face(upward.rbegin(), upward.rend()); // looks away
    CHECK(solid_angle(Vec3(0.0), upward) == Approx(4.0 * std::numbers::pi / 6.0).epsilon(1e-12));
    CHECK(solid_angle(Vec3(0.0), face) == 0.0);
    CHECK(solid_angle(Vec3(0.3, 0.2, -1.0), upward) == 0.0);
    const std::vector<Vec3> octant{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
    CHECK(solid_angle(Vec3(0.0), octant) == Approx(0.5 * std::numbers::pi).epsilon(1e-12));
    // A large one from near by: nearly half of all directions, by atan(a b / (d sqrt(a² + b² + d²))).
    const std::vector<Vec3> large{{-50, -40, 0}, {50, -40, 0}, {50, 40, 0}, {-50, 40, 0}};
    const double d = 0.01;
    CHECK(solid_angle(Vec3(0.0, 0.0, d), large) ==
          Approx(4.0 * std::atan(50.0 * 40.0 / (d * std::sqrt(2500.0 + 1600.0 + d * d)))).epsilon(1e-9));
}

TEST_CASE("points: the sky in the middle of a street is cos(atan(2 H / W))", "[pipeline][every-device]") {
    constexpr double width = 2.0;
    constexpr double half = 1000.0;
    for (const double height : {0.5, 1.0, 6.0}) {
        Scene scene = empty_scene();
        add_polygon(scene, "left", {{0, -half, 0}, {0, half, 0}, {0, half, height}, {0, -half, height}});
        add_polygon(scene, "right",
                    {{width, half, 0}, {width, -half, 0}, {width, -half, height}, {width, half, height}});
        add_polygon(scene, "road", {{0, -half, 0}, {width, -half, 0}, {width, half, 0}, {0, half, 0}});
        const PatchMesh mesh(scene);
        const PointValues values = values_at(mesh, {{{0.5 * width, 0.0, 0.0}, Vec3(0, 0, 1), no_surface}},
                                             all_alike(mesh, 0.0, 10.0));
        const double sky = std::cos(std::atan(2.0 * height / width));
        INFO(height);
        CHECK(values.sky[0] == Approx(sky).margin(1e-5));
        CHECK(values.below_horizon[0] == 0.0);
        CHECK(values.irradiance[0] == Approx(10.0 * sky).margin(1e-4));
        CHECK(values.factors[0] == Approx(0.5 * (1.0 - sky)).margin(1e-5));
        CHECK(values.factors[1] == Approx(0.5 * (1.0 - sky)).margin(1e-5));
        CHECK(values.factors[2] == 0.0);
    }
}

TEST_CASE("points: the sky in a bowl is what its opening is seen as", "[pipeline][every-device]") {
    constexpr std::uint32_t around = 24;
    constexpr std::uint32_t down = 6;
    const PatchMesh mesh(bowl(around, down));
    const std::vector<Vec3> places{
        {0, 0, -depth(down)}, {0.1, -0.15, -depth(down)}, {0.3, 0.1, -0.7}, {-0.5, 0.2, -0.2}};
    std::vector<Receiver> points;
    for (const Vec3& place : places) {
        points.push_back({place, Vec3(0, 0, 1), no_surface});
    }
    const PointValues values = values_at(mesh, points, all_alike(mesh, 2.0));
    for (std::size_t k = 0; k < places.size(); ++k) {
        INFO(k);
        const double sky = opening_seen(places[k], around);
        CHECK(values.sky[k] == Approx(sky).margin(1e-4));
        CHECK(values.irradiance[k] == Approx(2.0 * (1.0 - sky)).margin(2e-4));
    }
    // Of a round opening, sin² of half the angle that it is seen under.
    CHECK(values.sky[0] == Approx(1.0 / (1.0 + depth(down) * depth(down))).margin(0.01));
}

TEST_CASE("form factors: patches of a hemispherical bowl see half of the sky", "[pipeline][every-device]") {
    // Of a sphere every part sees any other by that one's share of the sphere, so that a hemisphere's inside
    // sees a half of the sky everywhere. Of facets the area mean is exact by reciprocity: A e = A_opening.
    double before = 1.0;
    for (const std::uint32_t down : {3u, 6u}) {
        const std::uint32_t around = 4 * down;
        const Scene scene = bowl(around, down);
        const PatchMesh mesh(scene);
        const FormFactors factors = compute_form_factors(scene, mesh, settings_here());
        double seen = 0.0;
        double area = 0.0;
        double worst = 0.0;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const double sky = factors.matrix.row(i).environment;
            seen += mesh.areas()[i] * sky;
            area += mesh.areas()[i];
            worst = std::max(worst, std::abs(sky - 0.5));
        }
        INFO(down);
        CHECK(seen == Approx(0.5 * around * std::sin(2.0 * std::numbers::pi / around)).epsilon(1e-5));
        CHECK(std::abs(seen / area - 0.5) < 0.5 * before);
        before = std::abs(seen / area - 0.5);
        CHECK(worst < 0.5 / down);
    }
    CHECK(before < 0.01);
}

TEST_CASE("points: mean radiant temperature in a box, by solid angles", "[pipeline][every-device]") {
    const std::vector<double> kelvin{290.0, 295.0, 300.0, 305.0, 285.0, 330.0};
    std::vector<double> exitance;
    for (const double t : kelvin) {
        exitance.push_back(black_body_exitance(t));
    }
    for (const std::uint32_t cells : {1u, 4u}) {
        Scene scene = empty_scene();
        add_room(scene, Vec3(-1.0), Vec3(1.0), cells);
        const PatchMesh mesh(scene);
        REQUIRE(mesh.groups().size() == 6);
        const std::vector<Vec3> places{Vec3(0.0), Vec3(0.4, -0.7, 0.9)};
        const PointValues values = values_at(mesh, {{places[0], {}, no_surface}, {places[1], {}, no_surface}},
                                             by_group(mesh, exitance));
        double mean = 0.0;
        for (const double t : kelvin) {
            mean += std::pow(t, 4.0) / 6.0;
        }
        CHECK(black_body_temperature(values.surroundings[0]) == Approx(std::pow(mean, 0.25)).margin(1e-4));
        CHECK(values.irradiance[0] == Approx(stefan_boltzmann * mean).epsilon(1e-5));
        // Away from the middle: the walls' solid angles one by one.
        std::vector<double> shares(6, 0.0);
        double elsewhere = 0.0;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const PatchCorners corners = mesh.corners(i);
            const double share = solid_angle(places[1], corners.polygon()) / (4.0 * std::numbers::pi);
            shares[mesh.group(i)] += share;
            elsewhere += share * exitance[mesh.group(i)];
        }
        CHECK(black_body_temperature(values.surroundings[1]) ==
              Approx(black_body_temperature(elsewhere)).margin(1e-4));
        for (std::size_t g = 0; g < 6; ++g) {
            CHECK(values.factors[g] == Approx(1.0 / 6.0).margin(1e-6));
            CHECK(values.factors[6 + g] == Approx(shares[g]).margin(1e-6));
        }
        CHECK(values.sky[1] + values.below_horizon[1] < 1e-4);
    }
}

TEST_CASE("points: a person under a warm ceiling, by six planes", "[pipeline][every-device]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(-1.0), Vec3(1.0), 2);
    const PatchMesh mesh(scene);
    std::vector<double> exitance(6, black_body_exitance(293.15));
    for (std::size_t g = 0; g < 6; ++g) {
        if (mesh.groups()[g] == "z1") {
            exitance[g] = black_body_exitance(313.15);
        }
    }
    // Of a face of the cube from its middle, towards it and across: they make 1 with the other three.
    const std::vector<Vec3> ceiling{{-1, 1, 1}, {1, 1, 1}, {1, -1, 1}, {-1, -1, 1}};
    const double ahead = hemi::point_factor(Vec3(0.0), Vec3(0, 0, 1), ceiling);
    const auto kelvin = [&](double share) {
        return black_body_temperature((1.0 - share) * exitance[0] + share * black_body_exitance(313.15));
    };
    for (const double facing : {0.0, 30.0}) {
        const double across = hemi::point_factor(Vec3(0.0), plane_directions(facing)[4], ceiling);
        CHECK((facing != 0.0 || std::abs(across - 0.25 * (1.0 - ahead)) < 1e-12));
        const double up = kelvin(ahead);
        const double down = kelvin(0.0);
        const double side = kelvin(across);
        const PointValues values = values_at(mesh, {{Vec3(0.0), {}, no_surface}}, by_group(mesh, exitance),
                                             Enclosure::automatic, facing);
        const auto planes = plane_exitances(values, 0);
        for (const bool faces : {false, true}) { // the sides are alike
            CHECK(person_radiant_temperature(planes, Posture::standing, faces) ==
                  Approx((0.08 * (up + down) + 0.58 * 2.0 * side) / 1.32).margin(1e-3));
            CHECK(person_radiant_temperature(planes, Posture::seated, faces) ==
                  Approx((0.18 * (up + down) + 0.52 * 2.0 * side) / 1.40).margin(1e-3));
        }
    }
}

TEST_CASE("points: a person's planes turn with where it faces", "[pipeline]") {
    const auto north = plane_directions(0.0);
    CHECK(north[4].y == 1.0);
    CHECK(north[2].x == 1.0);
    const auto east = plane_directions(90.0);
    CHECK(east[4].x == Approx(1.0));
    CHECK(east[2].y == Approx(-1.0));
    CHECK(east[0].z == 1.0);
    // Warm in front: it counts more than to the side, and without a direction as the mean of both.
    std::array<double, 6> planes{};
    planes.fill(black_body_exitance(290.0));
    planes[4] = black_body_exitance(310.0);
    const double front = person_radiant_temperature(planes, Posture::standing, true);
    CHECK(front == Approx(290.0 + 20.0 * 0.35 / 1.32).epsilon(1e-12));
    CHECK(person_radiant_temperature(planes, Posture::seated, false) ==
          Approx(290.0 + 20.0 * 0.26 / 1.40).epsilon(1e-12));
    planes[0] = std::numeric_limits<double>::quiet_NaN();
    CHECK(std::isnan(person_radiant_temperature(planes, Posture::seated, false)));
}

TEST_CASE("points: spheres and planes know what hides what", "[pipeline][every-device]") {
    // A plate that looks down, and below it a smaller one that hides the half of it at x < 0.
    Scene scene = empty_scene();
    add_polygon(scene, "far", {{-1, 1, 2}, {1, 1, 2}, {1, -1, 2}, {-1, -1, 2}}, {2, 2});
    add_polygon(scene, "near", {{-2, 2, 1}, {0, 2, 1}, {0, -2, 1}, {-2, -2, 1}});
    const PatchMesh mesh(scene);
    const Vec3 at(0.0);
    const PointValues values = values_at(mesh, {{at, {}, no_surface}, {at, Vec3(0, 0, 1), no_surface}},
                                         by_group(mesh, {8.0, 1.0}, 2.0), Enclosure::automatic, 0.0);
    const std::vector<Vec3> seen{{0, 1, 2}, {1, 1, 2}, {1, -1, 2}, {0, -1, 2}};
    const double far = solid_angle(at, seen) / (4.0 * std::numbers::pi);
    const double near = solid_angle(at, mesh.corners(4).polygon()) / (4.0 * std::numbers::pi);
    CHECK(values.factors[0] == Approx(far).margin(1e-4));
    CHECK(values.factors[1] == Approx(near).margin(1e-6));
    CHECK(values.sky[0] == Approx(0.5 - far - near).margin(1e-4));
    CHECK(values.below_horizon[0] == Approx(0.5).margin(1e-6));
    CHECK(values.irradiance[0] == Approx(8.0 * far + near + 2.0 * (1.0 - far - near)).margin(1e-3));
    CHECK(values.surroundings[0] == Approx(values.irradiance[0]).margin(1e-9));
    const double plane = hemi::point_factor(at, Vec3(0, 0, 1), seen);
    CHECK(values.factors[2] == Approx(plane).margin(1e-4));
    CHECK(std::isnan(values.planes[6]));
    CHECK(values.planes[0] ==
          Approx(8.0 * plane + 1.0 * values.factors[3] + 2.0 * values.sky[1]).margin(1e-3));
    CHECK(values_at(mesh, {{at, {}, no_surface}}, by_group(mesh, {8.0, 1.0}, 2.0)).planes.empty());
}

TEST_CASE("points: what a person absorbs of sun and short waves warms it", "[pipeline]") {
    // The sun in the zenith, over a floor that is small and far: 1000 W/m² on the head, 280 K all round.
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{0, 0, -900}, {1, 0, -900}, {1, 1, -900}, {0, 1, -900}});
    const PatchMesh mesh(scene);
    const double around = black_body_exitance(280.0);
    Radiation radiation = all_alike(mesh, around, around);
    radiation.sun = Sun{{0, 0, 1}, {1000.0}};
    const std::vector<Receiver> points{{Vec3(0.5, 0.5, 0.0), {}, no_surface}};
    const PointValues values = values_at(mesh, points, radiation, Enclosure::open, 0.0);
    const double head = black_body_temperature(around + 0.7 / 0.97 * 1000.0);
    CHECK(person_radiant_temperature(plane_exitances(values, 0), Posture::standing, false) ==
          Approx((0.08 * (head + 280.0) + 2.0 * 0.58 * 280.0) / 1.32).epsilon(1e-6));
    CHECK(person_radiant_temperature(plane_exitances(values, 0), Posture::seated, false) ==
          Approx((0.18 * (head + 280.0) + 2.0 * 0.52 * 280.0) / 1.40).epsilon(1e-6));
    // In the dark clothes of a black sphere, and in white ones.
    CHECK(plane_exitances(values, 0, {1.0, 1.0})[0] == Approx(around + 1000.0).epsilon(1e-6));
    CHECK(plane_exitances(values, 0, {0.2, 0.8})[0] == Approx(around + 250.0).epsilon(1e-6));
    CHECK(plane_exitances(values, 0)[1] == Approx(around).epsilon(1e-6));
    CHECK(values.surroundings[0] == Approx(around + 250.0).epsilon(1e-6)); // a black sphere: a quarter
    // From the side, on two planes by the cosines.
    radiation.sun->direction = glm::normalize(Vec3(3.0, 4.0, 0.0));
    const auto side =
        plane_exitances(values_at(mesh, points, radiation, Enclosure::open, 0.0), 0, {1.0, 1.0});
    CHECK(side[2] == Approx(around + 600.0).epsilon(1e-6));
    CHECK(side[4] == Approx(around + 800.0).epsilon(1e-6));
    CHECK(side[0] == Approx(around).epsilon(1e-6));
    // What patches reflect of short waves counts as such where a band tells them.
    Scene room = empty_scene();
    add_room(room, Vec3(-1.0), Vec3(1.0), 1);
    const PatchMesh walls(room);
    Radiation bands;
    bands.channels = 2;
    bands.short_wave = {true, false};
    for (std::uint32_t i = 0; i < walls.size(); ++i) {
        bands.radiosity.insert(bands.radiosity.end(), {100.0, 400.0});
    }
    const auto inside = plane_exitances(
        values_at(walls, {{Vec3(0.0), {}, no_surface}}, bands, Enclosure::closed, 0.0), 0, {0.6, 0.8});
    for (const double plane : inside) {
        CHECK(plane == Approx(400.0 + 75.0).epsilon(1e-6));
    }
    bands.short_wave.pop_back();
    CHECK_THROWS_AS(values_at(walls, {{Vec3(0.0), {}, no_surface}}, bands), InvalidArgument);
}

TEST_CASE("points: the horizon cuts walls and the environment", "[pipeline][every-device]") {
    // A wall that reaches from below the horizon to above it, seen by an element that looks at it.
    Scene scene = empty_scene();
    add_polygon(scene, "wall", {{-3, 2, -1}, {3, 2, -1}, {3, 2, 2}, {-3, 2, 2}});
    const PatchMesh mesh(scene);
    const Vec3 normal(0, 1, 0);
    const PointValues values =
        values_at(mesh, {{Vec3(0.0), normal, no_surface}, {Vec3(0.0), {}, no_surface}}, all_alike(mesh, 1.0));
    const std::vector<Vec3> upper{{-3, 2, 0}, {3, 2, 0}, {3, 2, 2}, {-3, 2, 2}};
    const std::vector<Vec3> lower{{-3, 2, -1}, {3, 2, -1}, {3, 2, 0}, {-3, 2, 0}};
    const std::vector<Vec3> lower_front(lower.begin(), lower.end());
    CHECK(values.sky[0] == Approx(0.5 - hemi::point_factor(Vec3(0.0), normal, upper)).margin(1e-5));
    CHECK(values.below_horizon[0] ==
          Approx(0.5 - hemi::point_factor(Vec3(0.0), normal, lower_front)).margin(1e-5));
    CHECK(values.sky[1] ==
          Approx(0.5 - solid_angle(Vec3(0.0), upper) / (4.0 * std::numbers::pi)).margin(1e-5));
    CHECK(values.below_horizon[1] ==
          Approx(0.5 - solid_angle(Vec3(0.0), lower) / (4.0 * std::numbers::pi)).margin(1e-5));
}

TEST_CASE("points: inside a body nothing comes, and it is told", "[pipeline][every-device]") {
    Scene scene = empty_scene();
    add_block(scene, "block", Vec3(0.0), Vec3(1.0), 2);
    const PatchMesh mesh(scene);
    const PointValues values = values_at(mesh,
                                         {{Vec3(0.5), Vec3(0, 0, 1), no_surface},
                                          {Vec3(0.5), {}, no_surface},
                                          {Vec3(500.0), Vec3(0, 0, 1), no_surface}},
                                         all_alike(mesh, 5.0, 3.0));
    for (const std::size_t k : {0u, 1u}) {
        CHECK(values.blocked[k] == Approx(1.0).margin(1e-3));
        CHECK(values.irradiance[k] < 1e-2);
        CHECK(values.factors[k] == 0.0);
    }
    CHECK(values.sky[2] == 1.0); // far from everything, and looking away
    CHECK(values.irradiance[2] == 3.0);
    CHECK(values.surroundings[2] == 3.0);
}

TEST_CASE("points: in a closed room that is all alike the light is, whatever the point", "[pipeline]") {
    const Scene scene = room_with_blocks(2);
    const PatchMesh mesh(scene);
    std::vector<Receiver> points;
    for (const Vec3& at : {Vec3(0.05, 0.05, 0.05), Vec3(1.1, 0.5, 0.4), Vec3(0.2, 0.9, 0.7)}) {
        points.push_back({at, {}, no_surface});
        points.push_back({at, glm::normalize(Vec3(1.0, 0.3, -0.2)), no_surface});
    }
    Radiation radiation = all_alike(mesh, 4.0);
    const PointValues values = values_at(mesh, points, radiation, Enclosure::closed);
    for (std::size_t k = 0; k < points.size(); ++k) {
        INFO(k);
        CHECK(values.irradiance[k] == Approx(4.0).epsilon(1e-3));
        CHECK(values.surroundings[k] == Approx(4.0).epsilon(1e-9));
    }
    // A patch whose radiosity is not known counts as if it were not there.
    radiation.radiosity[0] = std::numeric_limits<double>::quiet_NaN();
    const PointValues without = values_at(mesh, points, radiation, Enclosure::closed);
    CHECK(without.surroundings[0] == Approx(4.0).epsilon(1e-9));
    CHECK(without.irradiance[0] < values.irradiance[0]);
}

TEST_CASE("points: the middle of a patch gets what the patch's middle does", "[pipeline][every-device]") {
    Scene scene = two_plates(false);
    const PatchMesh mesh(scene);
    const PointValues values =
        values_at(mesh, {{mesh.centres()[0], mesh.normal(0), mesh.surface_of()[0]}}, all_alike(mesh, 1.0));
    const PatchCorners wall = mesh.corners(1);
    CHECK(values.irradiance[0] ==
          Approx(hemi::point_factor(mesh.centres()[0], mesh.normal(0), wall.polygon())).margin(1e-6));
}

TEST_CASE("points: what does not fit is refused, and work can be stopped", "[pipeline]") {
    const PatchMesh mesh(two_plates(false));
    const Radiation radiation = all_alike(mesh, 1.0);
    const Vec3 at(0.5, 0.5, 0.5);
    CHECK_THROWS_AS(values_at(mesh, {{at, Vec3(0, 0, 2), no_surface}}, radiation), InvalidArgument);
    CHECK_THROWS_AS(values_at(mesh, {{at, Vec3(0, 0, 1), 17}}, radiation), InvalidArgument);
    CHECK_THROWS_AS(
        values_at(mesh, {{Vec3(std::numeric_limits<double>::infinity(), 0, 0), {}, no_surface}}, radiation),
        InvalidArgument);
    Radiation short_one = radiation;
    short_one.radiosity.pop_back();
    CHECK_THROWS_AS(values_at(mesh, {{at, {}, no_surface}}, short_one), InvalidArgument);
    CHECK(values_at(mesh, {}, radiation).irradiance.empty());
    class Stop : public Observer {
    public:
        bool progress(Phase phase, std::size_t, std::size_t) override { return phase != Phase::points; }
    } stop;
    const std::vector<Receiver> points{{at, {}, no_surface}};
    CHECK_THROWS_AS(
        compute_point_values(mesh, points, radiation, Enclosure::automatic, settings_here(), 0.0, stop),
        Cancelled);
}

TEST_CASE("point grid: as many points as fit, in the middle, with the faces' normals", "[pipeline]") {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{0, 0, 1}, {3, 0, 1}, {3, 2, 1}});
    add_polygon(scene, "floor", {{0, 0, 1}, {3, 2, 1}, {0, 2, 1}});
    add_polygon(scene, "shelf", {{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}});
    add_polygon(scene, "shelf", {{1, 0, 5}, {2, 0, 5}, {2, 1, 5}, {1, 1, 5}});
    add_polygon(scene, "shelf", {{0, 1, 5}, {1, 1, 5}, {1, 2, 5}, {0, 2, 5}});
    add_polygon(scene, "shelf", {{0, 0, 0}, {0, 0, 4}, {0, 4, 4}, {0, 4, 0}});
    const PatchMesh mesh(scene);
    const PointGrid floor = make_point_grid(mesh, 0, 0.5, 0.8);
    REQUIRE(floor.planes.size() == 1);
    CHECK(floor.planes[0].columns * floor.planes[0].rows == 24);
    REQUIRE(floor.points.size() == 24);
    CHECK(glm::distance(floor.points[0].position, Vec3(0.25, 0.25, 1.8)) < 1e-12);
    CHECK(glm::distance(floor.points[23].position, Vec3(2.75, 1.75, 1.8)) < 1e-12);
    for (const Receiver& point : floor.points) {
        CHECK(glm::distance(*point.normal, Vec3(0, 0, 1)) < 1e-12);
    }
    // Wider than what is left: in the middle.
    const PointGrid wide = make_point_grid(mesh, 0, 1.4, 0.0);
    REQUIRE(wide.points.size() == 2);
    CHECK(glm::distance(wide.points[0].position, Vec3(0.8, 1.0, 1.0)) < 1e-12);
    // An L of three squares, and another plane.
    const PointGrid shelf = make_point_grid(mesh, 1, 0.5, 0.0);
    REQUIRE(shelf.planes.size() == 2);
    CHECK(shelf.planes[0].cell.size() == 12);
    CHECK(shelf.planes[1].cell.size() == 64);
    CHECK(glm::distance(*shelf.points.back().normal, Vec3(1, 0, 0)) > 1.9);
    CHECK_THROWS_AS(make_point_grid(mesh, 0, 0.0, 0.0), InvalidArgument);
    CHECK_THROWS_AS(make_point_grid(mesh, 0, 1e-6, 0.0), InvalidArgument);
}

TEST_CASE("point grid: turned faces have turned grids", "[pipeline]") {
    Scene scene = empty_scene();
    const Vec3 u = glm::normalize(Vec3(2, 1, 0));
    const Vec3 v(-u.y, u.x, 0);
    add_polygon(scene, "floor", {Vec3(0.0), 4.0 * u, 4.0 * u + 2.0 * v});
    add_polygon(scene, "floor", {Vec3(0.0), 4.0 * u + 2.0 * v, 2.0 * v});
    const PointGrid grid = make_point_grid(PatchMesh(scene), 0, 1.0, 0.5);
    REQUIRE(grid.points.size() == 8);
    for (const Receiver& point : grid.points) {
        const double along = glm::dot(point.position, u) + 0.5;
        const double across = glm::dot(point.position, v) + 0.5;
        CHECK(std::abs(along - std::round(along)) < 1e-5);
        CHECK(std::abs(across - std::round(across)) < 1e-5);
        CHECK(point.position.z == Approx(0.5));
    }
}
