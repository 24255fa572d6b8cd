#include "cli/program.hpp"
#include "support/png.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>
#include <vector>

using namespace hemi::cli_test;

namespace {

Words on_cpu(Words words) {
    words.insert(words.end(), {"--device", "cpu", "--jobs", "1"});
    return words;
}

Json wall(const std::string& name, const std::string& material, const Json& polygon) {
    return face(name, material, polygon, 1);
}

/// The cube [-1, 1]³ from inside, one group and one patch a wall.
Json walls(const std::string& material) {
    return Json::array({wall("z0", material, {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}),
                        wall("z1", material, {{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}}),
                        wall("x0", material, {{-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}, {-1, -1, 1}}),
                        wall("x1", material, {{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}),
                        wall("y0", material, {{-1, -1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, -1, -1}}),
                        wall("y1", material, {{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}})});
}

const std::vector<std::pair<std::string, double>> wall_kelvin{{"z0", 290.0}, {"z1", 330.0}, {"x0", 295.0},
                                                              {"x1", 300.0}, {"y0", 305.0}, {"y1", 285.0}};

/// Black walls of six temperatures.
Json warm_cube() {
    Json groups = Json::object();
    for (const auto& [name, kelvin] : wall_kelvin) {
        groups[name] = {{"temperature", kelvin}};
    }
    return {{"hemi", 1},
            {"materials", {{"black", {{"emissivity", 1}}}}},
            {"surfaces", walls("black")},
            {"groups", groups},
            {"enclosure", "closed"}};
}

/// A street of width 2 between walls 2 high that reflect nothing, under a sky of 100.
Json street() {
    return {{"hemi", 1},
            {"channels", {"day"}},
            {"materials", {{"dark", {{"reflectance", 0}}}, {"road", {{"reflectance", 0.5}}}}},
            {"surfaces",
             {wall("left", "dark", {{0, -900, 0}, {0, 900, 0}, {0, 900, 2}, {0, -900, 2}}),
              wall("right", "dark", {{2, 900, 0}, {2, -900, 0}, {2, -900, 2}, {2, 900, 2}}),
              wall("road", "road", {{0, -900, 0}, {2, -900, 0}, {2, 900, 0}, {0, 900, 0}})}},
            {"environment", {{"exitance", 100}}}};
}

std::vector<Words> lines_of(const std::string& csv) {
    std::vector<Words> lines;
    std::istringstream stream(csv);
    for (std::string line; std::getline(stream, line);) {
        Words& cells = lines.emplace_back();
        std::istringstream rest(line);
        for (std::string cell; std::getline(rest, cell, ',');) {
            cells.push_back(cell);
        }
        if (line.ends_with(',')) {
            cells.emplace_back();
        }
    }
    return lines;
}

} // namespace

TEST_CASE("hemi points: mean radiant temperature in a cube of six temperatures", "[cli][points]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", warm_cube());
    const std::string points = directory.write("points.csv", "z,x,y\n0,0,0\n");
    const Outcome run = run_hemi(on_cpu({"points", scene, "--points", points, "--json", "--by-group"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json json = run.json();

    CHECK(json["schema"] == "hemi/points/1");
    CHECK(json["points"] == Json({{0.0, 0.0, 0.0}}));
    CHECK(json["normals"] == Json::array({nullptr}));
    double mean = 0.0;
    for (const auto& [name, kelvin] : wall_kelvin) {
        mean += std::pow(kelvin, 4.0) / 6.0;
    }
    CHECK(json["mean_radiant_temperature"][0].get<double>() == Approx(std::pow(mean, 0.25)).margin(1e-4));
    CHECK(json["plane_radiant_temperature"][0].is_null());
    CHECK(json["irradiance"][0][0].get<double>() == Approx(5.670374419e-8 * mean).epsilon(1e-5));
    CHECK(json["groups"].size() == 6);
    CHECK(json["factors"][0][3].get<double>() == Approx(1.0 / 6.0).margin(1e-6));
    CHECK_FALSE(json.contains("posture"));

    const Outcome person = run_hemi(on_cpu(
        {"points", scene, "--points", points, "--person", "seated", "--facing", "90", "-o", "-", "-q"}));
    REQUIRE(person.status == 0);
    const auto lines = lines_of(person.out);
    REQUIRE(lines.size() == 2);
    REQUIRE(lines[0].size() == 14);
    CHECK(lines[0][6] == "blocked");
    CHECK(lines[0][7] == "mean_radiant_temperature");
    CHECK(lines[0][12] == "plane_front");
    const auto kelvin = [&](std::size_t column) { return std::stod(lines[1][column]); };
    CHECK(kelvin(7) == Approx((0.18 * (kelvin(8) + kelvin(9)) + 0.22 * (kelvin(10) + kelvin(11)) +
                               0.30 * (kelvin(12) + kelvin(13))) /
                              1.40)
                           .epsilon(1e-9));
    CHECK(kelvin(8) > kelvin(9));                              // the warm ceiling
    CHECK(kelvin(12) - kelvin(13) == Approx(2.0).margin(1.0)); // it faces +x, which is 5 K warmer
}

TEST_CASE("hemi points: sky view factor and irradiance in a street, of a scene and of its solution",
          "[cli][points]") {
    const Directory directory;
    const std::string scene = directory.write("street.json", street());
    const std::string points =
        directory.write("points.csv", "x,y,z,nx,ny,nz\n1,0,0,0,0,5\n1,0,0.5,,,\n1,0,-3,0,0,-1\n");
    const Outcome run = run_hemi(
        on_cpu({"points", scene, "--points", points, "-o", directory.path("out.csv"), "--preset", "fast"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const auto lines = lines_of(directory.read("out.csv"));
    REQUIRE(lines.size() == 4);
    CHECK(lines[0] ==
          Words{"x", "y", "z", "nx", "ny", "nz", "irradiance_day", "sky", "below_horizon", "blocked"});
    const double sky = std::cos(std::atan(2.0));
    CHECK(lines[1][5] == "1");
    CHECK(std::stod(lines[1][7]) == Approx(sky).margin(1e-4));
    CHECK(std::stod(lines[1][6]) == Approx(100.0 * sky).margin(1e-2));
    CHECK(lines[2][3].empty());
    // A sphere between half planes: the angle that is open, over the full circle.
    CHECK(std::stod(lines[2][7]) == Approx(std::atan(1.0 / 1.5) / std::numbers::pi).margin(1e-3));
    CHECK(lines[3][8] == "1"); // below everything, and looking down
    CHECK(lines[3][6] == "100");

    REQUIRE(run_hemi(on_cpu({"solve", scene, "--result", directory.path("street.hres"), "--preset", "fast",
                             "--no-estimate", "-q"}))
                .status == 0);
    const Outcome again = run_hemi(on_cpu(
        {"points", directory.path("street.hres"), "--points", points, "-o", "-", "--preset", "fast", "-q"}));
    INFO(again.err);
    REQUIRE(again.status == 0);
    const auto stored = lines_of(again.out);
    REQUIRE(stored.size() == lines.size());
    for (std::size_t row = 1; row < lines.size(); ++row) {
        CHECK(std::stod(stored[row][6]) == Approx(std::stod(lines[row][6])).epsilon(1e-5));
        CHECK(stored[row][7] == lines[row][7]);
    }
}

TEST_CASE("hemi points: faces under a grid are cut as the command line says, also where others touch them",
          "[cli][points]") {
    const Directory directory;
    Json room = cube(1);
    for (Json& surface : room["surfaces"]) {
        surface.erase("patches");
    }
    room["patch_size"] = 1e-5; // more patches than there may be
    room["surfaces"].push_back(
        {{"name", "post"},
         {"material", "white"},
         {"two_sided", true},
         {"polygon", Json::parse("[[0.5,0.2,0],[0.5,0.8,0],[0.5,0.8,0.5],[0.5,0.2,0.5]]")}});
    const Outcome run =
        run_hemi(on_cpu({"points", directory.write("room.json", room), "--patch-size", "0.5", "--grid",
                         "floor", "0.4", "0.2", "--preset", "fast", "-o", directory.path("grid.csv")}));
    INFO(run.err);
    CHECK(run.status == 0);
    CHECK(directory.has("grid.csv"));
}

TEST_CASE("hemi points: a grid as table, for ParaView and as a map", "[cli][points]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", warm_cube());
    const Words grid = on_cpu({"points", scene, "--grid", "z0", "0.5", "0.8", "--preset", "fast"});
    const auto with = [&grid](Words more) {
        more.insert(more.begin(), grid.begin(), grid.end());
        return run_hemi(more);
    };
    const Outcome printed = with({});
    REQUIRE(printed.status == 0);
    CHECK(printed.out_has("plane_radiant_temperature"));
    CHECK(lines_of(printed.out).size() > 18);
    const Outcome map = with({"-o", directory.path("map.png"), "--show", "mean_radiant_temperature",
                              "--spheres", "--json", "--range", "290,320"});
    INFO(map.err);
    REQUIRE(map.status == 0);
    CHECK(map.json()["map"]["column"] == "mean_radiant_temperature");
    CHECK(map.json()["map"]["range"] == Json({290.0, 320.0}));
    CHECK(map.json()["map"]["unit"] == "K");
    CHECK(hemi::test::read_png(directory.path("map.png")).width > 4 * 32); // the legend's
    const Outcome bare = with({"-o", directory.path("map.png"), "--no-legend", "-q"});
    REQUIRE(bare.status == 0);
    CHECK(hemi::test::read_png(directory.path("map.png")).width == 4 * 32);
    CHECK(hemi::test::read_png(directory.path("map.png")).height == 4 * 32);
    CHECK(with({"-o", directory.path("grid.vtp"), "--no-legend"}).status == 2);
    REQUIRE(
        run_hemi(on_cpu({"solve", scene, "--preset", "fast", "--result", directory.path("a.hres")})).status ==
        0);
    CHECK(run_hemi({"points", directory.path("a.hres"), "--grid", "z0", "0.5", "0.8", "--preset", "fast",
                    "-q", "-o", directory.path("stored.png"), "--no-legend"})
              .status == 0);
    const Outcome vtp = with({"-o", directory.path("grid.vtp"), "-q"});
    REQUIRE(vtp.status == 0);
    const std::string file = directory.read("grid.vtp");
    CHECK(file.find("NumberOfPoints=\"16\" NumberOfVerts=\"16\"") != std::string::npos);
    CHECK(file.find("Name=\"plane_radiant_temperature\"") != std::string::npos);
    CHECK(with({"-o", directory.path("map.png"), "--show", "skye"}).err_has("did you mean"));
    CHECK(with({"--show", "sky"}).status == 2);
    CHECK(with({"-o", directory.path("map.png"), "--range", "3,3"}).status == 2);
    CHECK(with({"--person", "standing"}).err_has("--spheres"));
}

TEST_CASE("hemi points: what is not right is said, with its place", "[cli][points]") {
    const Directory directory;
    const std::string scene = directory.write("street.json", street());
    const auto with_table = [&](const std::string& text, Words more = {}) {
        Words words{"points", scene, "--points", directory.write("points.csv", text)};
        words.insert(words.end(), more.begin(), more.end());
        return run_hemi(on_cpu(words));
    };
    const Outcome word = with_table("x,y,z\n0,0,0\n1,two,3\n");
    CHECK(word.status == 3);
    CHECK(word.err_has("points.csv:3: y two"));
    CHECK(with_table("x,y,z,nx,ny\n").err_has("no column \"nz\""));
    CHECK(with_table("x,y,w\n").err_has("unknown column \"w\""));
    CHECK(with_table("x,y,z,x\n").err_has("two columns \"x\""));
    CHECK(with_table("nx,ny,nz\n").err_has("no columns x, y, z"));
    CHECK(with_table("x,y,z\n").err_has("no points"));
    CHECK(with_table("x,y,z,nx,ny,nz\n0,0,0,0,0,0\n").err_has("a normal of length 0"));
    const Outcome person = with_table("x,y,z\n1,0,1\n", {"--person", "standing"});
    CHECK(person.status == 2);
    CHECK(person.err_has("needs temperatures"));
    CHECK(with_table("x,y,z\n1,0,1\n", {"--emissivity", "road=0.9"}).status == 2);
    CHECK(with_table("x,y,z\n1,0,1\n", {"--facing", "3"}).status == 2);
    CHECK(with_table("x,y,z\n1,0,1\n", {"-o", directory.path("map.png")}).err_has("--grid"));
    CHECK(with_table("x,y,z\n1,0,1\n", {"-o", directory.path("points.csv")}).status == 2);
    CHECK(run_hemi({"points", scene}).status == 2);
    const Outcome group = run_hemi({"points", scene, "--grid", "roads", "1", "1"});
    CHECK(group.status == 2);
    CHECK(group.err_has("road"));
    CHECK(run_hemi({"points", scene, "--grid", "road", "0", "1"}).status == 2);
    CHECK(run_hemi({"points", directory.path("points.csv"), "--points", scene}).err_has("needs a scene"));
}

TEST_CASE("hemi points -q: the table alone", "[cli][points]") {
    const Directory directory;
    const Outcome run = run_hemi(on_cpu({"points", directory.write("street.json", street()), "--points",
                                         directory.write("points.csv", "x,y,z\n1,0,1\n"), "-q"}));
    REQUIRE(run.status == 0);
    CHECK(run.err.empty());
    CHECK(run.out.starts_with("x "));
    CHECK(run.out_has("sky"));
    CHECK(std::count(run.out.begin(), run.out.end(), '\n') == 2);
}

TEST_CASE("hemi points: inside of a body it warns", "[cli][points]") {
    const Directory directory;
    Json scene = street();
    std::swap(scene["surfaces"][0]["polygon"][1], scene["surfaces"][0]["polygon"][3]);
    std::swap(scene["surfaces"][1]["polygon"][1], scene["surfaces"][1]["polygon"][3]);
    const Outcome run =
        run_hemi(on_cpu({"points", directory.write("street.json", scene), "--points",
                         directory.write("points.csv", "x,y,z,nx,ny,nz\n1,0,0.1,1,0,0\n"), "--json"}));
    REQUIRE(run.status == 0);
    CHECK(run.err_has("1 point sees mostly backs"));
    CHECK(run.json()["blocked"][0] > 0.49);
}
