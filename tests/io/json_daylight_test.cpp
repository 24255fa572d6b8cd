#include "cli/program.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/scene_reader.hpp"

#include <catch2/catch.hpp>

#include <string>

using namespace hemi;
using Catch::Contains;
using hemi::cli_test::Directory;
using hemi::cli_test::Json;

namespace {

/// A floor of 2 x 1 and two lamps of 1 x 1, all of one material.
Json room() {
    return Json::parse(R"({
      "hemi": 1,
      "materials": {"white": {"reflectance": 0.5}},
      "surfaces": [
        {"name": "floor", "material": "white", "polygon": [[0,0,0],[2,0,0],[2,1,0],[0,1,0]]},
        {"name": "lamp", "material": "white", "polygon": [[0,1,1],[1,1,1],[1,0,1],[0,0,1]]},
        {"name": "lamp", "material": "white", "polygon": [[1,1,1],[2,1,1],[2,0,1],[1,0,1]]}]})");
}

Scene read(const Directory& directory, const Json& scene, Diagnostics* diagnostics = nullptr) {
    Diagnostics ignored;
    return io::read_scene(directory.write("scene.json", scene), {}, diagnostics ? *diagnostics : ignored);
}

double exitance(const Scene& scene, std::size_t surface) {
    return scene.materials[scene.surfaces[surface].material].exitance[0];
}

} // namespace

TEST_CASE("JSON: lumens become an exitance by the area of what radiates", "[io][daylight]") {
    const Directory directory;
    Json json = room();
    CHECK_FALSE(read(directory, json).photometric);
    json["groups"]["lamp"] = {{"luminous_flux", 3000}};
    Scene scene = read(directory, json);
    CHECK(scene.photometric);
    CHECK(exitance(scene, 0) == 0.0);
    CHECK(exitance(scene, 1) == Approx(1500.0));
    CHECK(exitance(scene, 2) == Approx(1500.0));
    CHECK(scene.materials[scene.surfaces[1].material].reflectance[0] == 0.5);

    json["unit"] = "cm";
    CHECK(exitance(read(directory, json), 1) == Approx(1.5e7));
    json.erase("unit");
    json["surfaces"][2]["two_sided"] = true;
    CHECK(exitance(read(directory, json), 1) == Approx(1000.0));
    json["surfaces"][2].erase("two_sided");

    json.erase("groups");
    json["surfaces"][1]["luminous_flux"] = 700; // of that one alone
    scene = read(directory, json);
    CHECK(exitance(scene, 1) == Approx(700.0));
    CHECK(exitance(scene, 2) == 0.0);

    json["channels"] = {"a", "b"};
    json["surfaces"][1]["luminous_flux"] = {700, 300};
    scene = read(directory, json);
    CHECK(scene.materials[scene.surfaces[1].material].exitance == std::vector<double>{700.0, 300.0});
    CHECK(scene.materials.size() == 2); // the other surfaces' stays dark

    // A material that only lamps have is theirs.
    json["materials"]["glass"] = {{"reflectance", 0.7}};
    json["surfaces"][1]["material"] = "glass";
    scene = read(directory, json);
    CHECK(scene.materials.size() == 2);
    CHECK(scene.materials[scene.surfaces[1].material].name == "glass");
    CHECK(exitance(scene, 1) == 700.0);
    CHECK(exitance(scene, 0) == 0.0);
}

TEST_CASE("JSON: what is wrong with lumens is said", "[io][daylight]") {
    const Directory directory;
    Json json = room();
    json["groups"]["lamp"] = {{"luminous_flux", -3}};
    CHECK_THROWS_WITH(read(directory, json), Contains("groups.lamp.luminous_flux") && Contains("negative"));
    json["groups"]["lamp"] = {{"luminous_flux", 0}};
    CHECK_THROWS_WITH(read(directory, json), Contains("0 lm"));
    json["groups"] = {{"lmap", {{"luminous_flux", 3}}}};
    CHECK_THROWS_WITH(read(directory, json), Contains("lmap") && Contains("lamp"));
    json["groups"] = {{"lamp", {{"luminous_flux", 3}}}};
    json["materials"]["white"]["exitance"] = 2;
    CHECK_THROWS_WITH(read(directory, json), Contains("white") && Contains("exitance"));
    json["materials"]["white"].erase("exitance");
    json["surfaces"][1]["luminous_flux"] = 4; // and the group's
    CHECK_THROWS_WITH(read(directory, json), Contains("groups.lamp.luminous_flux"));
    json["surfaces"][1].erase("luminous_flux");
    json["surfaces"][0]["temperature"] = 300;
    CHECK_THROWS_WITH(read(directory, json), Contains("lumens") && Contains("temperatures"));
    json["surfaces"][0].erase("temperature");
    json["sun"] = {{"direction", {0, 0, 1}}, {"normal_irradiance", 800}};
    CHECK_THROWS_WITH(read(directory, json), Contains("lumens") && Contains("watts"));
}

TEST_CASE("JSON: a sun has a place and a light", "[io][daylight]") {
    const Directory directory;
    Json json = room();
    json["sun"] = {{"direction", {0, -3, 4}}, {"normal_irradiance", 800}};
    Scene scene = read(directory, json);
    REQUIRE(scene.sun);
    CHECK(glm::length(scene.sun->direction - Vec3(0.0, -0.6, 0.8)) < 1e-15);
    CHECK(scene.sun->irradiance == std::vector<double>{800.0});
    CHECK_FALSE(scene.photometric);

    json["sun"] = {{"azimuth", 180}, {"elevation", 30}, {"north", 90}, {"normal_illuminance", 9e4}};
    scene = read(directory, json);
    CHECK(glm::length(scene.sun->direction - Vec3(-std::sqrt(0.75), 0.0, 0.5)) < 1e-12);
    CHECK(scene.photometric);

    json["sun"] = {{"latitude", 39.742476},
                   {"longitude", -105.1786},
                   {"time", "2003-10-17T12:30:30-07:00"},
                   {"normal_irradiance", 900}};
    scene = read(directory, json);
    CHECK(scene.sun->direction.z == Approx(std::sin(39.888 * 0.0174532925)).margin(3e-4));
    CHECK(scene.sun->direction.y < 0.0); // in the south
    json["sun"]["time"] = "2003-10-17T00:30:30-07:00";
    Diagnostics diagnostics;
    CHECK_FALSE(read(directory, json, &diagnostics).sun);
    REQUIRE(diagnostics.warnings().size() == 1);
    CHECK_THAT(diagnostics.warnings()[0], Contains("below the horizon"));
    // By angles likewise; a direction is what it is, such as that of a lamp in a laboratory.
    Diagnostics others;
    json["sun"] = {{"azimuth", 180}, {"elevation", -30}, {"normal_irradiance", 900}};
    CHECK_FALSE(read(directory, json, &others).sun);
    json["sun"] = {{"direction", {0, 1, -1}}, {"normal_irradiance", 900}};
    CHECK(read(directory, json, &others).sun);
    REQUIRE(others.warnings().size() == 2);
    CHECK_THAT(others.warnings()[0], Contains("30 degrees below the horizon and gives no light"));
    CHECK_THAT(others.warnings()[1], Contains("from below the horizon"));

    // One number for bands is shared out as by a black body of 5772 K: 98 % below 3 µm.
    json["bands"] = {3};
    json["sun"] = {{"direction", {0, 0, 1}}, {"normal_irradiance", 1000}};
    scene = read(directory, json);
    CHECK(scene.sun->irradiance[0] == Approx(978.0).margin(2.0));
    CHECK(scene.sun->irradiance[0] + scene.sun->irradiance[1] == Approx(1000.0));
    json["sun"]["normal_irradiance"] = {600, 400};
    CHECK(read(directory, json).sun->irradiance == std::vector<double>{600.0, 400.0});
    CHECK(scene.sun->diameter == 0.0);
    json["sun"]["diameter"] = 0.53;
    CHECK(read(directory, json).sun->diameter == 0.53);
}

TEST_CASE("JSON: azimuths are about the axis that points upwards, the file's or the option's",
          "[io][daylight]") {
    const Directory directory;
    Json json = room();
    json["sun"] = {{"azimuth", 90}, {"elevation", 30}, {"normal_irradiance", 800}};
    const auto near = [](const Vec3& a, const Vec3& b) { return glm::length(a - b) < 1e-12; };
    CHECK(near(read(directory, json).sun->direction, {std::sqrt(0.75), 0.0, 0.5}));
    json["up"] = "y";
    Scene scene = read(directory, json);
    CHECK(scene.up == UpAxis::y);
    CHECK(near(scene.sun->direction, {std::sqrt(0.75), 0.5, 0.0}));
    json["sun"]["azimuth"] = 0; // north is -z
    CHECK(near(read(directory, json).sun->direction, {0.0, 0.5, -std::sqrt(0.75)}));
    Diagnostics ignored;
    io::SceneReaderOptions options;
    options.up = UpAxis::z;
    scene = io::read_scene(directory.write("scene.json", json), options, ignored);
    CHECK(scene.up == UpAxis::z);
    CHECK(near(scene.sun->direction, {0.0, std::sqrt(0.75), 0.5}));
    json["up"] = "x";
    CHECK_THROWS_WITH(read(directory, json), Contains("up") && Contains("\"y\" or \"z\""));
}

TEST_CASE("JSON: what is wrong with a sun is said", "[io][daylight]") {
    const Directory directory;
    const auto fails = [&](const Json& sun, const std::string& about) {
        Json json = room();
        json["sun"] = sun;
        INFO(sun.dump());
        CHECK_THROWS_WITH(read(directory, json), Contains("sun") && Contains(about));
    };
    fails({{"normal_irradiance", 800}}, "where the sun is");
    fails({{"direction", {0, 0, 1}}}, "neither \"normal_irradiance\"");
    fails({{"direction", {0, 0, 1}}, {"normal_irradiance", 800}, {"normal_illuminance", 9}}, "both");
    fails({{"direction", {0, 0, 0}}, {"normal_irradiance", 800}}, "length 0");
    fails({{"direction", {0, 0, 1}}, {"normal_irradiance", -800}}, "negative");
    fails({{"direction", {0, 0, 1}}, {"azimuth", 3}, {"normal_irradiance", 800}}, "both \"direction\"");
    fails({{"direction", {0, 0, 1}}, {"north", 3}, {"normal_irradiance", 800}}, "north");
    fails({{"azimuth", 180}, {"normal_irradiance", 800}}, "elevation");
    fails({{"azimuth", 180}, {"elevation", 91}, {"normal_irradiance", 800}}, "[-90, 90]");
    fails({{"latitude", 48}, {"longitude", 11}, {"time", "noon"}, {"normal_irradiance", 800}}, "noon");
    fails({{"direction", {0, 0, 1}}, {"normal_irradiance", 800}, {"diameter", -1}}, "0.53");
    fails({{"direction", {0, 0, 1}}, {"normal_irradiance", 800}, {"diameter", 200}}, "[0, 90]");
    fails({{"azimut", 180}, {"elevation", 9}, {"normal_irradiance", 800}}, "azimuth");
}

TEST_CASE("JSON: an environment has a sky", "[io][daylight]") {
    const Directory directory;
    Json json = room();
    json["environment"] = {{"sky", "overcast"}, {"horizontal_illuminance", 10000}, {"ground", 0.2}};
    Scene scene = read(directory, json);
    REQUIRE(scene.sky);
    CHECK(scene.sky->distribution == SkyDistribution::overcast);
    CHECK(scene.sky->horizontal == std::vector<double>{10000.0});
    CHECK(scene.sky->ground == std::vector<double>{0.2});
    CHECK(scene.environment == std::vector<double>{0.0});
    CHECK(scene.photometric);
    json["environment"] = {{"horizontal_irradiance", 300}, {"temperature", 270}};
    scene = read(directory, json);
    CHECK(scene.sky->distribution == SkyDistribution::uniform);
    CHECK(scene.thermal->environment_temperature == 270.0);
    CHECK_FALSE(scene.photometric);

    json["environment"] = {{"sky", "overcast"}};
    CHECK_THROWS_WITH(read(directory, json), Contains("environment") && Contains("horizontal_irradiance"));
    json["environment"] = {{"sky", "overcats"}, {"horizontal_irradiance", 3}};
    CHECK_THROWS_WITH(read(directory, json), Contains("environment.sky") && Contains("overcast"));
    json["environment"] = {{"ground", 1.5}, {"horizontal_irradiance", 3}};
    CHECK_THROWS_WITH(read(directory, json), Contains("environment.ground") && Contains("1.5"));
    json["environment"] = {{"horizontal_irradiance", -3}};
    CHECK_THROWS_WITH(read(directory, json), Contains("environment.horizontal_irradiance"));
}
