#include "support/device.hpp"
#include "support/polygon_factors.hpp"
#include "support/scenes.hpp"

#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/solver/solver.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace hemi;
using namespace hemi::test;

/// Scenes at the limits of size, shape and number, by plain hemicubes. What is left of an error is stated
/// where it is tested; it comes of one eye point a patch and of the texels' size.
namespace {

FormFactorMatrix compute(const PatchMesh& mesh, std::uint32_t resolution) {
    return compute_matrix(
        *make_hemicube_engine(mesh, {.resolution = resolution}, {test_device(), 2, find_worker_program()}));
}

/// Exact factor of one surface to another, unoccluded.
double exact_factor(const Surface& from, const Surface& to) {
    return exchange_area(from.polygon(), to.polygon()) / glm::length(area_vector(from.polygon()));
}

/// Largest difference between factors by group of two scenes with equal groups.
double largest_difference(const PatchMesh& one, const PatchMesh& other, std::uint32_t resolution) {
    const GroupTable a = by_group(one, compute(one, resolution));
    const GroupTable b = by_group(other, compute(other, resolution));
    double largest = 0.0;
    for (const auto& from : a.names) {
        for (const auto& to : a.names) {
            largest = std::max(largest, std::abs(a.factor(from, to) - b.factor(from, to)));
        }
    }
    return largest;
}

/// Largest difference between computed factors by group and exact ones, where each group is one surface.
double largest_error(const PatchMesh& mesh, const FormFactorMatrix& factors) {
    const GroupTable table = by_group(mesh, factors);
    double largest = 0.0;
    for (const Surface& from : mesh.surfaces()) {
        for (const Surface& to : mesh.surfaces()) {
            const double factor = table.factor(mesh.groups()[from.group], mesh.groups()[to.group]);
            largest = std::max(largest, std::abs(factor - exact_factor(from, to)));
        }
    }
    return largest;
}

/// Largest difference between what a row gives to a surface and the exact share as seen from the patch's
/// centre, where nothing hides anything: what texels alone do.
double largest_point_error(const PatchMesh& mesh, const FormFactorMatrix& factors) {
    double largest = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const RowView row = factors.row(i);
        std::vector<double> sums(mesh.surfaces().size(), 0.0);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            sums[mesh.surface_of()[row.columns[k]]] += double{row.values[k]};
        }
        const Plane horizon{mesh.normal(i), glm::dot(mesh.normal(i), mesh.centres()[i])};
        for (std::size_t s = 0; s < sums.size(); ++s) {
            const auto corners = mesh.surfaces()[s].polygon();
            ConvexPolygon polygon(corners);
            polygon.clip(horizon);
            const bool faces = s != mesh.surface_of()[i] && plane_of(corners).height(mesh.centres()[i]) > 0.0;
            const double exact = faces ? point_factor(mesh.centres()[i], mesh.normal(i), polygon) : 0.0;
            largest = std::max(largest, std::abs(sums[s] - exact));
        }
    }
    return largest;
}

/// Largest e_i + |1 - row sum|: 0 where a scene is closed and stays so.
double largest_leak(const FormFactorMatrix& factors) {
    double largest = 0.0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        if (factors.known(i)) {
            largest = std::max(largest, row.environment + std::abs(1.0 - row.sum()));
        }
    }
    return largest;
}

/// Closed box, cells x cells patches a wall.
Scene box_of(const Vec3& size, std::uint32_t cells) {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), size, cells);
    return scene;
}

/// Two unit squares, face to face.
Scene facing_plates(double distance) {
    const double z = distance;
    Scene scene = empty_scene();
    add_polygon(scene, "a", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)});
    add_polygon(scene, "b", {Vec3(0, 0, z), Vec3(0, 1, z), Vec3(1, 1, z), Vec3(1, 0, z)});
    return scene;
}

/// Two unit squares with a common edge, `degrees` apart, their fronts towards each other.
Scene fold(double degrees, std::uint32_t cells) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const Vec3 up(std::cos(angle), 0.0, std::sin(angle));
    const Vec3 y(0, 1, 0);
    Scene scene = empty_scene();
    add_polygon(scene, "a", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), y}, {cells, cells});
    add_polygon(scene, "b", {Vec3(0, 0, 0), y, y + up, up}, {cells, cells});
    return scene;
}

} // namespace

TEST_CASE("extremes: a scene of a millimetre and far away has the factors of the room it is a copy of",
          "[engine][gl][every-device]") {
    const Scene room = room_with_blocks(5);
    const PatchMesh base(room);
    for (const double distance : {1e5, 1e8}) {
        INFO("at " << distance);
        const PatchMesh mesh(moved(scaled(room, 1e-3), Vec3(distance, -distance, distance)));
        // A few texels flip. 0.5 mm patches at 1e8 are rounded to 1e-8.
        CHECK(largest_difference(base, mesh, 128) < 3e-5);
        const FormFactorMatrix factors = compute(mesh, 64);
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const bool looks_out = factors.row(i).environment == 1.0; // the bottom of the block
            CHECK((looks_out || factors.row(i).environment == 0.0));
        }
    }
    CHECK_THROWS_AS(PatchMesh(moved(scaled(room, 1e-3), Vec3(1e10, 0.0, 0.0))), InputError);
}

TEST_CASE("extremes: any scale is right or refused", "[engine][gl][every-device]") {
    const Scene room = room_with_blocks(4);
    const PatchMesh base(room);
    for (const double scale : {1e-68, 1e-20, 1e20, 1e68}) {
        INFO("scaled by " << scale);
        CHECK(largest_difference(base, PatchMesh(scaled(room, scale)), 64) < 1e-4);
    }
    for (const double scale : {1e-300, 1e-75, 1e75, 1e200}) { // areas would be 0 or infinite
        INFO("scaled by " << scale);
        CHECK_THROWS_AS(PatchMesh(scaled(room, scale)), Error);
    }
}

TEST_CASE("extremes: strips of 1 : 1000", "[engine][gl][every-device]") {
    // Each wall of the duct is 1 x 1000, cut into 16 strips of 16 pieces, 1/16 x 62.5.
    const PatchMesh duct(box_of(Vec3(1, 1, 1000), 16));
    const FormFactorMatrix factors = compute(duct, 128);
    CHECK(largest_leak(factors) < 1e-8);
    CHECK(largest_error(duct, factors) < 6e-4); // the walls' ends are sampled 31 away from them
    // One patch a wall: one point of it is all that is seen.
    const PatchMesh coarse(box_of(Vec3(1, 1, 1000), 1));
    const FormFactorMatrix rows = compute(coarse, 128);
    CHECK(largest_leak(rows) < 1e-8);
    CHECK(largest_point_error(coarse, rows) < 1e-3);
}

TEST_CASE("extremes: a gap of 1e-4 of the patch size", "[engine][gl][every-device]") {
    const PatchMesh flat(box_of(Vec3(1, 1, 1e-4), 8));
    const FormFactorMatrix factors = compute(flat, 64);
    CHECK(largest_leak(factors) < 1e-8);
    // 2e-4 of what leaves the large walls goes to the small ones, all from their rims, where no eye is.
    CHECK(largest_error(flat, factors) < 3e-4);

    const PatchMesh plates(facing_plates(1e-4));
    const FormFactorMatrix two = compute(plates, 64);
    CHECK(largest_point_error(plates, two) < 1e-6);
    CHECK(largest_error(plates, two) < 3e-4);
}

TEST_CASE("extremes: patches that touch at edges of 1 and 179 degrees", "[engine][gl][every-device]") {
    struct Limit {
        double degrees;
        double point; ///< by texels: a wall of 1 degree is half a texel high
        double area;  ///< by one eye point a patch
    };
    for (const Limit& limit : {Limit{1.0, 3e-4, 1e-2}, Limit{10.0, 1e-3, 4e-3}, Limit{179.0, 1e-5, 3e-6},
                               Limit{179.9, 1e-5, 3e-7}}) {
        const PatchMesh mesh(fold(limit.degrees, 16));
        const FormFactorMatrix factors = compute(mesh, 256);
        INFO(limit.degrees << " degrees, exactly " << exact_factor(mesh.surfaces()[0], mesh.surfaces()[1]));
        CHECK(largest_point_error(mesh, factors) < limit.point);
        CHECK(largest_error(mesh, factors) < limit.area);
    }
}

TEST_CASE("extremes: a needle between two halves of a ceiling", "[engine][gl][every-device]") {
    const auto room = [](double width) {
        Scene scene = empty_scene();
        add_room(scene, Vec3(0.0), Vec3(1.0), 4);
        std::erase_if(scene.surfaces, [&](const Surface& s) { return scene.groups[s.group] == "z1"; });
        const double a = 0.5;
        const double b = 0.5 + width;
        add_polygon(scene, "left", {Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(a, 1, 1), Vec3(a, 0, 1)}, {4, 4});
        add_polygon(scene, "needle", {Vec3(a, 0, 1), Vec3(a, 1, 1), Vec3(b, 1, 1)});
        add_polygon(scene, "other needle", {Vec3(a, 0, 1), Vec3(b, 1, 1), Vec3(b, 0, 1)});
        add_polygon(scene, "right", {Vec3(b, 0, 1), Vec3(b, 1, 1), Vec3(1, 1, 1), Vec3(1, 0, 1)}, {4, 4});
        return scene;
    };
    for (const double width : {1e-3, 1e-6, 1e-8}) {
        INFO("1 : " << 1.0 / width);
        const PatchMesh mesh(room(width));
        const FormFactorMatrix factors = compute(mesh, 128);
        CHECK(largest_leak(factors) < 1e-8);
        CHECK(largest_point_error(mesh, factors) < 2e-3);
        CHECK(by_group(mesh, factors).factor("z0", "needle") <= 2.0 * width);
    }
    CHECK_THROWS_WITH(PatchMesh(room(1e-10)), Catch::Contains("needle") && Catch::Contains("zero area"));
}

TEST_CASE("extremes: factors of 3e-7", "[engine][gl][every-device]") {
    const PatchMesh mesh(read_case("18_far_patch.obj"));
    const GroupTable table = by_group(mesh, compute(mesh, 1024));
    CHECK(table.factor("tiny", "big") == Approx(0.0031695610043893825).epsilon(1e-2));
    // No texel of the big patch's eye is as small as the tiny one: what is small is known by reciprocity,
    // else it is lost, or as large as a texel.
    constexpr double texel = 4.0 / (1024.0 * 1024.0 * std::numbers::pi);
    CHECK(std::abs(table.factor("big", "tiny") - 3.169561004389383e-07) < texel);
}

TEST_CASE("extremes: one patch sees nothing, two see each other from their centres",
          "[engine][gl][every-device]") {
    Scene single = facing_plates(1.0);
    single.surfaces.resize(1);
    const PatchMesh one(single);
    CHECK(compute(one, 32).row(0).environment == 1.0);
    for (const double distance : {1.0, 30.0}) {
        const PatchMesh two(facing_plates(distance));
        const FormFactorMatrix factors = compute(two, 1024);
        CHECK(factors.row(0).sum() + factors.row(0).environment == Approx(1.0).margin(1e-9).epsilon(0));
        CHECK(largest_point_error(two, factors) < 1e-4);
    }
}

TEST_CASE("extremes: the smallest and the largest resolution lose nothing of a closed box",
          "[engine][gl][every-device]") {
    const PatchMesh mesh(box_of(Vec3(1.0, 1.3, 0.7), 1));
    for (const std::uint32_t resolution : {2u, 4u, 4096u}) {
        INFO("resolution " << resolution);
        const FormFactorMatrix factors = compute(mesh, resolution);
        CHECK(largest_leak(factors) < 1e-7);
        CHECK(largest_point_error(mesh, factors) < 0.5 / resolution);
    }
}

TEST_CASE("extremes: a sealed box within a box", "[engine][gl][every-device]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0), 4);
    add_block(scene, "outside", Vec3(0.3), Vec3(0.7), 3);
    const std::size_t last = scene.surfaces.size();
    for (std::size_t s = last - 6; s < last; ++s) { // its inner sides, in the same places
        Surface inner = scene.surfaces[s];
        std::reverse(inner.vertices.begin(), inner.vertices.end());
        inner.group = scene.group_index("inside");
        scene.surfaces.push_back(inner);
    }
    const PatchMesh mesh(scene);
    const FormFactorMatrix factors = compute(mesh, 128);
    CHECK(largest_leak(factors) < 1e-8);
    // Seen from outside, a texel on the silhouette may show the far wall's inner side: where near and far
    // wall meet their depths are equal.
    constexpr double texel = 4.0 / (128.0 * 128.0 * std::numbers::pi);
    std::vector<double> exitance(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const bool inside = mesh.groups()[mesh.group(i)] == "inside";
        exitance[i] = inside ? 1.0 : 0.0;
        double across = 0.0;
        const RowView row = factors.row(i);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            const bool to_inside = mesh.groups()[mesh.group(row.columns[k])] == "inside";
            across += to_inside != inside ? double{row.values[k]} : 0.0;
        }
        CHECK(across <= (inside ? 0.0 : 2.0 * texel));
    }
    const std::vector<double> reflectance(mesh.size(), 0.5);
    const auto radiosity =
        solve_radiosity({&factors, 1, reflectance, exitance, {}}, {.tolerance = 1e-9}).radiosity;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const bool inside = exitance[i] > 0.0;
        CHECK(radiosity[i] == Approx(inside ? 2.0 : 0.0).margin(inside ? 1e-6 : 2.0 * texel).epsilon(0));
    }
}

TEST_CASE("extremes: 100,000 patches", "[engine][gl][every-device]") {
    const PatchMesh mesh(box_of(Vec3(1.0, 1.3, 0.7), 130));
    REQUIRE(mesh.size() == 101400);
    std::vector<std::uint32_t> patches;
    for (std::uint32_t i = 17; i < mesh.size(); i += 401) {
        patches.push_back(i);
    }
    const auto engine =
        make_hemicube_engine(mesh, {.resolution = 32}, {test_device(), 2, find_worker_program()});
    const FormFactorMatrix factors = compute_matrix(*engine, patches);
    CHECK(largest_leak(factors) < 1e-8);
    // A texel holds a dozen patches: single factors are samples, sums over a wall are right to a few texels
    // of the silhouette.
    double worst = 0.0;
    for (const std::uint32_t i : patches) {
        const RowView row = factors.row(i);
        CHECK(row.columns.size() <= 3 * 32 * 32);
        std::vector<double> sums(mesh.surfaces().size(), 0.0);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            sums[mesh.surface_of()[row.columns[k]]] += double{row.values[k]};
        }
        for (std::size_t s = 0; s < sums.size(); ++s) {
            const ConvexPolygon wall(mesh.surfaces()[s].polygon());
            const double exact =
                s == mesh.surface_of()[i] ? 0.0 : point_factor(mesh.centres()[i], mesh.normal(i), wall);
            worst = std::max(worst, std::abs(sums[s] - exact));
        }
    }
    CHECK(worst < 1e-2);
}
