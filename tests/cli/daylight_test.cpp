#include "cli/program.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <sstream>

using namespace hemi::cli_test;

namespace {

Words on_cpu(Words words) {
    words.insert(words.end(), {"--device", "cpu", "--jobs", "1"});
    return words;
}

/// The unit cube without its ceiling, whose walls have an exitance of 1, under a sky.
Json court(const Json& environment) {
    Json scene = open_cube(4, "open");
    scene["environment"] = environment;
    return scene;
}

const Json overcast{{"sky", "overcast"}, {"horizontal_illuminance", 8000}};

std::string first_line(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

} // namespace

TEST_CASE("hemi points --daylight: daylight factors of the sky alone", "[cli][points][sky]") {
    const Directory directory;
    Json scene = court(overcast);
    scene["materials"]["white"]["exitance"] = 500;
    scene["sun"] = {{"direction", {0, 0, 1}}, {"normal_illuminance", 50000}};
    const std::string file = directory.write("court.json", scene);
    const std::string points =
        directory.write("points.csv", "x,y,z,nx,ny,nz\n0.5,0.5,9,0,1,0\n0.5,0.5,9,0,0,1\n"
                                      "0.5,0.5,0.5,0,0,1\n");
    const Outcome run = run_hemi(on_cpu({"points", file, "--points", points, "--daylight", "--json"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json json = run.json();
    CHECK(json["unit"] == "lx");
    CHECK(json["horizontal"] == Json::array({8000.0}));
    const auto factor = [&](std::size_t k) { return json["daylight_factor"][k][0].get<double>(); };
    CHECK(factor(0) == Approx(100.0 * (3.0 / 14.0 + 4.0 / (7.0 * std::numbers::pi))).epsilon(1e-4));
    CHECK(factor(1) == Approx(100.0).epsilon(1e-6));
    CHECK(factor(2) > 30.0);
    CHECK(factor(2) < 80.0);
    CHECK(json["irradiance"][1][0].get<double>() == Approx(8000.0));
    // A table has it by name.
    const std::string table = directory.path("df.csv");
    REQUIRE(run_hemi(on_cpu({"points", file, "--points", points, "--daylight", "-o", table})).status == 0);
    CHECK_THAT(first_line(directory.read("df.csv")), Catch::Contains("irradiance_grey,daylight_factor,sky"));

    const Outcome none = run_hemi(on_cpu(
        {"points", directory.write("dark.json", open_cube(2, "open")), "--points", points, "--daylight"}));
    CHECK(none.status == 3);
    CHECK(none.err_has("needs a sky"));
    const Outcome warm =
        run_hemi(on_cpu({"points", file, "--points", points, "--daylight", "--temperature", "floor=300"}));
    CHECK(warm.status == 2);
    CHECK(warm.err_has("--daylight"));
}

TEST_CASE("hemi solve: sun and sky are reported apart, and stored", "[cli][solve][sky][sun]") {
    const Directory directory;
    Json scene = court({{"sky", "overcast"}, {"horizontal_irradiance", 200}, {"ground", 0.1}});
    scene["sun"] = {{"azimuth", 180}, {"elevation", 60}, {"normal_irradiance", 800}};
    const std::string file = directory.write("court.json", scene);
    const std::string result = directory.path("court.hres");
    const Outcome run = run_hemi(
        on_cpu({"solve", file, "--result", result, "--radiosity", directory.path("court.csv"), "--json"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    CHECK_FALSE(run.err_has("nothing radiates"));
    const Json json = run.json();
    CHECK(json["photometric"] == false);
    CHECK(json["balance"]["emitted"] == 5.0); // each of its five walls
    const double coming = -json["balance"]["environment"].get<double>();
    CHECK(coming > 0.0);
    CHECK(coming + 5.0 == Approx(json["balance"]["absorbed"].get<double>()).epsilon(1e-5));
    CHECK(coming < 200.0 + 800.0 * std::sin(std::numbers::pi / 3.0));
    CHECK_THAT(first_line(directory.read("court.csv")), Catch::Contains(",direct_grey,"));
    CHECK_FALSE(json["error_estimate"].is_null());
    const double error = json["error"]["vertices"]["rms"];
    CHECK(error > 0.02); // shadows of patches a third of the court wide

    const std::string points = directory.write(
        "points.csv", "x,y,z,nx,ny,nz\n0.5,0.8,0.2,0,0,1\n0.5,0.1,0.2,0,0,1\n0.5,0.5,2,0,-1,0\n");
    const Words words{"--points", points, "--json", "--preset", "fast"};
    Words of_scene{"points", file};
    Words of_result{"points", result};
    of_scene.insert(of_scene.end(), words.begin(), words.end());
    of_result.insert(of_result.end(), words.begin(), words.end());
    const Json a = run_hemi(on_cpu(of_scene)).json();
    const Json b = run_hemi(on_cpu(of_result)).json();
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(a["irradiance"][k][0].get<double>() ==
              Approx(b["irradiance"][k][0].get<double>()).epsilon(0.02));
    }
    // The sun is in the south: its beam ends at the north of the floor, where nothing hides it.
    CHECK(a["irradiance"][0][0].get<double>() > 692.0);
    CHECK(a["irradiance"][1][0].get<double>() < 600.0);
    CHECK(a["irradiance"][2][0].get<double>() > 400.0);

    // Patches are cut where shadows end, which takes fewer than a finer grid does.
    const auto error_by = [&](const char* option, const char* value) {
        const Outcome of = run_hemi(on_cpu({"solve", file, "--json", option, value}));
        INFO(of.err);
        REQUIRE(of.status == 0);
        return std::pair{of.json()["error"]["vertices"]["rms"].get<double>(),
                         of.json()["patches"].get<int>()};
    };
    const auto [cut, patches] = error_by("--refine", "800");
    const auto [even, more] = error_by("--patch-size", "0.0625");
    INFO(patches << " patches: " << cut << "; " << more << " patches: " << even);
    CHECK(cut < even);
    CHECK(patches < more);
    const Outcome picture =
        run_hemi(on_cpu({"solve", file, "-o", directory.path("court.png"), "--size", "64x64"}));
    CHECK(picture.status == 0);
}

TEST_CASE("hemi solve: the sky lights black surfaces, too", "[cli][solve][sky]") {
    const Directory directory;
    Json scene = court(overcast);
    for (Json& material : scene["materials"]) {
        material = {{"reflectance", 0}};
    }
    const std::string file = directory.write("black.json", scene);
    const Outcome run = run_hemi(on_cpu({"solve", file, "--json", "--patches", directory.path("p.csv")}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    CHECK_FALSE(run.err_has("nothing radiates"));
    const Json solved = run.json();
    CHECK(solved["balance"]["absorbed"].get<double>() == Approx(8000.0).epsilon(1e-3));
    for (const Json& group : solved["light"]) {
        CHECK(group["irradiance"].get<double>() > 100.0);
    }
    CHECK(directory.read("p.csv").find(",\n") == std::string::npos); // no empty cell at the end of a line
}

TEST_CASE("hemi solve: lumens are what a lamp gives", "[cli][solve][daylight]") {
    const Directory directory;
    Json scene = cube(6); // 1 m: an integrating cube, whose mean illuminance is flux / (area (1 - rho))
    scene["materials"]["lamp"] = {{"reflectance", 0.5}};
    scene["groups"] = {{"ceiling", {{"luminous_flux", 3000}}}};
    const std::string file = directory.write("cube.json", scene);
    const Outcome run = run_hemi(on_cpu({"solve", file, "--json"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json json = run.json();
    CHECK(json["photometric"] == true);
    CHECK(json["balance"]["emitted"].get<double>() == Approx(3000.0));
    double mean = 0.0; // B = E + rho H, all areas 1
    for (std::size_t g = 0; g < 6; ++g) {
        mean += (json["radiosity"][g][0].get<double>() - json["exitance"][g][0].get<double>()) / 0.5 / 6.0;
    }
    CHECK(mean == Approx(3000.0 / (6.0 * 0.5)).epsilon(1e-4));
    // One of 4 m with 10,000 lm: the mean illuminance, the lamp's first bounce and all.
    for (const auto& [reflectance, lux] :
         {std::pair{0.0, 104.17}, std::pair{0.2, 130.21}, std::pair{0.5, 208.33}, std::pair{0.8, 520.83}}) {
        Json large = cube(4);
        for (Json& surface : large["surfaces"]) {
            for (Json& corner : surface["polygon"]) {
                for (Json& coordinate : corner) {
                    coordinate = 4.0 * coordinate.get<double>();
                }
            }
        }
        for (auto& [name, material] : large["materials"].items()) {
            material = {{"reflectance", reflectance}};
        }
        large["groups"] = {{"ceiling", {{"luminous_flux", 10000}}}};
        const std::string table = directory.path("cube.csv");
        const Outcome lit =
            run_hemi(on_cpu({"solve", directory.write("large.json", large), "--radiosity", table,
                             "--tolerance", "1e-10", "--preset", "fast", "--no-estimate", "-q"}));
        INFO(lit.err);
        REQUIRE(lit.status == 0);
        std::istringstream lines(directory.read("cube.csv"));
        std::string line;
        std::getline(lines, line);
        const auto column_of = [header = line](const std::string& name) {
            std::size_t column = 0;
            std::istringstream cells(header);
            for (std::string cell; std::getline(cells, cell, ',') && cell != name;) {
                ++column;
            }
            return column;
        };
        const std::size_t irradiance = column_of("irradiance_grey");
        double sum = 0.0;
        int patches = 0;
        while (std::getline(lines, line)) {
            std::istringstream cells(line);
            std::string cell;
            for (std::size_t column = 0; column <= irradiance; ++column) {
                std::getline(cells, cell, ',');
            }
            sum += std::stod(cell); // patches of one size
            ++patches;
        }
        CHECK(sum / patches == Approx(lux).epsilon(5e-5));
    }
    // Of a coloured lamp, lumens are what the shares of luminance make of its channels: not their sum.
    Json coloured = cube(2);
    coloured["channels"] = {"red", "green", "blue"};
    coloured["materials"]["lamp"] = {{"reflectance", 0.5}};
    coloured["groups"] = {{"ceiling", {{"luminous_flux", {3000, 2000, 1000}}}}};
    const Json colours =
        run_hemi(on_cpu({"solve", directory.write("colours.json", coloured), "--json"})).json();
    const double lumens = 0.2126 * 3000.0 + 0.7152 * 2000.0 + 0.0722 * 1000.0;
    CHECK(colours["balance"]["emitted"].get<double>() == Approx(lumens).epsilon(1e-12));
    CHECK(colours["balance"]["absorbed"].get<double>() == Approx(lumens).epsilon(1e-5));
    coloured["groups"]["ceiling"]["luminous_flux"] = 3000;
    CHECK(run_hemi(on_cpu({"solve", directory.write("white.json", coloured)})).out_has("emitted 3000 lm"));
    CHECK(run_hemi(on_cpu({"solve", file})).out_has("emitted 3000 lm"));
    const Outcome heat = run_hemi(on_cpu({"heat", file, "--temperature", "floor=300"}));
    CHECK(heat.status == 3);
    CHECK(heat.err_has("lumens"));
}

TEST_CASE("hemi points, solve: the sky is about the axis that --up names", "[cli][points][sky]") {
    const Directory directory;
    const Json overcast_sky{{"sky", "overcast"}, {"horizontal_irradiance", 1000}};
    const std::string court_file = directory.write("court.json", court(overcast_sky));
    const auto points = [&](const std::string& file, const Words& more) {
        Words words{"points", file, "--points", directory.path("points.csv"), "--json", "--preset", "fast"};
        words.insert(words.end(), more.begin(), more.end());
        return run_hemi(on_cpu(words));
    };
    // Far away and alone: the sky is what a plane that faces upwards gets all of.
    (void)directory.write("points.csv", "x,y,z,nx,ny,nz\n90,90,90,0,1,0\n90,90,90,0,0,1\n");
    const auto irradiance = [](const Outcome& run, std::size_t point) {
        INFO(run.err);
        REQUIRE(run.status == 0);
        return run.json()["irradiance"][point][0].get<double>();
    };
    const double wall = 1000.0 * (3.0 / 14.0 + 4.0 / (7.0 * std::numbers::pi));
    CHECK(irradiance(points(court_file, {}), 0) == Approx(wall).epsilon(1e-4));
    CHECK(irradiance(points(court_file, {}), 1) == Approx(1000.0).epsilon(1e-3));
    CHECK(irradiance(points(court_file, {"--up", "y"}), 0) == Approx(1000.0).epsilon(1e-3));
    CHECK(irradiance(points(court_file, {"--up", "y"}), 1) == Approx(wall).epsilon(1e-4));
    CHECK(points(court_file, {"--up", "y"}).json()["sky"][0] == 1.0);
    Json lying = court(overcast_sky);
    lying["up"] = "y";
    const std::string lying_file = directory.write("lying.json", lying);
    CHECK(irradiance(points(lying_file, {}), 0) == Approx(1000.0).epsilon(1e-3));
    // The court's opening is where z is 1: lying, it sees half of the sky.
    const auto incoming = [](const Outcome& run) {
        INFO(run.err);
        REQUIRE(run.status == 0);
        return -run.json()["balance"]["environment"].get<double>();
    };
    const auto solve = [&](const std::string& file, const Words& more) {
        Words words{"solve", file, "--json", "--preset", "fast"};
        words.insert(words.end(), more.begin(), more.end());
        return run_hemi(on_cpu(words));
    };
    const double upright = incoming(solve(court_file, {}));
    const double turned = incoming(solve(court_file, {"--up", "y"}));
    CHECK(turned < 0.5 * upright);
    CHECK(incoming(solve(lying_file, {})) == Approx(turned).epsilon(1e-12));
    CHECK(incoming(solve(lying_file, {"--up", "z"})) == Approx(upright).epsilon(1e-12));
    // The stored solution knows.
    const std::string result = directory.path("lying.hres");
    REQUIRE(solve(lying_file, {"--result", result}).status == 0);
    CHECK(irradiance(points(result, {}), 0) == Approx(1000.0).epsilon(1e-3));
    // Without a sky and a picture nothing depends on it.
    const Outcome unused = run_hemi({"solve", directory.write("cube.json", cube(2)), "--up", "y"});
    CHECK(unused.status == 2);
    CHECK(unused.err_has("--up"));
}
