#include "hemi/scene/thermal_exitance.hpp"

#include "hemi/core/black_body.hpp"

#include <catch2/catch.hpp>

using namespace hemi;
using Catch::Contains;

TEST_CASE("temperatures become exitance where light is solved for", "[scene][heat]") {
    Scene scene;
    scene.channels = {"short", "long"};
    scene.groups = {"hot", "warm", "plate"};
    scene.environment = {1.0, 2.0};
    Material grey{"grey", {0.2, 0.5}, {0.0, 3.0}};
    Material table{"table", {0.5, 0.5}, {0.0, 0.0}};
    table.emissivity_table = {{300.0, 0.4}, {1300.0, 0.9}};
    scene.materials = {grey, table};
    Thermal& thermal = scene.thermal.emplace();
    thermal.band_limits = {4.0};
    thermal.environment_temperature = 290.0;
    thermal.conditions.resize(3);
    thermal.conditions[0].temperature = 1300.0;
    thermal.conditions[1].temperature = 800.0;
    thermal.conditions[2].heat_flux = 0.0;
    for (std::uint32_t g = 0; g < 3; ++g) {
        Surface surface;
        surface.group = g;
        surface.heat = g;
        surface.material = g == 1 ? 1 : 0;
        scene.surfaces.push_back(surface);
    }
    Diagnostics diagnostics;
    radiate_by_temperature(scene, diagnostics);
    CHECK_FALSE(scene.thermal);
    const auto material = [&](std::size_t s) -> const Material& {
        return scene.materials[scene.surfaces[s].material];
    };
    const std::vector<double> hot = band_fractions(1300.0, std::vector<double>{4.0});
    CHECK(material(0).exitance[0] == Approx(0.8 * hot[0] * black_body_exitance(1300.0)));
    CHECK(material(0).exitance[1] == Approx(0.5 * hot[1] * black_body_exitance(1300.0) + 3.0));
    CHECK(material(1).reflectance[0] == Approx(0.35));
    CHECK(material(1).exitance[0] + material(1).exitance[1] == Approx(0.65 * black_body_exitance(800.0)));
    CHECK(material(0).name == "grey at 1300 K");
    CHECK(material(2) == grey);
    CHECK(scene.environment[0] + scene.environment[1] == Approx(3.0 + black_body_exitance(290.0)));
    REQUIRE(diagnostics.warnings().size() == 1);
    CHECK_THAT(diagnostics.warnings()[0], Contains("plate") && Contains("hemi heat"));
}

TEST_CASE("validate: reflectance 1 is for thermal scenes, and conditions must be there", "[scene][heat]") {
    Scene scene;
    scene.groups = {"plate"};
    scene.environment = {0.0};
    scene.materials = {{"mirror", {1.0}, {0.0}}};
    Surface surface;
    surface.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
    scene.surfaces = {surface};
    CHECK_THROWS_WITH(validate(scene), Contains("mirror") && Contains("below 1"));
    scene.thermal.emplace();
    CHECK_NOTHROW(validate(scene));
    scene.surfaces[0].heat = 0;
    CHECK_THROWS_WITH(validate(scene), Contains("heat condition 0"));
    scene.thermal->conditions.resize(1);
    CHECK_NOTHROW(validate(scene));
    scene.materials[0].reflectance = {1.5};
    CHECK_THROWS_WITH(validate(scene), Contains("at most 1"));
}
