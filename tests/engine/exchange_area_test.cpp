#include "hemi/engine/exchange_area.hpp"

#include "support/accuracy_row.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <ctime>
#include <numbers>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

constexpr double degree = std::numbers::pi / 180.0;

using Interval = std::array<long double, 2>;

/// Sum over the corners of two rectangles with alternating signs, over 2 pi.
template <typename Term>
double corner_sum(const Interval& a, const Interval& b, const Interval& c, const Interval& d, Term term) {
    long double sum = 0.0L;
    for (unsigned i = 0; i < 2; ++i) {
        for (unsigned j = 0; j < 2; ++j) {
            for (unsigned k = 0; k < 2; ++k) {
                for (unsigned l = 0; l < 2; ++l) {
                    const long double value = term(a[i], b[j], c[k], d[l]);
                    sum += (i + j + k + l) % 2 == 0 ? value : -value;
                }
            }
        }
    }
    return static_cast<double>(sum / (2.0L * std::numbers::pi_v<long double>));
}

long double root_times_atan(long double root_squared, long double x) {
    const long double root = std::sqrt(root_squared);
    return root > 0.0L ? x * root * std::atan(x / root) : 0.0L;
}

/// A_1 F_12 of the rectangles x1 by y1 and x2 by y2 in parallel planes at distance z; Howell, C-13.
double parallel_rectangles(const Interval& x1, const Interval& y1, const Interval& x2, const Interval& y2,
                           long double z) {
    return corner_sum(x1, y1, x2, y2, [z](long double xa, long double ya, long double xb, long double yb) {
        const long double x = xa - xb;
        const long double y = ya - yb;
        return root_times_atan(x * x + z * z, y) + root_times_atan(y * y + z * z, x) -
               0.5L * z * z * std::log(x * x + y * y + z * z);
    });
}

/// A_1 F_12 of the rectangle x by y1 in the plane z = 0 and the rectangle z by y2 in the plane x = 0;
/// Howell, C-15.
double perpendicular_rectangles(const Interval& x, const Interval& y1, const Interval& z,
                                const Interval& y2) {
    return corner_sum(x, y1, z, y2, [](long double xa, long double ya, long double zb, long double yb) {
        const long double squared = xa * xa + zb * zb;
        const long double y = ya - yb;
        const long double all = squared + y * y;
        return root_times_atan(squared, y) - (all > 0.0L ? 0.25L * (squared - y * y) * std::log(all) : 0.0L);
    });
}

using Corners = std::vector<Vec3>;

/// A rectangle in the plane z, facing up or down.
Corners level(double x0, double x1, double y0, double y1, double z, bool up) {
    if (up) {
        return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
    }
    return {{x0, y0, z}, {x0, y1, z}, {x1, y1, z}, {x1, y0, z}};
}

/// A rectangle in the plane x = 0, facing +x.
Corners upright(double y0, double y1, double z0, double z1) {
    return {{0, y0, z0}, {0, y1, z0}, {0, y1, z1}, {0, y0, z1}};
}

/// Unit square hinged on the floor's edge x = 0, its front at `angle` to the floor x 0..1, y 0..1.
Corners hinged(double angle) {
    const double x = std::cos(angle);
    const double z = std::sin(angle);
    return {{0, 0, 0}, {0, 1, 0}, {x, 1, z}, {x, 0, z}};
}

const Corners unit_floor = level(0, 1, 0, 1, 0, true);

PatchMesh mesh_of(const std::vector<Corners>& polygons) {
    Scene scene = empty_scene();
    for (const Corners& polygon : polygons) {
        add_polygon(scene, "g", polygon);
    }
    return PatchMesh(scene);
}

double area_of_pair(const Corners& a, const Corners& b, ExchangeRule rule) {
    return ExchangeAreas(mesh_of({a, b}), rule)(0, 1);
}

constexpr std::array both{ExchangeRule::standard, ExchangeRule::exact};
/// Heading of a rule's column.
std::string column(ExchangeRule rule) {
    return rule == ExchangeRule::standard ? "standard rule" : "exact rule";
}
/// Limit of each rule.
double accuracy(ExchangeRule rule, double standard, double exact) {
    return rule == ExchangeRule::standard ? standard : exact;
}

/// A row of the page's table of unoccluded factors.
AccuracyRow unoccluded(const std::string& name) {
    return AccuracyRow("unoccluded factors", name);
}

double relative_error(double found, double expected) {
    return std::abs(found - expected) / expected;
}

/// The exchange area of the unit floor and a rectangle opposite or above it.
void check_at_any_distance(ExchangeRule rule, const Corners& other, double expected) {
    unoccluded("parallel or perpendicular rectangles at any distance, relative")
        .check_below(column(rule), "", relative_error(area_of_pair(unit_floor, other, rule), expected),
                     accuracy(rule, 2e-5, 1e-9));
}

/// A_i F_ij by midpoints in both directions on the parallelogram i, graded towards its edges.
double by_points(const Corners& from, const Corners& to, unsigned count) {
    const Vec3 u = from[1] - from[0];
    const Vec3 v = from[3] - from[0];
    const Vec3 area = glm::cross(u, v);
    double sum = 0.0;
    // x = t³ (10 - 15 t + 6 t²): the integrand and its slopes vanish at both ends, and midpoints converge
    // fast.
    const auto place = [](double t) { return t * t * t * (10.0 + t * (6.0 * t - 15.0)); };
    const auto weight = [](double t) { return 30.0 * t * t * (1.0 - t) * (1.0 - t); };
    for (unsigned j = 0; j < count; ++j) {
        const double t = (j + 0.5) / count;
        for (unsigned i = 0; i < count; ++i) {
            const double s = (i + 0.5) / count;
            sum += weight(s) * weight(t) *
                   point_factor(from[0] + place(s) * u + place(t) * v, glm::normalize(area), to);
        }
    }
    return sum * glm::length(area) / (count * count);
}

/// Largest deviation from 1 of a row sum of a closed scene.
double worst_row(const PatchMesh& mesh, ExchangeRule rule) {
    const ExchangeAreas areas(mesh, rule);
    double worst = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        double sum = 0.0;
        for (std::uint32_t j = 0; j < mesh.size(); ++j) {
            sum += areas(i, j);
        }
        worst = std::max(worst, std::abs(sum / mesh.areas()[i] - 1.0));
    }
    return worst;
}

/// Closed prism of length 1 over the triangle (0, 0), (1, 0), (cos a, sin a)·side, its walls facing inward.
PatchMesh prism(double angle, double side) {
    const std::array<Vec3, 3> corner{Vec3(0, 0, 0), Vec3(1, 0, 0),
                                     side * Vec3(std::cos(angle), std::sin(angle), 0)};
    const Vec3 up(0, 0, 1);
    std::vector<Corners> faces;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& a = corner[k];
        const Vec3& b = corner[(k + 1) % 3];
        faces.push_back({a, a + up, b + up, b});
    }
    faces.push_back({corner[0], corner[1], corner[2]});
    faces.push_back({corner[0] + up, corner[2] + up, corner[1] + up});
    return mesh_of(faces);
}

} // namespace

TEST_CASE("point_factor: a square above an element has Lambert's value", "[engine]") {
    // Howell, B-3: element at distance 1 below the corner of a unit square.
    const double root = std::sqrt(2.0);
    const double expected = std::atan(1.0 / root) / root / std::numbers::pi;
    CHECK(point_factor({0, 0, 0}, {0, 0, 1}, level(0, 1, 0, 1, 1, false)) == Approx(expected).epsilon(1e-14));
    CHECK(point_factor({0, 0, 0}, {0, 0, 1}, level(0, 1, 0, 1, 1, true)) == 0.0);
    CHECK(point_factor({0, 0, 2}, {0, 0, 1}, level(0, 1, 0, 1, 1, true)) == 0.0);
}

TEST_CASE("point_factor: what lies below the horizon does not count", "[engine]") {
    const double whole = point_factor({1, 0, 0}, {0, 0, 1}, upright(-1, 1, 0, 3));
    CHECK(point_factor({1, 0, 0}, {0, 0, 1}, upright(-1, 1, -2, 3)) == Approx(whole).epsilon(1e-14));
    CHECK(point_factor({1, 0, 0}, {0, 0, 1}, upright(-1, 1, -2, -1)) == 0.0);
    CHECK(point_factor({1, 0, 0}, {0, 0, 1}, upright(-1e6, 1e6, -1, 1e6)) == Approx(0.5).epsilon(1e-5));
}

TEST_CASE("ExchangeAreas: parallel squares have Howell's factors at any gap", "[engine][accuracy]") {
    for (const ExchangeRule rule : both) {
        for (const double gap : {1e-4, 1e-3, 0.01, 0.05, 0.1, 0.3, 1.0, 2.0, 4.0, 7.0, 12.0, 20.0}) {
            CAPTURE(gap);
            const double expected = parallel_rectangles({0, 1}, {0, 1}, {0, 1}, {0, 1}, gap);
            check_at_any_distance(rule, level(0, 1, 0, 1, gap, false), expected);
            const double aside = parallel_rectangles({0, 1}, {0, 1}, {0.3, 1.8}, {-0.4, 0.4}, gap);
            check_at_any_distance(rule, level(0.3, 1.8, -0.4, 0.4, gap, false), aside);
        }
    }
}

TEST_CASE("ExchangeAreas: perpendicular squares have Howell's factors, touching or apart",
          "[engine][accuracy]") {
    for (const ExchangeRule rule : both) {
        unoccluded("perpendicular squares with a common edge, relative")
            .check_below(
                column(rule), "",
                relative_error(area_of_pair(unit_floor, upright(0, 1, 0, 1), rule), 0.20004377607540316),
                accuracy(rule, 1e-8, 1e-12));
        for (const double gap : {0.0, 1e-4, 0.01, 0.1, 0.5, 1.0, 3.0, 8.0}) {
            CAPTURE(gap);
            const double above = perpendicular_rectangles({0, 1}, {0, 1}, {gap, gap + 1}, {0, 1});
            check_at_any_distance(rule, upright(0, 1, gap, gap + 1), above);
            const double beside = perpendicular_rectangles({0, 1}, {0, 1}, {0, 0.25}, {1 + gap, 1.5L + gap});
            unoccluded("perpendicular rectangles, one beside the other, relative")
                .check_below(
                    column(rule), "",
                    relative_error(area_of_pair(unit_floor, upright(1 + gap, 1.5 + gap, 0, 0.25), rule),
                                   beside),
                    accuracy(rule, 1e-4, 1e-8));
            const double overlapping = perpendicular_rectangles({0, 1}, {0, 1}, {gap, 2}, {-0.5, 0.25});
            if (gap < 2.0) {
                check_at_any_distance(rule, upright(-0.5, 0.25, gap, 2), overlapping);
            }
        }
    }
}

TEST_CASE("ExchangeAreas: only the part in front of the other's plane counts", "[engine][accuracy]") {
    for (const ExchangeRule rule : both) {
        const double whole = area_of_pair(unit_floor, upright(0, 1, 0, 1), rule);
        CHECK(area_of_pair(unit_floor, upright(0, 1, -1, 1), rule) ==
              Approx(whole).epsilon(accuracy(rule, 1e-8, 1e-12)));
        const double far = area_of_pair(unit_floor, upright(30, 31, 0, 1), rule);
        CHECK(area_of_pair(unit_floor, upright(30, 31, -1, 1), rule) == Approx(far).epsilon(1e-12));
        CHECK(area_of_pair(unit_floor, upright(0, 1, -1, 0), rule) == 0.0);
        CHECK(area_of_pair(unit_floor, level(0, 1, 0, 1, 1, true), rule) == 0.0);
        CHECK(area_of_pair(unit_floor, level(1, 2, 0, 1, 0, true), rule) == 0.0);
        // Both cut: two squares that cross like a tilted T.
        const Corners left{{0.5, 0, -0.5}, {0.5, 1, -0.5}, {0.5, 1, 0.5}, {0.5, 0, 0.5}};
        CHECK(area_of_pair(unit_floor, left, rule) ==
              Approx(perpendicular_rectangles({0, 0.5}, {0, 1}, {0, 0.5}, {0, 1}))
                  .epsilon(accuracy(rule, 1e-8, 1e-12)));
    }
}

TEST_CASE("ExchangeAreas: squares hinged at any angle agree with points on one of them", "[engine]") {
    for (const double angle : {1.0, 20.0, 60.0, 135.0, 170.0, 179.0}) {
        CAPTURE(angle);
        const Corners wall = hinged(angle * degree);
        const double exact = area_of_pair(unit_floor, wall, ExchangeRule::exact);
        CHECK(exact == Approx(by_points(unit_floor, wall, 200)).epsilon(1e-5));
        CHECK(area_of_pair(unit_floor, wall, ExchangeRule::standard) ==
              Approx(exact).margin(1e-8).epsilon(1e-7));
    }
}

TEST_CASE("ExchangeAreas: rows of sharp and of flat closed prisms sum to one", "[engine]") {
    for (const ExchangeRule rule : both) {
        for (const double angle : {0.05, 1.0, 30.0, 90.0, 135.0, 179.0}) {
            CAPTURE(angle);
            CHECK(worst_row(prism(angle * degree, 1.0), rule) < accuracy(rule, 1e-7, 1e-10));
            CHECK(worst_row(prism(angle * degree, 0.3), rule) < accuracy(rule, 1e-7, 1e-10));
        }
    }
}

TEST_CASE("ExchangeAreas: needle triangles add up to the rectangle they are cut from", "[engine]") {
    const Corners strip = level(0, 1000, 0, 1, 0, true);
    const Corners needle{strip[0], strip[1], strip[2]};
    const Corners rest{strip[0], strip[2], strip[3]};
    for (const ExchangeRule rule : both) {
        for (const Corners& other : {level(0, 1000, 0, 1, 0.5, false), level(400, 401, 3, 4, 2, false),
                                     level(0, 1000, 2, 1000, 20, false)}) {
            const double whole = area_of_pair(strip, other, rule);
            const double parts = area_of_pair(needle, other, rule) + area_of_pair(rest, other, rule);
            CHECK(parts == Approx(whole).epsilon(accuracy(rule, 1e-6, 1e-9)));
        }
    }
    const Corners roof = level(0, 1000, 0, 1, 0.5, false);
    for (const ExchangeRule rule : both) {
        CHECK(area_of_pair(strip, roof, rule) ==
              Approx(parallel_rectangles({0, 1000}, {0, 1}, {0, 1000}, {0, 1}, 0.5L))
                  .epsilon(accuracy(rule, 1e-6, 1e-9)));
    }
}

TEST_CASE("ExchangeAreas: a patch cut in pieces exchanges what the whole does", "[engine]") {
    const Corners square = upright(0, 1, 0, 1);
    for (const double distance : {0.2, 1.0, 4.0, 15.0}) {
        const Corners kite{
            {distance, 0.3, 0.9}, {distance, 1.4, 1.8}, {distance, 1.9, 0.4}, {distance, 0.2, 0.1}};
        for (const ExchangeRule rule : both) {
            const double whole = area_of_pair(square, kite, rule);
            const double triangles = area_of_pair(square, {kite[0], kite[1], kite[2]}, rule) +
                                     area_of_pair(square, {kite[0], kite[2], kite[3]}, rule);
            CHECK(whole > 0.0);
            CHECK(triangles == Approx(whole).epsilon(accuracy(rule, 1e-4, 1e-8)));
        }
    }
}

TEST_CASE("ExchangeAreas: turned plates a hair apart exchange what their quarters do", "[engine]") {
    for (const double gap : {1e-6, 1e-4, 1e-2}) {
        Corners roof = level(-0.2, 0.9, -0.3, 0.8, gap, false);
        for (Vec3& corner : roof) {
            corner = {0.8 * corner.x - 0.6 * corner.y, 0.6 * corner.x + 0.8 * corner.y, corner.z};
        }
        Scene scene = empty_scene();
        add_polygon(scene, "floor", unit_floor, {2, 2});
        add_polygon(scene, "roof", roof, {2, 2});
        const PatchMesh quarters(scene);
        for (const ExchangeRule rule : both) {
            const ExchangeAreas areas(quarters, rule);
            double sum = 0.0;
            for (std::uint32_t i = 0; i < 4; ++i) {
                for (std::uint32_t j = 4; j < 8; ++j) {
                    sum += areas(i, j);
                }
            }
            CHECK(area_of_pair(unit_floor, roof, rule) == Approx(sum).epsilon(accuracy(rule, 2e-7, 1e-11)));
        }
    }
}

TEST_CASE("ExchangeAreas: slivers along edges that are a hair apart and a hair off parallel",
          "[engine][accuracy]") {
    const Corners sliver{{0, 0, 0}, {1, 2e-8, 1e-8}, {1.2, 1.2e-7, -1e-8}, {0.2, 1e-7, -2e-8}};
    const Corners wall{{-0.1, -3e-8, 1e-7}, {-0.1, -2e-8, 1}, {1.2, 1e-8, 1}, {1.2, -4e-8, 6e-8}};
    const Vec3 base = 0.7 * wall[0] + 0.3 * wall[3];
    const Vec3 top = 0.7 * wall[1] + 0.3 * wall[2];
    const std::clock_t start = std::clock();
    for (const ExchangeRule rule : both) {
        const double whole = area_of_pair(sliver, wall, rule);
        const double parts = area_of_pair(sliver, {wall[0], wall[1], top, base}, rule) +
                             area_of_pair(sliver, {base, top, wall[2], wall[3]}, rule);
        CHECK(whole == Approx(by_points(sliver, wall, 300)).epsilon(1e-4));
        CHECK(parts == Approx(whole).epsilon(accuracy(rule, 1e-5, 1e-8)));
    }
    CHECK(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC < 1.0); // not in pieces of 1e-7
}

TEST_CASE("ExchangeAreas: unoccluded exact cases are met, whatever their scale", "[engine][accuracy]") {
    for (const ExactCase& exact : exact_cases()) {
        if (exact.name == "concentric_spheres" || exact.name == "occluded_corner") {
            continue;
        }
        CAPTURE(exact.name);
        const PatchMesh mesh(read_case(exact.file));
        for (const ExchangeRule rule : both) {
            const ExchangeAreas areas(mesh, rule);
            for (const ExactCase::Pair& pair : exact.pairs) {
                double from_area = 0.0;
                double sum = 0.0;
                for (std::uint32_t i = 0; i < mesh.size(); ++i) {
                    if (mesh.groups()[mesh.group(i)] != pair.from) {
                        continue;
                    }
                    from_area += mesh.areas()[i];
                    for (std::uint32_t j = 0; j < mesh.size(); ++j) {
                        sum += mesh.groups()[mesh.group(j)] == pair.to ? areas(i, j) : 0.0;
                    }
                }
                const double error = std::abs(sum / from_area - pair.factor);
                const AccuracyRow row = unoccluded("unoccluded cases of `tests/data/cases`");
                row.check_below(column(rule), "absolute", error, accuracy(rule, 2e-7, 1e-11));
                if (pair.factor > 0.0) { // a factor of 3e-7 has digits of its own
                    row.check_below(column(rule), "relative", error / pair.factor,
                                    accuracy(rule, 1e-5, 1e-11));
                }
                if (pair.factor < 0.2) { // those above are off by up to 1.8e-7
                    CHECK(error < accuracy(rule, 1e-7, 1e-11));
                }
            }
        }
    }
}

TEST_CASE("ExchangeAreas: both orders of a pair give the same bits", "[engine]") {
    const PatchMesh mesh(rotated(room_with_blocks(3)));
    for (const ExchangeRule rule : both) {
        const ExchangeAreas areas(mesh, rule);
        bool same = true;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            same = same && areas(i, i) == 0.0;
            for (std::uint32_t j = 0; j < i; ++j) {
                same = same && areas(i, j) == areas(j, i) && areas(i, j) >= 0.0;
            }
        }
        CHECK(same);
    }
}

TEST_CASE("ExchangeAreas: rows of closed convex scenes sum to one", "[engine][accuracy]") {
    Scene cube = empty_scene();
    add_room(cube, {0, 0, 0}, {1, 1, 1}, 8);
    const AccuracyRow cubes = unoccluded("rows of the unit cube sum to 1 within");
    cubes.check_below("standard rule", "", worst_row(PatchMesh(cube), ExchangeRule::standard), 1e-6);
    cubes.check_below("exact rule", "", worst_row(PatchMesh(cube), ExchangeRule::exact), 1e-10);
    cubes.check_below("standard rule", "", worst_row(PatchMesh(rotated(cube)), ExchangeRule::standard), 1e-6);
    const AccuracyRow rooms = unoccluded("rows of a tapered box and of rooms of many faces");
    for (const Scene& scene : {tapered_box(5), lattice_room()}) {
        rooms.check_below("standard rule", "", worst_row(PatchMesh(scene), ExchangeRule::standard), 2e-6);
        rooms.check_below("exact rule", "", worst_row(PatchMesh(scene), ExchangeRule::exact), 1e-8);
    }
    rooms.check_below("exact rule", "", worst_row(PatchMesh(t_junction_room()), ExchangeRule::exact), 1e-8);
}

TEST_CASE("ExchangeAreas: rows of a closed hull of slanted triangles sum to one", "[engine][accuracy]") {
    // An irregular octahedron, faces inward.
    const std::array<Vec3, 6> tip{Vec3(1.1, 0.1, 0.0),  Vec3(-0.9, 0.2, 0.1), Vec3(0.1, 1.3, 0.2),
                                  Vec3(0.0, -0.8, 0.3), Vec3(0.1, 0.1, 0.7),  Vec3(0.2, 0.0, -1.0)};
    Scene scene = empty_scene();
    for (const std::array<std::size_t, 3> face : {std::array<std::size_t, 3>{0, 4, 2},
                                                  {2, 4, 1},
                                                  {1, 4, 3},
                                                  {3, 4, 0},
                                                  {2, 5, 0},
                                                  {1, 5, 2},
                                                  {3, 5, 1},
                                                  {0, 5, 3}}) {
        add_polygon(scene, "hull", {tip[face[0]], tip[face[1]], tip[face[2]]}, {3, 3});
    }
    const AccuracyRow row = unoccluded("rows of a closed hull of slanted triangles");
    row.check_below("standard rule", "", worst_row(PatchMesh(scene), ExchangeRule::standard), 3e-6);
    row.check_below("exact rule", "", worst_row(PatchMesh(scene), ExchangeRule::exact), 1e-9);
}

TEST_CASE("ExchangeAreas: scale and place do not matter", "[engine]") {
    Scene cube = empty_scene();
    add_room(cube, {0, 0, 0}, {1, 1, 1}, 6);
    CHECK(worst_row(PatchMesh(scaled(cube, 1e-6)), ExchangeRule::exact) < 1e-10);
    CHECK(worst_row(PatchMesh(scaled(cube, 1e6)), ExchangeRule::exact) < 1e-10);
    // A millimetre, rounded to 1.5e-11: patches of 1.7e-4 keep 7 digits.
    const PatchMesh small(moved(scaled(cube, 1e-3), {1e5, -1e5, 1e5}));
    CHECK(worst_row(small, ExchangeRule::standard) < 2e-6);
    CHECK(worst_row(small, ExchangeRule::exact) < 2e-6);
    const PatchMesh unit(cube);
    const PatchMesh huge(scaled(cube, 1048576.0));
    const ExchangeAreas areas(unit);
    const ExchangeAreas huge_areas(huge);
    for (std::uint32_t j = 1; j < unit.size(); ++j) {
        CHECK(huge_areas(0, j) == areas(0, j) * 0x1p40);
    }
}
