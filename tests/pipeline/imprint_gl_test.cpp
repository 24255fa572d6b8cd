#include "hemi/engine/engine.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/scene/imprint.hpp"

#include "support/dice.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>

namespace hemi {

using test::Dice;

namespace {

struct Lit {
    std::map<std::string, double> irradiance; ///< means of groups
    double emitted = 0.0;
    double absorbed = 0.0;
};

/// A scene of tests/data/imprint, cut where its faces touch, solved.
Lit solve_imprinted(const std::string& file) {
    const Scene read = io::read_scene(test::data_path("imprint/" + file));
    const auto cut = imprint(read);
    REQUIRE(cut);
    const Scene& scene = cut->scene;
    const PatchMesh mesh(scene);
    FactorSettings settings;
    settings.engine.device = cpu_device;
    settings.estimate_error = false;
    const FormFactors factors = compute_form_factors(scene, mesh, settings);
    SolverSettings solver;
    solver.tolerance = 1e-10;
    const Solution solution = solve_radiosity(scene, mesh, factors, solver);
    const std::vector<double> reflectance = patch_values(mesh, scene.materials, &Material::reflectance);
    Lit lit;
    std::map<std::string, double> areas;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const double area = mesh.areas()[i];
        const std::string& group = mesh.groups()[mesh.group(i)];
        lit.irradiance[group] += area * solution.irradiance[i];
        areas[group] += area;
        lit.emitted += area * solution.exitance[i];
        lit.absorbed += area * (1.0 - reflectance[i]) * solution.irradiance[i];
    }
    for (auto& [group, sum] : lit.irradiance) {
        sum /= areas[group];
    }
    return lit;
}

/// A closed room of 4 x 3 x 2 with a lamp in its ceiling, which lies over it in its plane, boxes that stand
/// on the floor and on each other's places or hang through walls, sheets that stand and float, and rugs.
Scene furnished_room(std::uint32_t seed) {
    Dice dice(seed);
    Scene scene;
    scene.materials = {{"grey", {0.5}, {0.0}}, {"light", {0.8}, {0.0}}, {"lamp", {0.2}, {10.0}}};
    scene.groups = {"room", "things", "lamp"};
    scene.environment = {0.0};
    const auto add = [&](std::uint32_t material, std::uint32_t group, const std::vector<Vec3>& corners,
                         Grid grid, bool two_sided = false) {
        Surface surface;
        surface.vertex_count = 4;
        std::copy(corners.begin(), corners.end(), surface.vertices.begin());
        surface.material = material;
        surface.group = group;
        surface.patches = grid;
        surface.two_sided = two_sided;
        scene.surfaces.push_back(surface);
    };
    /// Faces of a box, outwards or inwards.
    const auto add_box = [&](Vec3 a, Vec3 b, bool inwards, Grid grid, bool with_floor, double turn) {
        const Vec3 middle = 0.5 * (a + b);
        const auto corner = [&](int x, int y, int z) {
            const Vec3 at(x != 0 ? b.x : a.x, y != 0 ? b.y : a.y, z != 0 ? b.z : a.z);
            const double dx = at.x - middle.x;
            const double dy = at.y - middle.y;
            return Vec3(middle.x + std::cos(turn) * dx - std::sin(turn) * dy,
                        middle.y + std::sin(turn) * dx + std::cos(turn) * dy, at.z);
        };
        const std::vector<std::vector<Vec3>> faces{
            {corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)},
            {corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)},
            {corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1)},
            {corner(1, 1, 0), corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1)},
            {corner(0, 1, 0), corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1)},
            {corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0), corner(1, 0, 0)}};
        for (std::size_t f = 0; f < (with_floor ? 6u : 5u); ++f) {
            std::vector<Vec3> face = faces[f];
            if (inwards) {
                std::reverse(face.begin(), face.end());
            }
            add(inwards ? 1 : 0, inwards ? 0 : 1, face, grid);
        }
    };
    add_box({0, 0, 0}, {4, 3, 2}, true, {3, 3}, true, 0.0);
    const double x = dice(0.2, 2.8);
    const double y = dice(0.2, 1.8);
    add(2, 2, {{x, y, 2}, {x, y + 1, 2}, {x + 1, y + 1, 2}, {x + 1, y, 2}}, {1, 1});
    for (int k = dice.pick(3); k > 0; --k) { // on the floor, without and with a floor of their own
        const Vec3 at(dice(0.8, 2.2), dice(0.8, 1.6), 0.0);
        add_box(at, at + Vec3(dice(0.02, 0.8), dice(0.1, 0.8), dice(0.2, 1.5)), false, {1, 2},
                dice.pick(2) == 0, dice.pick(2) * dice(0.0, 1.5));
    }
    if (dice.pick(2) == 0) { // a sheet on the floor
        const double turn = dice.pick(2) * dice(0.0, 3.0);
        const Vec3 at(dice(0.5, 3.5), dice(0.5, 2.5), 0.0);
        const Vec3 along = dice(0.2, 0.45) * Vec3(std::cos(turn), std::sin(turn), 0.0);
        const Vec3 up(0.0, 0.0, dice(0.2, 1.9));
        add(1, 1, {at - along, at + along, at + along + up, at - along + up}, {2, 1}, true);
    }
    if (dice.pick(2) == 0) { // one that floats, perhaps through a box
        const Vec3 at(dice(0.5, 2.5), dice(0.5, 1.5), dice(0.1, 1.0));
        add(0, 1, {at, at + Vec3(1.0, 0.1, 0.2), at + Vec3(1.0, 1.1, 0.2), at + Vec3(0.0, 1.0, 0.0)}, {1, 1},
            true);
    }
    if (dice.pick(2) == 0) { // a rug
        const Vec3 at(dice(0.1, 2.0), dice(0.1, 1.0), 0.0);
        const double length = dice(0.3, 1.9);
        add(0, 1, {at, at + Vec3(length, 0, 0), at + Vec3(length, 1, 0), at + Vec3(0, 1, 0)}, {1, 1});
    }
    return scene;
}

} // namespace

TEST_CASE("Imprint: in furnished rooms all light that is emitted is absorbed", "[imprint][slow]") {
    FactorSettings settings;
    settings.engine.device = cpu_device;
    settings.preset = Preset::fast;
    settings.estimate_error = false;
    SolverSettings solver;
    solver.tolerance = 1e-10;
    int with_cuts = 0;
    for (std::uint32_t seed = 0; seed < 500; ++seed) {
        INFO("seed " << seed);
        const Scene scene = furnished_room(seed);
        const auto cut = imprint(scene);
        REQUIRE(cut); // the lamp lies in the ceiling
        with_cuts += cut->findings.size() > 1 ? 1 : 0;
        const PatchMesh mesh(cut->scene);
        const FormFactors factors = compute_form_factors(cut->scene, mesh, settings);
        const Solution solution = solve_radiosity(cut->scene, mesh, factors, solver);
        double emitted = 0.0;
        double absorbed = 0.0;
        double lost = 0.0;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const RowView row = factors.matrix.row(i);
            const double area = mesh.areas()[i];
            const double reflectance = cut->scene.materials[mesh.material(i)].reflectance[0];
            emitted += area * solution.exitance[i];
            absorbed += area * (1.0 - reflectance) * solution.irradiance[i];
            lost += area * solution.radiosity[i] * (row.blocked + row.environment);
        }
        CHECK(emitted == Approx(10.0));
        CHECK(absorbed == Approx(emitted).epsilon(1e-6));
        CHECK(lost < 1e-6 * emitted);
    }
    CHECK(with_cuts > 300);
}

TEST_CASE("Imprint: nothing passes a partition that stands in the middle of patches", "[imprint]") {
    const Lit lit = solve_imprinted("partition.json");
    CHECK(lit.irradiance.at("east") < 1e-4 * lit.irradiance.at("west")); // 7 % of it without
    CHECK(lit.absorbed == Approx(lit.emitted).epsilon(1e-6));
}

TEST_CASE("Imprint: no light is lost in the foot of a thin wall", "[imprint]") {
    const Lit lit = solve_imprinted("wall.json");
    CHECK(lit.absorbed == Approx(lit.emitted).epsilon(1e-6)); // 1 % is lost without
    CHECK(lit.irradiance.at("east") < 1e-4 * lit.irradiance.at("west"));
}

TEST_CASE("Imprint: a black rug in the plane of the floor is as dark as one a millimetre above it",
          "[imprint]") {
    // Right: the same rug 1 mm above the floor.
    const Lit lit = solve_imprinted("rug.json");
    CHECK(lit.irradiance.at("rug") == Approx(5.164).epsilon(2e-3));
    CHECK(lit.irradiance.at("ceiling") == Approx(1.551).epsilon(2e-3));
    CHECK(lit.irradiance.at("north") == Approx(2.416).epsilon(2e-3));
}

} // namespace hemi
