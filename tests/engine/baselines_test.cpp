#include "hemi/engine/baselines.hpp"

#include "hemi/core/error.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/engine/touching_faces.hpp"
#include "support/accuracy_row.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

constexpr std::array all_methods{Method::direct, Method::contour, Method::montecarlo, Method::hemisphere};
constexpr std::array unoccluded_methods{Method::direct, Method::contour};

BaselineSettings settings_of(Method method) {
    BaselineSettings settings;
    settings.method = method;
    return settings;
}

FormFactorMatrix matrix_of(const PatchMesh& mesh, const BaselineSettings& settings) {
    return compute_matrix(*make_baseline(mesh, settings));
}

PatchMesh cut(const Scene& scene, std::uint32_t patches_per_face) {
    Subdivision subdivision;
    subdivision.patches_per_face = patches_per_face;
    return PatchMesh(scene, subdivision);
}

/// Largest error over the pairs of a case.
double worst_error(const ExactCase& exact, const PatchMesh& mesh, const BaselineSettings& settings) {
    const GroupTable table = by_group(mesh, matrix_of(mesh, settings));
    double worst = 0.0;
    for (const ExactCase::Pair& pair : exact.pairs) {
        worst = std::max(worst, std::abs(table.factor(pair.from, pair.to) - pair.factor));
    }
    return worst;
}

void check_unoccluded_methods(const ExactCase& exact, const PatchMesh& mesh) {
    for (const Method method : unoccluded_methods) {
        AccuracyRow("other limits", "baseline method `" + std::string(to_word(method)) +
                                        "`, unoccluded cases of `tests/data/cases`")
            .check_below("limit", "", worst_error(exact, mesh, settings_of(method)), 1e-6);
    }
}

bool occluded(const std::string& name) {
    return name == "concentric_spheres" || name == "occluded_corner";
}

/// Closed cylinder of radius 1 and height 1 of `sides` flat sides, faces inward: bottom, top, wall.
Scene cylinder(int sides) {
    Scene scene = empty_scene();
    const Vec3 up(0, 0, 1);
    const auto rim = [sides](int k) {
        const double angle = 2.0 * std::numbers::pi * k / sides;
        return Vec3(std::cos(angle), std::sin(angle), 0.0);
    };
    for (int k = 0; k < sides; ++k) {
        const Vec3 a = rim(k);
        const Vec3 b = rim(k + 1);
        add_polygon(scene, "bottom", {Vec3(0.0), a, b});
        add_polygon(scene, "top", {up, b + up, a + up});
        add_polygon(scene, "wall", {a, a + up, b + up, b});
    }
    return scene;
}

double rms_difference(const FormFactorMatrix& a, const FormFactorMatrix& b) {
    double sum = 0.0;
    for (std::uint32_t i = 0; i < a.size(); ++i) {
        std::vector<double> row(a.size());
        const RowView one = a.row(i);
        for (std::size_t k = 0; k < one.columns.size(); ++k) {
            row[one.columns[k]] += static_cast<double>(one.values[k]);
        }
        const RowView other = b.row(i);
        for (std::size_t k = 0; k < other.columns.size(); ++k) {
            row[other.columns[k]] -= static_cast<double>(other.values[k]);
        }
        for (const double difference : row) {
            sum += difference * difference;
        }
    }
    return std::sqrt(sum / a.size() / a.size());
}

} // namespace

TEST_CASE("baseline methods: direct and contour have the exact factors of the catalogue",
          "[engine][accuracy]") {
    for (const ExactCase& exact : exact_cases()) {
        if (occluded(exact.name) || exact.name == "sphere_interior") {
            continue;
        }
        CAPTURE(exact.name);
        check_unoccluded_methods(exact, cut(read_case(exact.file), 1));
    }
}

TEST_CASE("baseline methods: rays have the exact factors of the catalogue, occluded or not", "[engine]") {
    for (const ExactCase& exact : exact_cases()) {
        if (exact.name == "sphere_interior") {
            continue;
        }
        CAPTURE(exact.name);
        BaselineSettings settings = settings_of(Method::montecarlo);
        const PatchMesh mesh = cut(read_case(exact.file), 1);
        settings.rays = mesh.size() > 20 ? 1024 : 65536;
        CHECK(worst_error(exact, mesh, settings) < 2e-3);
    }
}

TEST_CASE("baseline methods: the hemisphere is as good as its one point a patch", "[engine]") {
    for (const ExactCase& exact : exact_cases()) {
        if (exact.name != "unit_cube" && exact.name != "perp_apart" && exact.name != "occluded_corner") {
            continue;
        }
        CAPTURE(exact.name);
        BaselineSettings settings = settings_of(Method::hemisphere);
        settings.resolution = 64;
        CHECK(worst_error(exact, cut(read_case(exact.file), exact.patches_per_face), settings) <
              exact.one_point_limit + 2e-3);
    }
}

TEST_CASE("baseline methods: all methods see a sphere of facets from inside alike",
          "[engine][slow][accuracy]") {
    for (const ExactCase& exact : exact_cases()) {
        if (exact.name != "sphere_interior") {
            continue;
        }
        const PatchMesh mesh = cut(read_case(exact.file), 1);
        check_unoccluded_methods(exact, mesh);
        BaselineSettings settings = settings_of(Method::montecarlo);
        settings.rays = 4096;
        CHECK(worst_error(exact, mesh, settings) < 1e-3);
        settings = settings_of(Method::hemisphere);
        settings.resolution = 64;
        CHECK(worst_error(exact, mesh, settings) < 5e-3);
    }
}

TEST_CASE("baseline methods: a cylinder of facets comes near the round one", "[engine][slow]") {
    // Howell, C-41: equal coaxial discs, radius = height.
    const double ends = 0.381966011250105;
    const PatchMesh mesh(cylinder(32));
    for (const Method method : all_methods) {
        BaselineSettings settings = settings_of(method);
        settings.rays = 4096;
        settings.resolution = 64;
        const GroupTable table = by_group(mesh, matrix_of(mesh, settings));
        const double limit = method == Method::hemisphere ? 3e-2 : 3e-3;
        CHECK(table.factor("bottom", "top") == Approx(ends).margin(limit));
        CHECK(table.factor("bottom", "wall") == Approx(1.0 - ends).margin(limit));
        CHECK(table.factor("wall", "wall") == Approx(ends).margin(limit));
    }
}

TEST_CASE("baseline methods: direct, contour and exchange areas agree pair by pair", "[engine]") {
    const Scene scene = rotated(tapered_box(3));
    const PatchMesh mesh(scene);
    const FormFactorMatrix direct = matrix_of(mesh, settings_of(Method::direct));
    const FormFactorMatrix contour = matrix_of(mesh, settings_of(Method::contour));
    CHECK(rms_difference(direct, contour) < 1e-7);
    const ExchangeAreas areas(mesh, ExchangeRule::exact);
    double worst = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const RowView row = direct.row(i);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            worst = std::max(worst, std::abs(static_cast<double>(row.values[k]) -
                                             areas(i, row.columns[k]) / mesh.areas()[i]));
        }
    }
    CHECK(worst < 1e-6);
}

TEST_CASE("baseline methods: more rays come nearer to the exact factors", "[engine]") {
    Scene cube = empty_scene();
    add_room(cube, {0, 0, 0}, {1, 1, 1}, 2);
    const PatchMesh mesh(cube);
    const FormFactorMatrix exact = matrix_of(mesh, settings_of(Method::direct));
    BaselineSettings settings = settings_of(Method::montecarlo);
    settings.rays = 256;
    const double few = rms_difference(matrix_of(mesh, settings), exact);
    settings.rays = 16384;
    const double many = rms_difference(matrix_of(mesh, settings), exact);
    CHECK(few < 1e-2);
    // Independent rays would gain a factor 8.
    CHECK(many < few / 10.0);
}

TEST_CASE("baseline methods: every row is balanced", "[engine]") {
    const PatchMesh mesh(room_with_blocks(2));
    for (const Method method : {Method::montecarlo, Method::hemisphere}) {
        BaselineSettings settings = settings_of(method);
        settings.rays = 1024;
        settings.resolution = 32;
        FormFactorMatrix factors = matrix_of(mesh, settings);
        CHECK(row_sums(factors).balance_error_max < 1e-6);
        // The standing block's lower side lies on the floor, as with hemicubes.
        mark_touching_faces_buried(factors, find_touching_faces(factors, mesh), Enclosure::closed);
        CHECK(row_sums(factors).environment_max == 0.0);
        CHECK(row_sums(factors).covered > 0);
    }
    for (const Method method : unoccluded_methods) {
        Scene plates = two_plates(true);
        const PatchMesh open(plates);
        const RowSums sums = row_sums(matrix_of(open, settings_of(method)));
        CHECK(sums.balance_error_max < 1e-6);
        CHECK(sums.environment_max > 0.5);
        CHECK(sums.blocked_max == 0.0);
    }
}

TEST_CASE("baseline methods: two-sided sheets receive on the side that is met, others block", "[engine]") {
    for (const bool two_sided : {false, true}) {
        Scene scene = empty_scene();
        add_polygon(scene, "floor", {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
        add_polygon(scene, "sheet", {{-9, -9, 1e-3}, {9, -9, 1e-3}, {9, 9, 1e-3}, {-9, 9, 1e-3}});
        scene.surfaces.back().two_sided = two_sided;
        const PatchMesh mesh(scene);
        for (const Method method : {Method::montecarlo, Method::hemisphere}) {
            const FormFactorMatrix factors = matrix_of(mesh, settings_of(method));
            const RowView row = factors.row(0);
            if (two_sided) {
                REQUIRE(row.columns.size() == 1);
                CHECK(row.columns[0] == 2); // the sheet's back looks down
                CHECK(row.values[0] > 0.99f);
            } else {
                CHECK(row.columns.empty());
                CHECK(row.blocked > 0.99);
            }
        }
    }
}

TEST_CASE("baseline methods: seeds change rays, threads and places do not", "[engine]") {
    Scene cube = empty_scene();
    add_room(cube, {0, 0, 0}, {1, 1, 1}, 2);
    const PatchMesh mesh(cube);
    BaselineSettings settings = settings_of(Method::montecarlo);
    settings.rays = 1000;
    const FormFactorMatrix first = matrix_of(mesh, settings);
    CHECK(rms_difference(first, matrix_of(mesh, settings)) == 0.0);
    settings.seed = 1;
    CHECK(rms_difference(first, matrix_of(mesh, settings)) > 0.0);
    settings.seed = 0;
    const PatchMesh away(moved(scaled(cube, 1e-3), {1e4, 0, -1e4}));
    CHECK(rms_difference(first, matrix_of(away, settings)) < 1e-3);
}

TEST_CASE("baseline methods: rows come in the order in which they are asked for", "[engine]") {
    Scene cube = empty_scene();
    add_room(cube, {0, 0, 0}, {1, 1, 1}, 4);
    const PatchMesh mesh(cube);
    const std::vector<std::uint32_t> wanted{1, 5, 63, 64, 70, 95};
    for (const Method method : all_methods) {
        BaselineSettings settings = settings_of(method);
        settings.rays = 16;
        settings.resolution = 8;
        std::vector<std::uint32_t> got;
        make_baseline(mesh, settings)->rows(wanted, [&](std::uint32_t patch, const RowView&) {
            got.push_back(patch);
        });
        CHECK(got == wanted);
    }
}

TEST_CASE("baseline methods: what they cannot do is refused with a word why", "[engine]") {
    Scene cube = empty_scene();
    add_room(cube, {0, 0, 0}, {1, 1, 1}, 26);
    const PatchMesh large(cube);
    CHECK_THROWS_WITH(make_baseline(large, settings_of(Method::contour)),
                      Catch::Matchers::Contains("4056 patches") && Catch::Matchers::Contains("4000"));
    const PatchMesh small = cut(cube, 1);
    BaselineSettings settings = settings_of(Method::montecarlo);
    settings.rays = 0;
    CHECK_THROWS_AS(make_baseline(small, settings), InvalidArgument);
    settings = settings_of(Method::hemisphere);
    settings.resolution = 0;
    CHECK_THROWS_AS(make_baseline(small, settings), InvalidArgument);
    CHECK_THROWS_AS(point_factors(small, {0.5, 0.5, 0.5}, {0, 0, 2}, false), InvalidArgument);
}

TEST_CASE("point_factors: a point in a closed room sees it whole", "[engine]") {
    Scene room = empty_scene();
    add_room(room, {0, 0, 0}, {1, 1, 1}, 4);
    const PatchMesh mesh(room);
    const Vec3 normal = glm::normalize(Vec3(0.3, -0.5, 0.7));
    for (const bool occlusion : {false, true}) {
        double sum = 0.0;
        for (const double factor : point_factors(mesh, {0.4, 0.3, 0.2}, normal, occlusion)) {
            sum += factor;
        }
        CHECK(sum == Approx(1.0).epsilon(1e-12));
    }
}

TEST_CASE("point_factors: what stands between hides its share", "[engine]") {
    Scene scene = empty_scene();
    add_polygon(scene, "ceiling", {{-1, -1, 2}, {-1, 1, 2}, {1, 1, 2}, {1, -1, 2}});
    // Hides half of the ceiling from the origin.
    add_polygon(scene, "screen", {{0, -3, 1}, {0, 3, 1}, {3, 3, 1}, {3, -3, 1}});
    const PatchMesh mesh(scene);
    const auto open = point_factors(mesh, {0, 0, 0}, {0, 0, 1}, false);
    const auto hidden = point_factors(mesh, {0, 0, 0}, {0, 0, 1}, true);
    CHECK(hidden[0] == Approx(0.5 * open[0]).epsilon(1e-9));
    CHECK(hidden[1] == Approx(open[1]).epsilon(1e-12));
    // An element in the ceiling's plane does not see it.
    CHECK(point_factors(mesh, {0, 0, 2}, {0, 0, 1}, true)[0] == 0.0);
}
