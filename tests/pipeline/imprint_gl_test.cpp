#include "hemi/engine/engine.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/scene/imprint.hpp"

#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <map>
#include <string>

namespace hemi {

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

} // namespace

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
