#include "hemi/pipeline/daylight.hpp"

#include "core/gauss_rule.hpp"
#include "engine/analytic/convex_polygon.hpp"
#include "hemi/core/black_body.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/heat.hpp"
#include "hemi/pipeline/light_balance.hpp"
#include "hemi/pipeline/points.hpp"
#include "hemi/pipeline/vertex_gather.hpp"
#include "hemi/scene/sun.hpp"

#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

using namespace hemi;
using namespace hemi::test;
using Catch::Contains;

namespace {

const double wall_share = 3.0 / 14.0 + 4.0 / (7.0 * std::numbers::pi);

FactorSettings settings_here() {
    FactorSettings settings;
    settings.engine.device = cpu_device;
    settings.estimate_error = false;
    return settings;
}

struct Rows {
    PatchMesh mesh;
    FormFactors factors;
};

Rows rows_of(const Scene& scene) {
    PatchMesh mesh(scene);
    FormFactors factors = compute_form_factors(scene, mesh, settings_here());
    return {std::move(mesh), std::move(factors)};
}

std::vector<double> direct(const Scene& scene, const Rows& rows) {
    return direct_irradiance(scene, rows.mesh, rows.factors.matrix);
}

double power(const Rows& rows, const std::vector<double>& irradiance) {
    double sum = 0.0;
    for (std::uint32_t i = 0; i < rows.mesh.size(); ++i) {
        sum += rows.mesh.areas()[i] * irradiance[i];
    }
    return sum;
}

/// A room 4 x 3 x 2.5 without a ceiling.
Scene court(std::uint32_t cells) {
    Scene scene = empty_scene();
    add_room(scene, {0, 0, 0}, {4, 3, 2.5}, cells);
    std::erase_if(scene.surfaces,
                  [&](const Surface& surface) { return scene.groups[surface.group] == "z1"; });
    return scene;
}

/// A room 4 x 3 x 2.5 with a window in its wall x = 0: y from 1 to 2, z from 0.9 to 2.1.
Scene room_with_window() {
    Scene scene = empty_scene();
    const auto x0 = [&](double y0, double z0, double y1, double z1) {
        add_polygon(scene, "x0", {{0, y0, z0}, {0, y1, z0}, {0, y1, z1}, {0, y0, z1}});
    };
    x0(0, 0, 3, 0.9);
    x0(0, 2.1, 3, 2.5);
    x0(0, 0.9, 1, 2.1);
    x0(2, 0.9, 3, 2.1);
    add_polygon(scene, "floor", {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}}, {16, 12});
    add_polygon(scene, "ceiling", {{0, 0, 2.5}, {0, 3, 2.5}, {4, 3, 2.5}, {4, 0, 2.5}});
    add_polygon(scene, "x1", {{4, 0, 0}, {4, 0, 2.5}, {4, 3, 2.5}, {4, 3, 0}});
    add_polygon(scene, "y0", {{0, 0, 0}, {0, 0, 2.5}, {4, 0, 2.5}, {4, 0, 0}});
    add_polygon(scene, "y1", {{0, 3, 0}, {4, 3, 0}, {4, 3, 2.5}, {0, 3, 2.5}});
    return scene;
}

/// Area that two convex polygons on the floor have in common.
double common_area(std::vector<Vec3> a, const std::vector<Vec3>& b) {
    for (std::size_t k = 0; k < b.size() && a.size() >= 3; ++k) {
        const Vec3 edge = b[(k + 1) % b.size()] - b[k];
        const ConvexPolygon rest = clip(a, {b[k], Vec3(-edge.y, edge.x, 0.0)});
        a.assign(rest.points.begin(), rest.points.begin() + static_cast<std::ptrdiff_t>(rest.count));
    }
    return a.size() >= 3 ? glm::length(area_vector(a)) : 0.0;
}

/// The window's light on the floor, counter-clockwise from above.
std::vector<Vec3> sun_spot(const Vec3& towards) {
    std::vector<Vec3> spot;
    for (const Vec3& corner : {Vec3(0, 1, 0.9), Vec3(0, 1, 2.1), Vec3(0, 2, 2.1), Vec3(0, 2, 0.9)}) {
        spot.push_back(corner - (corner.z / towards.z) * towards);
    }
    return spot;
}

/// How far a point of the floor is outside of a polygon, at most along its sides' normals; inside below 0.
double outside(const Vec3& point, const std::vector<Vec3>& polygon) {
    double farthest = -1e9;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec3 edge = glm::normalize(polygon[(k + 1) % polygon.size()] - polygon[k]);
        farthest = std::max(farthest, glm::dot(point - polygon[k], Vec3(edge.y, -edge.x, 0.0)));
    }
    return farthest;
}

} // namespace

TEST_CASE("daylight: walls and roofs that nothing hides get what the sky gives in closed form",
          "[pipeline][sky]") {
    Scene scene = empty_scene();
    add_polygon(scene, "roof", {{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}});
    add_polygon(scene, "wall", {{9, 0, 0}, {9, 1, 0}, {9, 1, 1}, {9, 0, 1}}, {2, 2}); // to +x, below the roof
    scene.sky = Sky{SkyDistribution::overcast, {10000.0}, {0.0}};
    const Rows rows = rows_of(scene);
    std::vector<double> irradiance = direct(scene, rows);
    CHECK(irradiance[0] == Approx(10000.0).epsilon(1e-12));
    CHECK(irradiance[1] == Approx(10000.0 * wall_share).epsilon(1e-12));
    scene.sky->ground = {0.2};
    irradiance = direct(scene, rows);
    CHECK(irradiance[0] == Approx(10000.0).epsilon(1e-12));
    CHECK(irradiance[1] == Approx(10000.0 * (wall_share + 0.1)).epsilon(1e-12));
    scene.sky->distribution = SkyDistribution::uniform;
    CHECK(direct(scene, rows)[1] == Approx(10000.0 * 0.6).epsilon(1e-12));

    Scene soffit = empty_scene();
    add_polygon(soffit, "soffit", {{0, 0, 5}, {0, 1, 5}, {1, 1, 5}, {1, 0, 5}});
    soffit.sky = Sky{SkyDistribution::overcast, {10000.0}, {0.2}};
    CHECK(direct(soffit, rows_of(soffit))[0] == Approx(2000.0).epsilon(1e-12));
}

TEST_CASE("daylight: the sky is about the axis that points upwards", "[pipeline][sky]") {
    Scene upright = empty_scene();
    add_polygon(upright, "roof", {{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}});
    add_polygon(upright, "wall", {{9, 0, 0}, {9, 1, 0}, {9, 1, 1}, {9, 0, 1}});
    add_polygon(upright, "fence", {{11, 0, 0}, {11, 0, 2}, {11, 1, 2}, {11, 1, 0}}); // in front of the wall
    upright.sky = Sky{SkyDistribution::overcast, {10000.0}, {0.2}};
    upright.sun = Sun{sky_direction(120.0, 40.0), {800.0}};
    Scene turned = upright;
    turned.up = UpAxis::y;
    for (Surface& surface : turned.surfaces) {
        for (Vec3& vertex : surface.vertices) {
            vertex = turned_upright(vertex, UpAxis::y);
        }
    }
    turned.sun->direction = sky_direction(120.0, 40.0, 0.0, UpAxis::y);
    const std::vector<double> expected = direct(upright, rows_of(upright));
    const std::vector<double> found = direct(turned, rows_of(turned));
    REQUIRE(expected[0] == Approx(10000.0 + 800.0 * std::sin(40.0 * std::numbers::pi / 180.0)));
    for (std::size_t k = 0; k < expected.size(); ++k) {
        CHECK(found[k] == Approx(expected[k]).epsilon(1e-6));
    }
    turned.up = UpAxis::z; // whatever the file says counts
    CHECK(direct(turned, rows_of(turned))[0] < 0.8 * expected[0]);
    // Points, with the horizon and a person's planes.
    turned.up = UpAxis::y;
    const auto points_of = [](const Scene& scene) {
        const auto place = [&](const Vec3& v) { return turned_upright(v, scene.up); };
        const PatchMesh mesh(scene);
        Radiation radiation;
        radiation.radiosity.assign(mesh.size(), 0.0);
        radiation.environment = {0.0};
        radiation.sky = scene.sky;
        radiation.up = scene.up;
        return compute_point_values(
            mesh,
            std::vector<Receiver>{{place({10, 0.5, 0.5}), place({-1, 0, 0})}, {place({10, 0.5, 0.5}), {}}},
            radiation, Enclosure::open, settings_here(), 30.0);
    };
    const PointValues a = points_of(upright);
    const PointValues b = points_of(turned);
    for (std::size_t k = 0; k < 2; ++k) {
        CHECK(b.irradiance[k] == Approx(a.irradiance[k]).epsilon(2e-3));
        CHECK(b.sky[k] == Approx(a.sky[k]).epsilon(2e-3));
        CHECK(b.below_horizon[k] == Approx(a.below_horizon[k]).epsilon(2e-3));
    }
    for (std::size_t d = 6; d < 12; ++d) {
        CHECK(b.planes_short[d] == Approx(a.planes_short[d]).epsilon(5e-3));
    }
}

TEST_CASE("daylight: a disc's shadow has the penumbra of a circle cut by the edge", "[pipeline][sun]") {
    // A half-plane 2 m above the floor ends at x = 0, under the sun in the zenith: at a distance d from the
    // edge's foot, the edge cuts the disc at u = sin(atan(d / 2)) / sin(radius) of its radius.
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {200, 1});
    add_polygon(scene, "roof", {{0, -50, 2}, {0, 50, 2}, {50, 50, 2}, {50, -50, 2}});
    scene.sun = Sun{{0, 0, 1}, {1000.0}, 4.0};
    const auto share_at = [](double d) { // lit, where x = -d
        const double u =
            std::clamp(std::sin(std::atan(0.5 * d)) / std::sin(2.0 * std::numbers::pi / 180.0), -1.0, 1.0);
        return 1.0 - (std::acos(u) - u * std::sqrt(1.0 - u * u)) / std::numbers::pi;
    };
    const PatchMesh mesh(scene);
    const std::vector<double> irradiance = direct_irradiance(scene, mesh, FormFactorMatrix(mesh.size()));
    std::vector<Receiver> points;
    double worst = 0.0;
    int partly = 0;
    for (std::uint32_t i = 0; i < 200; ++i) {
        const double d = -mesh.centres()[i].x;
        // The mean over a patch of 1 cm, by Simpson's rule.
        const double exact = (share_at(d - 0.005) + 4.0 * share_at(d) + share_at(d + 0.005)) / 6.0;
        worst = std::max(worst, std::abs(irradiance[i] / 1000.0 - exact));
        partly += exact > 0.01 && exact < 0.99 ? 1 : 0;
        points.push_back({mesh.centres()[i], Vec3(0, 0, 1), mesh.surface_of()[i]});
    }
    CHECK(partly > 10); // it is 14 cm wide
    CHECK(worst < 0.01);
    Radiation radiation;
    radiation.radiosity.assign(mesh.size(), 0.0);
    radiation.sun = scene.sun;
    const PointValues values =
        compute_point_values(mesh, points, radiation, Enclosure::open, settings_here());
    worst = 0.0;
    for (std::uint32_t i = 0; i < 200; ++i) {
        worst = std::max(worst, std::abs(values.irradiance[i] / 1000.0 - share_at(-mesh.centres()[i].x)));
    }
    CHECK(worst < 0.003);
    // Nothing in the way: the cosine of the middle, of a disc that has risen, and part of one that is
    // setting.
    Scene open = empty_scene();
    add_polygon(open, "floor", {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
    const auto of_elevation = [&](double degrees) {
        open.sun = Sun{sky_direction(90.0, degrees), {1000.0}, 10.0};
        return direct_irradiance(open, PatchMesh(open), FormFactorMatrix(1))[0] / 1000.0;
    };
    CHECK(of_elevation(30.0) == Approx(0.5).epsilon(2e-3));
    // Half a disc of angular radius r on the horizon: to first order 4 r / (3 pi) times a half.
    CHECK(of_elevation(0.0) ==
          Approx(2.0 * std::sin(5.0 * std::numbers::pi / 180.0) / (3.0 * std::numbers::pi)).epsilon(0.02));
    CHECK(of_elevation(-6.0) == 0.0);
}

TEST_CASE("daylight: the sun's own disc, where nothing hides it, gives what parallel light does",
          "[pipeline][sun]") {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {4, 4});
    add_polygon(scene, "tilted", {{1, -1, 0}, {2, -1, 1}, {2, 1, 1}, {1, 1, 0}}, {4, 4});
    const PatchMesh mesh(scene);
    for (const double elevation : {90.0, 60.0, 20.0}) {
        scene.sun = Sun{sky_direction(270.0, elevation), {1000.0}, 0.0};
        const std::vector<double> parallel = direct_irradiance(scene, mesh, FormFactorMatrix(mesh.size()));
        scene.sun->diameter = 0.53;
        const std::vector<double> disc = direct_irradiance(scene, mesh, FormFactorMatrix(mesh.size()));
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            CHECK(
                parallel[i] ==
                Approx(1000.0 * std::max(glm::dot(mesh.normal(i), scene.sun->direction), 0.0)).margin(1e-9));
            CHECK(disc[i] == Approx(parallel[i]).epsilon(1e-4)); // by rays to the disc
        }
    }
}

TEST_CASE("daylight: patches in the penumbra of a wide disc have the mean of a finer grid",
          "[pipeline][sun]") {
    constexpr std::uint32_t coarse = 6;
    constexpr std::uint32_t times = 8;
    const auto yard = [](std::uint32_t cells) {
        Scene scene = empty_scene();
        add_polygon(scene, "floor", {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}}, {cells, cells});
        add_polygon(scene, "roof", {{2, 2, 1.5}, {2, 4.2, 1.5}, {4.7, 4.2, 1.5}, {4.7, 2, 1.5}});
        scene.sun = Sun{sky_direction(200.0, 50.0), {1000.0}, 30.0};
        return scene;
    };
    const auto of_floor = [&](std::uint32_t cells) {
        const Scene scene = yard(cells);
        const PatchMesh mesh(scene);
        return direct_irradiance(scene, mesh, FormFactorMatrix(mesh.size()));
    };
    const std::vector<double> is = of_floor(coarse);
    const std::vector<double> fine = of_floor(coarse * times);
    int partly = 0;
    for (std::uint32_t row = 0; row < coarse; ++row) {
        for (std::uint32_t column = 0; column < coarse; ++column) {
            double mean = 0.0;
            for (std::uint32_t k = 0; k < times * times; ++k) {
                mean += fine[(row * times + k / times) * coarse * times + column * times + k % times];
            }
            mean /= times * times;
            INFO("row " << row << ", column " << column);
            CHECK(is[row * coarse + column] == Approx(mean).margin(10.0));
            partly += mean > 50.0 && mean < 700.0 ? 1 : 0;
        }
    }
    CHECK(partly > 6);
}

TEST_CASE("daylight: what comes through an opening falls on what is below it", "[pipeline][sky]") {
    Scene scene = court(6);
    const Rows rows = rows_of(scene);
    scene.sky = Sky{SkyDistribution::overcast, {1000.0}, {0.3}};
    CHECK(power(rows, direct(scene, rows)) == Approx(1000.0 * 12.0).epsilon(2e-3));
    scene.sky->distribution = SkyDistribution::uniform;
    CHECK(power(rows, direct(scene, rows)) == Approx(1000.0 * 12.0).epsilon(1e-3));
    scene.sky.reset();
    scene.sun = Sun{sky_direction(200.0, 50.0), {800.0}};
    CHECK(power(rows, direct(scene, rows)) ==
          Approx(800.0 * 12.0 * std::sin(50.0 * std::numbers::pi / 180.0)).epsilon(1e-3));
    // Both together, and each by itself.
    scene.sky = Sky{SkyDistribution::overcast, {1000.0}, {0.0}};
    const DirectIrradiance parts = direct_irradiances(scene, rows.mesh, rows.factors.matrix);
    const std::vector<double> both = direct(scene, rows);
    for (std::size_t k = 0; k < both.size(); ++k) {
        REQUIRE(both[k] == parts.sun[k] + parts.sky[k]);
    }
    scene.sun.reset();
    scene.sky.reset();
    CHECK(direct(scene, rows).empty());
}

TEST_CASE("daylight: the sun's patch on a floor is the window's shadow line, clipped exactly",
          "[pipeline][sun]") {
    Scene scene = room_with_window();
    const Vec3 towards = glm::normalize(Vec3(-1.0, 0.25, 1.1));
    scene.sun = Sun{towards, {1000.0}};
    const PatchMesh mesh(scene);
    const FormFactorMatrix no_rows(mesh.size());
    const std::vector<double> irradiance = direct_irradiance(scene, mesh, no_rows);
    const std::vector<Vec3> spot = sun_spot(towards);
    double all = 0.0;
    double exact_all = 0.0;
    double worst = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (mesh.groups()[mesh.group(i)] != "floor") {
            continue;
        }
        const PatchCorners corners = mesh.corners(i);
        const std::span<const Vec3> polygon = corners.polygon();
        const double exact = common_area({polygon.begin(), polygon.end()}, spot) / mesh.areas()[i];
        const double lit = irradiance[i] / (1000.0 * towards.z);
        worst = std::max(worst, std::abs(lit - exact));
        all += lit * mesh.areas()[i];
        exact_all += exact * mesh.areas()[i];
    }
    REQUIRE(exact_all == Approx(1.0 * 1.2 * 1.0 / 1.1).epsilon(1e-12)); // all of it is on the floor
    CHECK(worst < 0.01);
    CHECK(all == Approx(exact_all).epsilon(1e-3));
    CHECK(irradiance[2] == 0.0); // beside the window, whose back is lit
}

TEST_CASE("daylight: gathered vertices are in the sun or not", "[pipeline][sun]") {
    Scene scene = room_with_window();
    const Vec3 towards = glm::normalize(Vec3(-1.0, 0.25, 1.1));
    scene.sun = Sun{towards, {1000.0}};
    const Rows rows = rows_of(scene);
    Solution solution = solve_radiosity(scene, rows.mesh, rows.factors);
    gather_at_vertices(scene, rows.mesh, settings_here(), Gather::on, solution);
    REQUIRE(solution.vertex_radiosity.size() == std::size_t{rows.mesh.size()} * 4);
    const std::vector<Vec3> spot = sun_spot(towards);
    const double beam = 0.5 * 1000.0 * towards.z; // reflected
    int lit = 0;
    for (std::uint32_t i = 0; i < rows.mesh.size(); ++i) {
        if (rows.mesh.groups()[rows.mesh.group(i)] != "floor") {
            continue;
        }
        const PatchCorners corners = rows.mesh.corners(i);
        for (std::size_t k = 0; k < 4; ++k) {
            const double distance = outside(corners.points[k], spot);
            const auto radiosity = static_cast<double>(solution.vertex_radiosity[std::size_t{i} * 4 + k]);
            if (distance < -0.01) {
                ++lit;
                CHECK(radiosity > beam);
                CHECK(radiosity < 1.3 * beam);
            } else if (distance > 0.01) {
                CHECK(radiosity < 0.3 * beam);
            }
        }
    }
    CHECK(lit > 40);
}

TEST_CASE("daylight: light that comes in is absorbed or goes out again", "[pipeline][sky][sun]") {
    Scene scene = court(4);
    scene.sky = Sky{SkyDistribution::overcast, {300.0}, {0.2}};
    scene.sun = Sun{sky_direction(140.0, 40.0), {700.0}};
    const Rows rows = rows_of(scene);
    SolverSettings solver;
    solver.tolerance = 1e-12;
    const Solution solution = solve_radiosity(scene, rows.mesh, rows.factors, solver);
    REQUIRE(solution.direct == direct(scene, rows));
    PatchValues values = patch_values(scene, rows.mesh);
    values.direct = solution.direct;
    const auto balance = light_balance(rows.factors, values, solution.radiosity);
    REQUIRE(balance);
    CHECK(balance->emitted == 0.0);
    CHECK(balance->incoming == Approx(power(rows, solution.direct)));
    CHECK(std::abs(balance->absorbed + balance->environment + balance->lost) < 1e-7 * balance->incoming);
    // The irradiance has it, and what is reflected is not more than that.
    for (std::uint32_t i = 0; i < rows.mesh.size(); ++i) {
        REQUIRE(solution.irradiance[i] >= solution.direct[i]);
        REQUIRE(solution.radiosity[i] == Approx(0.5 * solution.irradiance[i]).epsilon(1e-9));
    }
    // As if patches radiated what they reflect of it.
    PatchValues radiating = patch_values(scene, rows.mesh);
    for (std::uint32_t i = 0; i < rows.mesh.size(); ++i) {
        radiating.exitance[i] += 0.5 * solution.direct[i];
    }
    const Solution again = solve_radiosity(rows.factors, radiating, solver);
    for (std::uint32_t i = 0; i < rows.mesh.size(); ++i) {
        REQUIRE(again.radiosity[i] == Approx(solution.radiosity[i]).epsilon(1e-9));
        REQUIRE(again.irradiance[i] + solution.direct[i] == Approx(solution.irradiance[i]).epsilon(1e-9));
    }
}

TEST_CASE("heat: the sun's power goes into surfaces and out again", "[pipeline][heat][sun]") {
    Scene scene = court(3);
    scene.thermal = Thermal{};
    scene.thermal->conditions = {{300.0, {}, {}, false}, {{}, 0.0, {}, false}};
    scene.thermal->environment_temperature = 280.0;
    for (Surface& surface : scene.surfaces) {
        surface.heat = scene.groups[surface.group] == "z0" ? 0 : 1; // walls are adiabatic
    }
    scene.sun = Sun{sky_direction(200.0, 50.0), {800.0}};
    scene.sky = Sky{SkyDistribution::uniform, {100.0}, {0.0}};
    const Rows rows = rows_of(scene);
    HeatProblem problem = heat_problem(scene, rows.mesh);
    problem.direct = direct_heat(scene, rows.mesh, rows.factors.matrix, problem.bands);
    const HeatSolution solution = solve_heat(rows.factors, problem);
    CHECK(solution.relative_balance < 1e-7);
    double floor = 0.0;
    for (std::uint32_t i = 0; i < rows.mesh.size(); ++i) {
        if (problem.condition_of[i] == 0) {
            floor += rows.mesh.areas()[i] * solution.net_flux[i];
        } else {
            REQUIRE(std::abs(solution.net_flux[i]) < 1e-6);
            REQUIRE(solution.temperature[i] > 280.0);
        }
    }
    CHECK(floor == Approx(-solution.environment_power).epsilon(1e-9));
    CHECK(floor < -1000.0); // in, most of 8.5 kW
    const std::vector<GroupHeat> groups = group_heat(rows.factors, problem, solution);
    CHECK(groups.back().direct * groups.back().area == Approx(power(rows, problem.direct)));

    // A series has it too.
    HeatSchedule schedule{{"z0"}, {300.0, 310.0}, {}};
    const HeatSeries series = solve_heat_series(rows.factors, problem, schedule);
    CHECK(series.superposed);
    CHECK(series.environment_power[0] == Approx(solution.environment_power).epsilon(1e-8));
    CHECK(series.environment_power[1] < series.environment_power[0]);

    scene.photometric = true;
    CHECK_THROWS_WITH(heat_problem(scene, rows.mesh), Contains("lumens"));
}

TEST_CASE("heat: a plate in the sun gets as hot as its two emissivities let it", "[pipeline][heat][sun]") {
    // J. A. Duffie, W. A. Beckman, "Solar Engineering of Thermal Processes", chapter 4: what a selective
    // surface absorbs of the sun below 3 µm, and emits above it. Alone in space: alpha I = eps sigma T⁴.
    Scene scene = empty_scene();
    add_polygon(scene, "plate", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    scene.channels = {"sun", "infrared"};
    scene.materials[0].reflectance = {1.0 - 0.95, 1.0 - 0.1};
    scene.materials[0].exitance = {0.0, 0.0};
    scene.environment = {0.0, 0.0};
    scene.thermal = Thermal{{3.0}, {{{}, 0.0, {}, false}}, 0.0};
    scene.surfaces[0].heat = 0;
    scene.sun = Sun{{0.0, 0.0, 1.0}, {1000.0, 0.0}};
    const Rows rows = rows_of(scene);
    HeatProblem problem = heat_problem(scene, rows.mesh);
    problem.direct = direct_heat(scene, rows.mesh, rows.factors.matrix, problem.bands);
    REQUIRE(problem.direct == std::vector<double>{1000.0, 0.0});
    const double kelvin = solve_heat(rows.factors, problem).temperature[0];
    const std::vector<double> shares = band_fractions(kelvin, problem.band_limits);
    CHECK((0.95 * shares[0] + 0.1 * shares[1]) * black_body_exitance(kelvin) == Approx(950.0).epsilon(1e-8));
    CHECK(kelvin > 500.0);
    CHECK(kelvin < black_body_temperature(9500.0)); // what it emits below 3 µm cools it, too
    // Grey, by hand.
    scene.channels = {"grey"};
    scene.materials[0].reflectance = {0.2};
    scene.materials[0].exitance = {0.0};
    scene.environment = {0.0};
    scene.thermal->band_limits.clear();
    scene.sun->irradiance = {1000.0};
    HeatProblem grey = heat_problem(scene, rows.mesh);
    grey.direct = direct_heat(scene, rows.mesh, rows.factors.matrix, grey.bands);
    CHECK(solve_heat(rows.factors, grey).temperature[0] ==
          Approx(black_body_temperature(1000.0)).epsilon(1e-10)); // whatever its emissivity
}

TEST_CASE("points: sky and sun fall on planes and spheres", "[pipeline][points][sky]") {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
    add_polygon(scene, "roof", {{-1, -1, 2}, {1, -1, 2}, {1, 1, 2}, {-1, 1, 2}}); // dark, its back is below
    scene.surfaces.back().two_sided = true;
    const PatchMesh mesh(scene);
    Radiation radiation;
    radiation.radiosity.assign(mesh.size(), 0.0);
    radiation.environment = {0.0};
    radiation.sky = Sky{SkyDistribution::overcast, {10000.0}, {0.0}};
    const auto at = [&](std::vector<Receiver> points) {
        return compute_point_values(mesh, points, radiation, Enclosure::open, settings_here());
    };
    PointValues values = at({{{0, 5, 1}, Vec3(0, 1, 0)},
                             {{0, 0, 3}, Vec3(0, 0, 1)},
                             {{0, 0, 3}, {}},
                             {{0, 0, 1}, Vec3(0, 0, 1)}});
    CHECK(values.irradiance[0] == Approx(10000.0 * wall_share).epsilon(1e-6));
    CHECK(values.irradiance[1] == Approx(10000.0).epsilon(1e-6));
    CHECK(values.irradiance[2] == Approx(10000.0 * 3.0 / 7.0).epsilon(1e-4));
    // Below the roof: the sky without a square of half angle 45 degrees, by its solid angle and moments. The
    // factor to a square of edge 2 in distance 1 is 0.554126; of (n·w)² / pi over it there is 0.438686.
    const double factor = 4.0 / std::numbers::pi * std::atan(std::sqrt(0.5)) / std::sqrt(2.0);
    double moment = 0.0; // by Gauss points
    const GaussRule rule = gauss_rule(10);
    for (std::size_t k = 0; k < 10; ++k) {
        for (std::size_t l = 0; l < 10; ++l) {
            const double squared = 1.0 + rule.points[k] * rule.points[k] + rule.points[l] * rule.points[l];
            moment += rule.weights[k] * rule.weights[l] / std::pow(squared, 2.5) / std::numbers::pi;
        }
    }
    const double sky = 3.0 / 7.0 * ((1.0 - factor) + 2.0 * (2.0 / 3.0 - moment));
    CHECK(values.irradiance[3] == Approx(10000.0 * sky).epsilon(1e-3));

    radiation.sky.reset();
    radiation.sun = Sun{{0.0, 0.6, 0.8}, {1000.0}};
    values = at({{{0, 5, 1}, Vec3(0, 1, 0)},
                 {{0, 5, 1}, {}},
                 {{0, 0, 1}, Vec3(0, 0, 1)},
                 {{0, 0, 0}, Vec3(0, 0, 1)},
                 {{0, 1, 0.5}, Vec3(0, 0, 1)}});
    CHECK(values.irradiance[0] == Approx(600.0));
    CHECK(values.irradiance[1] == Approx(250.0));
    CHECK(values.irradiance[2] == 0.0);           // the roof is there
    CHECK(values.irradiance[3] == Approx(800.0)); // 1.5 to the north at the roof's height
    CHECK(values.irradiance[4] == Approx(800.0));
}
