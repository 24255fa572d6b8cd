#include "cli/program.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/scene_reader.hpp"

#include <catch2/catch.hpp>

using namespace hemi;
using Catch::Contains;
using hemi::cli_test::Directory;
using hemi::cli_test::Json;

namespace {

/// Two facing plates.
Json plates() {
    return Json::parse(R"({
      "hemi": 1,
      "materials": {"hot": {"emissivity": 0.8}, "cold": {"reflectance": 0.5}},
      "surfaces": [
        {"name": "floor", "material": "hot", "polygon": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]],
         "temperature": "227 C"},
        {"name": "ceiling", "material": "cold", "polygon": [[0,1,1],[1,1,1],[1,0,1],[0,0,1]]}]})");
}

Scene read(const Directory& directory, const Json& scene, bool adiabatic = false) {
    io::SceneReaderOptions options;
    options.adiabatic = adiabatic;
    Diagnostics diagnostics;
    return io::read_scene(directory.write("scene.json", scene), options, diagnostics);
}

} // namespace

TEST_CASE("JSON: temperatures, fluxes, emissivities, bands and the unit are read", "[io][heat]") {
    const Directory directory;
    Json json = plates();
    json["groups"] = {{"ceiling", {{"heat_flux", -40}, {"isothermal", true}}}};
    json["environment"] = {{"temperature", 290}};
    json["unit"] = "mm";
    Scene scene = read(directory, json);
    CHECK(scene.materials[1].reflectance[0] == Approx(0.2)); // by name: cold, hot
    CHECK(scene.unit == 0.001);
    REQUIRE(scene.thermal);
    CHECK(scene.thermal->environment_temperature == 290.0);
    REQUIRE(scene.thermal->conditions.size() == 2);
    CHECK(*scene.thermal->conditions[scene.surfaces[0].heat].temperature == Approx(500.15));
    const HeatCondition& ceiling = scene.thermal->conditions[scene.surfaces[1].heat];
    CHECK(ceiling.heat_flux == -40.0);
    CHECK(ceiling.isothermal);
    CHECK(scene.channels == std::vector<std::string>{"grey"});

    json["bands"] = {2.5, 6};
    json["materials"]["hot"]["emissivity"] = {0.9, 0.5, 0.1};
    json["materials"]["cold"] = {{"emissivity", {{300, 0.2}, {"500 K", 0.4}, {900, 0.5}}}};
    scene = read(directory, json);
    CHECK(scene.channels == std::vector<std::string>{"band_1", "band_2", "band_3"});
    CHECK(scene.thermal->band_limits == std::vector<double>{2.5, 6.0});
    CHECK(scene.materials[1].reflectance[2] == Approx(0.9));
    const auto& table = scene.materials[0].emissivity_table;
    REQUIRE(table.size() == 3);
    CHECK(emissivity_at(table, 100.0) == 0.2);
    CHECK(emissivity_at(table, 400.0) == Approx(0.3));
    CHECK(emissivity_at(table, 900.0) == 0.5);
    CHECK(emissivity_at(table, 2000.0) == 0.5);
    CHECK(scene.materials[0].reflectance[1] == Approx(0.8));
}

TEST_CASE("JSON: a scene without heat has none, and reflectance 1 only where it is allowed", "[io][heat]") {
    const Directory directory;
    Json json = plates();
    json["surfaces"][0].erase("temperature");
    CHECK_FALSE(read(directory, json).thermal);
    CHECK(read(directory, json).surfaces[0].heat == no_heat);
    json["materials"]["cold"]["reflectance"] = 1;
    CHECK(read(directory, json, true).materials[0].reflectance[0] == 1.0);
    CHECK_THROWS_WITH(read(directory, json), Contains("reflectance") && Contains("below 1"));
    json["materials"]["cold"]["reflectance"] = 1.01;
    CHECK_THROWS_WITH(read(directory, json, true), Contains("reflectance") && Contains("at most 1"));
}

TEST_CASE("JSON: what is wrong with heat is told with its place", "[io][heat]") {
    const Directory directory;
    const auto refused = [&](const std::function<void(Json&)>& change, const auto& message) {
        Json json = plates();
        change(json);
        CHECK_THROWS_WITH(read(directory, json), message);
    };
    refused([](Json& j) { j["surfaces"][0]["temperature"] = -1; },
            Contains("surfaces[0].temperature") && Contains("below 0 K"));
    refused([](Json& j) { j["surfaces"][0]["temperature"] = "-300 C"; }, Contains("below 0 K"));
    refused([](Json& j) { j["surfaces"][0]["temperature"] = "68 F"; },
            Contains("\"68 F\"") && Contains("20 C"));
    refused(
        [](Json& j) {
            j["surfaces"][0]["temperature"] = {1, 2};
        },
        Contains("surfaces[0].temperature") && Contains("kelvin"));
    refused([](Json& j) { j["surfaces"][0]["heat_flux"] = 1; },
            Contains("\"temperature\"") && Contains("\"heat_flux\""));
    refused([](Json& j) { j["surfaces"][1]["isothermal"] = true; }, Contains("isothermal"));
    refused([](Json& j) { j["materials"]["hot"]["emissivity"] = 0; },
            Contains("materials.hot.emissivity") && Contains("above 0"));
    refused([](Json& j) { j["materials"]["hot"]["emissivity"] = 1.5; }, Contains("at most 1"));
    refused([](Json& j) { j["materials"]["hot"]["reflectance"] = 0.2; }, Contains("both"));
    refused(
        [](Json& j) {
            j["materials"]["hot"]["emissivity"] = {{500, 0.2}, {300, 0.4}};
        },
        Contains("ascend"));
    refused(
        [](Json& j) {
            j["groups"] = {{"flor", {{"heat_flux", 0}}}};
        },
        Contains("\"flor\"") && Contains("\"floor\""));
    refused([](Json& j) { j["groups"] = {{"floor", {{"heat_flux", 0}}}}; }, Contains("of its own"));
    refused([](Json& j) { j["bands"] = {6, 2.5}; }, Contains("bands[1]") && Contains("ascend"));
    refused(
        [](Json& j) {
            j["bands"] = {2.5};
            j["channels"] = {"a", "b", "c"};
        },
        Contains("2 bands") && Contains("3 channels"));
    refused([](Json& j) { j["unit"] = "yards"; }, Contains("yards") && Contains("cm"));
}
