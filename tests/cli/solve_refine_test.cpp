#include "cli/program.hpp"

#include <catch2/catch.hpp>

#include <sstream>
#include <string>

using namespace hemi::cli_test;

TEST_CASE("solve: results of cut faces are about the faces, unless their parts are asked for", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(1));
    const auto solve = [&](Words more) {
        Words words{"solve",
                    scene,
                    "--device",
                    "cpu",
                    "--refine",
                    "300",
                    "--result",
                    directory.path("a.hres"),
                    "--json",
                    "--radiosity",
                    directory.path("a.csv")};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome run = run_hemi(words);
        INFO(run.err);
        REQUIRE(run.status == 0);
        return run.json();
    };
    const auto lines = [&] {
        std::istringstream text(directory.read("a.csv"));
        std::vector<std::string> result;
        for (std::string line; std::getline(text, line);) {
            result.push_back(line);
        }
        return result;
    };
    const Json faces = solve({});
    CHECK(faces["patches"] == 6);
    CHECK(faces["parts"] >= 300);
    for (const Json& patch : faces["reciprocity"]["worst"]) {
        CHECK(patch < 6);
    }
    const Json info = run_hemi({"info", directory.path("a.hres"), "--json"}).json();
    CHECK(info["patches"] == 6);
    const std::vector<std::string> table = lines();
    REQUIRE(table.size() == 7);
    const auto radiosity = [](const std::string& line) { // column 16, of the first channel
        std::istringstream cells(line);
        std::string cell;
        for (int column = 0; column < 16; ++column) {
            std::getline(cells, cell, ',');
        }
        return std::stod(cell);
    };
    CHECK(table[0].find("irradiance_blue,radiosity_red") != std::string::npos);
    for (std::size_t face = 0; face < 6; ++face) { // every face is a group
        CHECK(radiosity(table[face + 1]) == Approx(faces["radiosity"][face][0].get<double>()).epsilon(1e-9));
    }
    const Json parts = solve({"--parts"});
    CHECK(parts["patches"] == faces["parts"]);
    CHECK(lines().size() == parts["patches"].get<std::size_t>() + 1);
    CHECK(run_hemi({"solve", scene, "--parts"}).status == 2);
}

TEST_CASE("solve --error-target: patches are cut until the estimate meets it", "[cli][slow]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(2));
    const auto solve = [&](Words more) {
        Words words{"solve", scene, "--device", "osmesa", "--jobs", "2", "--json"};
        words.insert(words.end(), more.begin(), more.end());
        return run_hemi(words);
    };
    for (const std::string of : {"vertices", "field"}) {
        INFO(of);
        const double target = of == "field" ? 0.06 : 0.005;
        const Outcome run = solve({"--error-target", of == "field" ? "6%" : "0.005", "--error-target-of", of,
                                   "--result", directory.path("a.hres"), "-o", directory.path("a.hdr"),
                                   "--patches", directory.path("a.csv"), "--size", "64x64"});
        INFO(run.err);
        REQUIRE(run.status == 0);
        const Json json = run.json();
        CHECK(json["error"][of]["rms"] <= target);
        const Json& steps = json["refinement"]["steps"];
        REQUIRE(steps.size() >= 1);
        CHECK(steps.back()["patches"] == json["patches"]);
        CHECK(json["refinement"]["stopped"] == "");
        std::uint64_t rows = 0;
        for (const Json& step : steps) {
            rows += step["rows"].get<std::uint64_t>();
        }
        CHECK(rows == json["refinement"]["rows"].get<std::uint64_t>());
        CHECK(rows < 2 * json["patches"].get<std::uint64_t>());
        // What was stored is that mesh and its light.
        const Json info = run_hemi({"info", directory.path("a.hres"), "--json"}).json();
        CHECK(info["patches"] == json["patches"]);
        REQUIRE(run_hemi({"render", directory.path("a.hres"), "--device", "osmesa", "-o",
                          directory.path("again.hdr"), "--size", "64x64", "-q"})
                    .status == 0);
        const bool same = directory.read("again.hdr") == directory.read("a.hdr");
        CHECK(same);
    }
    const Outcome number = solve({"--refine", "700"});
    REQUIRE(number.status == 0);
    CHECK(number.json()["patches"] >= 700);
    CHECK(number.json()["patches"] < 900);
    const Outcome missed =
        solve({"--error-target", "1e-9", "--refine", "450", "--radiosity", directory.path("r.csv")});
    CHECK(missed.status == 5);
    CHECK(missed.err_has("is not met"));
    CHECK(directory.has("r.csv"));
    for (const Words& wrong :
         {Words{"--budget", "1s"}, Words{"--resume", "--error-target", "1%"},
          Words{"--error-target-of", "field"}, Words{"--refine", "0"}, Words{"--error-target", "%"}}) {
        CHECK(solve(wrong).status == 2);
    }
}

TEST_CASE("solve --refine: rows of cut patches are stored, lit again, and cut further", "[cli]") {
    const Directory directory;
    Json cube_scene = coloured(2);
    const std::string scene = directory.write("cube.json", cube_scene);
    const std::string rows = directory.path("a.hff");
    const auto solve = [&](Words more) {
        Words words{"solve", scene, "--device", "cpu", "--json", "--factors", rows};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome run = run_hemi(words);
        INFO(run.err);
        REQUIRE(run.status == 0);
        return run.json();
    };
    const Json first = solve({"--refine", "300"});
    const Json again = solve({});
    CHECK(again["patches"] == first["patches"]);
    CHECK(again["radiosity"] == first["radiosity"]);
    CHECK(again["error_estimate"] == first["error_estimate"]);
    // Other light by the same rows, and other commands.
    cube_scene["materials"]["white"]["reflectance"] = {0.1, 0.1, 0.1};
    directory.write("cube.json", cube_scene);
    CHECK(solve({})["radiosity"] != first["radiosity"]);
    CHECK(run_hemi({"check", rows, "-q"}).status == 0);
    directory.write("points.csv", "x,y,z\n0.5,0.5,0.5\n");
    CHECK(run_hemi({"points", scene, "--points", directory.path("points.csv"), "--factors", rows, "-q", "-o",
                    directory.path("p.csv")})
              .status == 0);
    cube_scene["materials"]["white"]["reflectance"] = {0.7, 0.5, 0.2};
    directory.write("cube.json", cube_scene);
    const Json more = solve({"--refine", "500"});
    CHECK(more["patches"] >= 500);
    CHECK(more["refinement"]["steps"][0]["patches"] == first["patches"]);
    CHECK(more["refinement"]["steps"][0]["rows"] == 0);
    CHECK(solve({})["patches"] == more["patches"]);
    // Rows of the scene's own patches do as well.
    std::filesystem::remove(rows);
    REQUIRE(solve({})["patches"] == 24);
    const Json own = solve({"--refine", "100"});
    CHECK(own["refinement"]["steps"][0]["patches"] == 24);
    CHECK(own["refinement"]["steps"][0]["rows"] == 0);
    // Rows by other settings, of another scene.
    const auto refused = [&](const Words& words) {
        const Outcome run = run_hemi(words);
        INFO(run.err);
        CHECK((run.status == 2 || run.status == 3));
        return run.err;
    };
    CHECK(refused({"solve", scene, "--factors", rows, "--refine", "200", "--seed", "5"}).find("--seed 5") !=
          std::string::npos);
    Json fewer = cube(2);
    fewer["surfaces"].erase(0);
    const std::string other = directory.write("other.json", fewer);
    CHECK(refused({"solve", other, "--factors", rows, "--refine", "200"}).find("another geometry") !=
          std::string::npos);
}

TEST_CASE("solve: light from outside reaches black groups, however patches and rows are chosen", "[cli]") {
    const Directory directory;
    Json scene = open_cube(2, "open");
    scene["materials"]["black"] = {{"reflectance", 0}};
    scene["surfaces"][0]["material"] = "black";
    scene["environment"] = {{"exitance", 10}};
    const std::string file = directory.write("open.json", scene);
    for (const Words& more : {Words{}, Words{"--refine", "600"}, Words{"--error-target", "0.3%"},
                              Words{"--error-target", "5%", "--error-target-of", "factors"}}) {
        Words words{"solve", file, "--device", "cpu"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome run = run_hemi(words);
        INFO(run.err << run.out);
        CHECK(run.status == 0);
        std::istringstream lines(run.out);
        std::string line;
        while (std::getline(lines, line) && line.rfind("floor", 0) != 0) {
        }
        std::istringstream cells(line);
        std::string group;
        double area = 0.0;
        double exitance = -1.0;
        double irradiance = 0.0;
        cells >> group >> area >> exitance >> irradiance;
        CHECK(irradiance > 0.1);
    }
}

TEST_CASE("solve: rows of a file without better ones get an estimate, unless none is wanted", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(2));
    const std::string rows = directory.path("rows.hff");
    const Words words{"solve", scene, "--device", "cpu", "--json", "--factors", rows};
    const auto solve = [&words](Words more) {
        more.insert(more.begin(), words.begin(), words.end());
        const Outcome run = run_hemi(more);
        INFO(run.err);
        REQUIRE(run.status == 0);
        return run.json();
    };
    CHECK(solve({"--eye-points", "9", "--no-estimate"})["error"].is_null());
    const Json later = solve({"-v"});
    CHECK(later["error"]["vertices"]["rms"] > 0.0);
    CHECK(later["error_estimate"].is_object());
    CHECK(solve({"--no-estimate"})["error"].is_null());
}
