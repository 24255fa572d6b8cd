#include "hemi/io/scene_writer.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/scene_reader.hpp"
#include "io/io_fixtures.hpp"

#include <catch2/catch.hpp>

using namespace hemi;
using hemi::io_test::Folder;

namespace {

const std::string surfaces =
    R"("surfaces": [{"name": "a \"camera\": {", "material": "m", "polygon": [[0,0,0],[1,0,0],[0,1,0]]}])";

Camera camera() {
    return {{0.1, -2.5, 1e-3}, {1.0 / 3.0, 2.0, 0.5}, {0.0, 0.6, 0.8}, 33.3, true};
}

void check_same(const std::optional<Camera>& read) {
    REQUIRE(read);
    CHECK(read->eye == camera().eye);
    CHECK(read->target == camera().target);
    CHECK(read->up == camera().up);
    CHECK(read->fov == camera().fov);
    CHECK(read->orthographic);
}

} // namespace

TEST_CASE("write_scene_camera: replaces the camera and nothing else", "[io]") {
    const std::string before = R"({"hemi": 1,  "materials": {"m": {"reflectance": 0.5}},
  )" + surfaces + ",\n  \"camera\" :";
    const std::string after = "  ,\n\t\"name\": \"camera\" }\n\n";
    const Folder folder;
    const auto path =
        folder.write("scene.json", before + R"( {"eye": [0,0,4], "target": [0,0,0], "up": [0,1,0]})" + after);
    io::write_scene_camera(path, camera());
    Diagnostics diagnostics;
    check_same(io::read_scene(path, {}, diagnostics).camera);
    const std::string text = io::read_file(path);
    CHECK(text.substr(0, before.size()) == before);
    CHECK(text.substr(text.size() - after.size()) == after);
}

TEST_CASE("write_scene_camera: adds a camera behind all else", "[io]") {
    const std::string before = R"({"hemi": 1, "materials": {"m": {"reflectance": 0.5}}, )" + surfaces;
    const Folder folder;
    const auto path = folder.write("scene.json", before + "\n}\n");
    io::write_scene_camera(path, camera());
    Diagnostics diagnostics;
    check_same(io::read_scene(path, {}, diagnostics).camera);
    CHECK(io::read_file(path).substr(0, before.size()) == before);
    io::write_scene_camera(path, camera());
    check_same(io::read_scene(path, {}, diagnostics).camera);
}

TEST_CASE("write_scene_camera: refuses what is no JSON scene, and leaves it alone", "[io]") {
    const Folder folder;
    const auto broken = folder.write("broken.json", R"({"hemi": 1, )");
    CHECK_THROWS_AS(io::write_scene_camera(broken, camera()), ParseError);
    CHECK(io::read_file(broken) == R"({"hemi": 1, )");
    CHECK_THROWS_AS(io::write_scene_camera(folder.write("list.json", "[1]"), camera()), InputError);
    CHECK_THROWS_AS(io::write_scene_camera(folder.write("scene.obj", "v 0 0 0\n"), camera()),
                    InvalidArgument);
    CHECK_THROWS_AS(io::write_scene_camera("/nowhere/scene.json", camera()), InputError);
}

TEST_CASE("write_scene_materials: replaces values of materials and nothing else", "[io]") {
    const std::string before = R"({"hemi": 1, "channels": ["a", "b"],
  "materials": {"m": {"reflectance" :)";
    const std::string middle = R"(}, "lamp": {"reflectance": 0.25})";
    const std::string after = "},\n  " + surfaces + "}\n";
    const Folder folder;
    const auto path = folder.write("scene.json", before + "[0.5,  0.5]" + middle + after);
    const std::vector<io::MaterialValues> values{{"m", {0.125, 0.75}, {}}, {"lamp", {}, {3.5, 3.5}}};
    io::write_scene_materials(path, values, std::vector{1.0, 2.0});
    const std::string text = io::read_file(path);
    CHECK(text.substr(0, before.size()) == before);
    CHECK(text.find("\"lamp\": {\"reflectance\": 0.25, \"exitance\": [3.5, 3.5]}") != std::string::npos);
    Diagnostics diagnostics;
    const Scene scene = io::read_scene(path, {}, diagnostics);
    REQUIRE(scene.materials.size() == 2);
    for (const Material& material : scene.materials) {
        const bool lamp = material.name == "lamp";
        CHECK(material.reflectance == (lamp ? std::vector{0.25, 0.25} : std::vector{0.125, 0.75}));
        CHECK(material.exitance == (lamp ? std::vector{3.5, 3.5} : std::vector{0.0, 0.0}));
    }
    CHECK(scene.environment == std::vector{1.0, 2.0});
    io::write_scene_materials(path, {}, std::vector{4.0, 4.0}); // in place of that
    CHECK(io::read_scene(path, {}, diagnostics).environment == std::vector{4.0, 4.0});

    const std::string kept = io::read_file(path);
    const std::vector<io::MaterialValues> unknown{{"gold", {0.5, 0.5}, {}}};
    CHECK_THROWS_AS(io::write_scene_materials(path, unknown, {}), InvalidArgument);
    CHECK(io::read_file(path) == kept);
    const auto warm = folder.write("warm.json", R"({"hemi": 1, "materials": {"m": {"emissivity": 0.5}}, )" +
                                                    surfaces + "}");
    CHECK_THROWS_AS(io::write_scene_materials(warm, std::vector<io::MaterialValues>{{"m", {0.5}, {}}}, {}),
                    InvalidArgument);

    // Lists say how many channels there are; and what could not be read again is not written.
    const auto coloured = folder.write(
        "coloured.json",
        R"({"hemi": 1, "materials": {"m": {"reflectance": [0.1, 0.2, 0.3]}}, )" + surfaces + "}");
    io::write_scene_materials(coloured, std::vector<io::MaterialValues>{{"m", {0.5, 0.5, 0.5}, {}}}, {});
    CHECK(io::read_scene(coloured, {}, diagnostics).channels.size() == 3);
    std::string lit = surfaces;
    lit.insert(lit.find("\"material\""), "\"luminous_flux\": 100, ");
    const std::string lumens = R"({"hemi": 1, "materials": {"m": {"reflectance": 0.5}}, )" + lit + "}";
    const auto lamp = folder.write("lamp.json", lumens);
    REQUIRE(io::read_scene(lamp, {}, diagnostics).photometric);
    CHECK_THROWS_WITH(io::write_scene_materials(lamp, std::vector<io::MaterialValues>{{"m", {}, {50.0}}}, {}),
                      Catch::Matchers::Contains("lamp.json: not written") &&
                          Catch::Matchers::Contains("luminous flux"));
    CHECK(io::read_file(lamp) == lumens);
    for (const auto& entry : std::filesystem::directory_iterator(lamp.parent_path())) {
        CHECK(entry.path().extension() == ".json");
        CHECK_FALSE(entry.path().filename().string().starts_with("."));
    }
}
