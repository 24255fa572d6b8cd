#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/light_balance.hpp"

#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <utility>

namespace hemi {

namespace {

struct Solved {
    PatchMesh mesh;
    FormFactors factors;
    PatchValues values;
    Solution solution;
};

Solved solve(const Scene& scene) {
    PatchMesh mesh(scene);
    FactorSettings settings;
    settings.engine.device = cpu_device;
    settings.estimate_error = false;
    PatchValues values = patch_values(scene, mesh);
    FormFactors factors = compute_raw_form_factors(scene, mesh, shining_patches(values), settings);
    prepare_form_factors(factors);
    SolverSettings solver;
    solver.tolerance = 1e-12;
    Solution solution = solve_radiosity(factors, values, solver, no_observer(), false);
    return {std::move(mesh), std::move(factors), std::move(values), std::move(solution)};
}

/// A room of 2 x 2 x 1 whose ceiling is a black lamp, with exitance 3.
Scene lit_room() {
    Scene scene = test::empty_scene();
    test::add_room(scene, {0, 0, 0}, {2, 2, 1}, 3);
    scene.materials.push_back({"lamp", {0.0}, {3.0}});
    scene.materials.push_back({"black", {0.0}, {0.0}});
    for (Surface& surface : scene.surfaces) {
        surface.material = scene.groups[surface.group] == "z1" ? 1 : surface.material;
        surface.material = scene.groups[surface.group] == "x0" ? 2 : surface.material;
    }
    return scene;
}

} // namespace

TEST_CASE("LightBalance: a closed room absorbs what its lamp emits, also where rows are left out",
          "[pipeline]") {
    const Solved solved = solve(lit_room());
    REQUIRE_FALSE(solved.factors.matrix.all_known()); // the black wall's are not needed
    const auto balance = light_balance(solved.factors, solved.values, solved.solution.radiosity);
    REQUIRE(balance);
    CHECK(balance->emitted == Approx(12.0));
    CHECK(balance->incoming == Approx(12.0));
    CHECK(balance->absorbed == Approx(12.0).epsilon(1e-6));
    CHECK(balance->environment == Approx(0.0).margin(1e-6));
    CHECK(balance->lost == Approx(0.0).margin(1e-6));
    // Without the lamp's rows nothing can be said.
    std::vector<std::uint32_t> reflecting;
    for (std::uint32_t i = 0; i < solved.mesh.size(); ++i) {
        if (solved.values.reflectance[i] > 0.0) {
            reflecting.push_back(i);
        }
    }
    FactorSettings settings;
    settings.engine.device = cpu_device;
    settings.estimate_error = false;
    FormFactors fewer = compute_raw_form_factors(lit_room(), solved.mesh, reflecting, settings);
    CHECK_FALSE(light_balance(fewer, solved.values, solved.solution.radiosity));
}

TEST_CASE("LightBalance: a lamp back to back with a wall of a closed room lights the outside alone",
          "[pipeline]") {
    Scene scene = lit_room();
    test::add_polygon(scene, "outside", {Vec3(2, 2, 0), Vec3(2, 2, 1), Vec3(2, 0, 1), Vec3(2, 0, 0)}, {2, 2});
    scene.surfaces.back().material = 1;
    const Solved solved = solve(scene);
    const auto balance = light_balance(solved.factors, solved.values, solved.solution.radiosity);
    REQUIRE(balance);
    CHECK(balance->emitted == Approx(18.0));
    CHECK(balance->absorbed == Approx(12.0).epsilon(1e-6));
    CHECK(balance->environment == Approx(6.0).epsilon(1e-6));
    CHECK(balance->lost == Approx(0.0).margin(1e-6));
}

TEST_CASE("LightBalance: through an opening light goes out, and comes in", "[pipeline]") {
    Scene scene = lit_room();
    std::erase_if(scene.surfaces,
                  [&](const Surface& surface) { return scene.groups[surface.group] == "y1"; });
    SECTION("a dark environment takes what is not absorbed") {
        const Solved solved = solve(scene);
        const auto balance = light_balance(solved.factors, solved.values, solved.solution.radiosity);
        REQUIRE(balance);
        CHECK(balance->environment > 1.0);
        CHECK(balance->absorbed + balance->environment == Approx(12.0).epsilon(1e-6));
        CHECK(balance->lost == 0.0);
    }
    SECTION("one as bright as everything gives what it takes") { // a furnace
        scene.materials[1] = {"lamp", {0.0}, {1.0}};
        scene.materials[2] = {"black", {0.0}, {1.0}};
        scene.materials[0] = {"grey", {0.5}, {0.5}};
        scene.environment = {1.0};
        const Solved solved = solve(scene);
        const auto balance = light_balance(solved.factors, solved.values, solved.solution.radiosity);
        REQUIRE(balance);
        CHECK(balance->environment == Approx(0.0).margin(1e-5));
        CHECK(balance->absorbed == Approx(balance->emitted).epsilon(1e-6));
        CHECK(balance->incoming == Approx(balance->emitted + 2.0).epsilon(1e-3));
    }
}

TEST_CASE("LightBalance: light on the back of a one-sided sheet is lost, and told of the groups it leaves",
          "[pipeline]") {
    Scene scene = lit_room();
    // It looks down: the lamp shines on its back.
    test::add_polygon(scene, "baffle", {{0.5, 0.5, 0.5}, {0.5, 1.5, 0.5}, {1.5, 1.5, 0.5}, {1.5, 0.5, 0.5}},
                      {2, 2});
    const Solved solved = solve(scene);
    const auto balance = light_balance(solved.factors, solved.values, solved.solution.radiosity);
    REQUIRE(balance);
    CHECK(balance->lost_share() > 0.1);
    CHECK(balance->absorbed + balance->lost + balance->environment == Approx(12.0).epsilon(1e-5));
    double sum = 0.0;
    for (const double lost : balance->lost_of_group) {
        sum += lost;
    }
    CHECK(sum == Approx(balance->lost));
    for (std::size_t g = 0; g < scene.groups.size(); ++g) {
        CHECK((scene.groups[g] == "z1") == (balance->lost_of_group[g] > 0.5 * balance->lost));
    }
    scene.surfaces.back().two_sided = true;
    const Solved both = solve(scene);
    const auto mended = light_balance(both.factors, both.values, both.solution.radiosity);
    REQUIRE(mended);
    CHECK(mended->lost == Approx(0.0).margin(1e-9));
}

TEST_CASE("LightBalance: what does not fit is refused", "[pipeline]") {
    const Solved solved = solve(lit_room());
    CHECK_THROWS_AS(light_balance(solved.factors, solved.values, std::vector<double>{1.0}), InvalidArgument);
}

} // namespace hemi
