#include "cli/program.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <sstream>

using namespace hemi::cli_test;

namespace {

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line);
    }
    return lines;
}

// Opposite and adjacent faces of a unit cube.
constexpr double opposite = 0.199824896;
constexpr double adjacent = 0.200043776;

} // namespace

TEST_CASE("factors: the unit cube by group agrees with the closed form", "[cli]") {
    const Directory directory;
    const Outcome run = run_hemi({"factors", directory.write("cube.json", cube(8)), "--by-group", "--json",
                                  "--device", "osmesa", "--jobs", "2", "--resolution", "256"});
    REQUIRE(run.status == 0);
    const Json factors = run.json();
    CHECK(factors["schema"] == "hemi/factors-by-group/1");
    CHECK(factors["renderer"].is_string());
    CHECK(factors["patches"] == 384);
    CHECK(factors["groups"] == Json({"floor", "left", "right", "front", "back", "ceiling"}));
    REQUIRE(factors["areas"].size() == 6);
    REQUIRE(factors["factors"].size() == 6);
    REQUIRE(factors["environment"].size() == 6);
    for (std::size_t g = 0; g < 6; ++g) {
        REQUIRE(factors["factors"][g].size() == 6);
        CHECK(factors["areas"][g].get<double>() == Approx(1.0));
        CHECK(factors["environment"][g] == 0.0);
        CHECK(factors["factors"][g][g] == 0.0);
    }
    CHECK(factors["factors"][0][5].get<double>() == Approx(opposite).margin(3e-3));
    CHECK(factors["factors"][0][1].get<double>() == Approx(adjacent).margin(3e-3));
    CHECK(factors["factors"][3][4].get<double>() == Approx(opposite).margin(3e-3));
    CHECK(factors["row_sum"]["mean"].get<double>() == Approx(1.0).margin(1e-4));
    CHECK(factors["seconds"]["total"] > 0.0);
}

TEST_CASE("factors: by group as a table, and as CSV with names", "[cli]") {
    const Directory directory;
    Json scene = cube(2);
    scene["surfaces"][1]["name"] = "left, \"tiled\"";
    const std::string path = directory.write("cube.json", scene);
    const Outcome table = run_hemi(quick({"factors", path, "--by-group"}));
    CHECK(table.status == 0);
    CHECK(table.out_has("F from / to"));
    CHECK(table.out_has("(environment)"));
    CHECK(lines_of(table.out).size() == 7);

    const Outcome file = run_hemi(quick({"factors", path, "--by-group", "-o", directory.path("a.csv")}));
    CHECK(file.status == 0);
    const auto lines = lines_of(directory.read("a.csv"));
    REQUIRE(lines.size() == 7);
    CHECK(lines[0] ==
          "group,area,floor,\"left, \"\"tiled\"\"\",right,front,back,ceiling,environment,blocked");
    CHECK(lines[2].rfind("\"left, \"\"tiled\"\"\",1,0.", 0) == 0);
    CHECK(run_hemi(quick({"factors", path, "--by-group", "-o", "-"})).out == directory.read("a.csv"));
}

TEST_CASE("factors: one row, largest first, from a scene or from a file", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    const Outcome text = run_hemi(quick({"factors", scene, "--row", "0"}));
    CHECK(text.status == 0);
    CHECK(text.out_has("what leaves patch 0 (floor, at 0.25 0.25 0)"));
    CHECK(text.out_has("ceiling"));

    const Json row = run_hemi(quick({"factors", scene, "--row", "0", "--json"})).json();
    CHECK(row["row"] == 0);
    CHECK(row["group"] == "floor");
    double sum = 0.0;
    double last = 1.0;
    for (const Json& entry : row["entries"]) {
        CHECK(entry["factor"] <= last);
        last = entry["factor"];
        sum += last;
        CHECK(entry["group"] != "floor");
    }
    CHECK(sum == Approx(1.0).margin(1e-6));
    CHECK(row["sum"].get<double>() == Approx(sum));

    const std::string file = directory.path("a.hff");
    REQUIRE(run_hemi(quick({"factors", scene, "-o", file})).status == 0);
    const Json stored = run_hemi({"factors", file, "--row", "0", "--json"}).json();
    CHECK(stored["entries"] == row["entries"]);
    const Json groups = run_hemi({"factors", file, "--by-group", "--json"}).json();
    CHECK(groups["factors"] == run_hemi(quick({"factors", scene, "--by-group", "--json"})).json()["factors"]);

    CHECK(run_hemi(quick({"factors", scene, "--row", "24"})).status == 2);
    CHECK(run_hemi({"factors", file, "--row", "24"}).status == 2);
    CHECK(run_hemi({"factors", file}).status == 2);
    const Outcome refused = run_hemi({"factors", file, "--row", "1", "--resolution", "64"});
    CHECK(refused.status == 2);
    CHECK(refused.err_has("--resolution does not apply to"));
}

TEST_CASE("factors: the summary, patches and formats", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    const Outcome summary = run_hemi(quick({"factors", scene, "--patches", directory.path("p.csv")}));
    CHECK(summary.status == 0);
    CHECK(summary.out_has("24 patches"));
    CHECK(summary.out_has("row sums"));
    const auto patches = lines_of(directory.read("p.csv"));
    REQUIRE(patches.size() == 25);
    CHECK(patches[0] == "index,group,area,cx,cy,cz,nx,ny,nz,environment");
    CHECK(patches[1].starts_with("0,floor,0.25,0.25,0.25,0,0,0,1,"));
    // Where the ceiling is missing, what it would get is the environment's: the mean over the floor.
    REQUIRE(run_hemi({"factors", directory.write("open.json", open_cube(2, "open")), "--patches",
                      directory.path("open.csv"), "--device", "cpu"})
                .status == 0);
    double sky = 0.0;
    for (const std::string& line : lines_of(directory.read("open.csv"))) {
        sky +=
            line.find(",floor,") != std::string::npos ? std::stod(line.substr(line.rfind(',') + 1)) / 4 : 0.0;
    }
    CHECK(sky == Approx(0.19982).margin(1e-3));

    const Outcome csv = run_hemi(quick({"factors", scene, "-o", "-"}));
    CHECK(csv.out.rfind("i,j,F\n0,", 0) == 0);
    CHECK(csv.err_has("24 patches"));
    const Json json = run_hemi(quick({"factors", scene, "--json"})).json();
    CHECK(json["entries"] == lines_of(csv.out).size() - 1);
    for (const char* name : {"a.hff", "a.mtx", "a.csv", "a.npz"}) {
        CHECK(run_hemi(quick({"factors", scene, "-o", directory.path(name)})).status == 0);
        CHECK(directory.has(name));
    }
    CHECK(directory.read("a.csv") == csv.out);
}

TEST_CASE("convert: form factors keep their values through every format", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    REQUIRE(run_hemi(quick({"factors", scene, "-o", directory.path("a.hff")})).status == 0);
    const auto convert = [&directory](const std::string& from, const std::string& to) {
        return run_hemi({"convert", directory.path(from), directory.path(to)});
    };
    const Outcome lossy = convert("a.hff", "a.csv");
    CHECK(lossy.status == 0);
    CHECK(lossy.err_has("areas, group names, row balance"));
    CHECK(convert("a.csv", "b.mtx").status == 0);
    CHECK(convert("b.mtx", "c.npz").status == 0);
    CHECK(convert("c.npz", "d.csv").err.empty());
    CHECK(directory.read("d.csv") == directory.read("a.csv"));
    CHECK(convert("a.hff", "e.npz").status == 0);
    CHECK(directory.read("e.npz") == directory.read("c.npz"));
    CHECK(convert("a.hff", "f.hff").status == 0);
    CHECK(directory.read("f.hff") == directory.read("a.hff"));
    CHECK(run_hemi({"convert", directory.path("b.mtx"), "-"}).out == directory.read("a.csv"));

    const Outcome refused = convert("a.csv", "g.hff");
    CHECK(refused.status == 2);
    CHECK(refused.err_has("areas, names"));
    CHECK_FALSE(directory.has("g.hff"));
    CHECK(convert("a.csv", "g.txt").status == 2);
    CHECK(convert("missing.csv", "g.npz").status == 3);
    const Json report =
        run_hemi({"convert", directory.path("a.csv"), directory.path("h.npz"), "--json"}).json();
    CHECK(report["patches"] == 24);
    for (const char* name : {"a.hff", "a.csv", "b.mtx", "c.npz"}) {
        const Json info = run_hemi({"info", directory.path(name), "--json"}).json();
        CHECK(info["kind"] == "factors");
        CHECK(info["patches"] == 24);
        CHECK(info["row_sum"]["mean"].get<double>() == Approx(1.0).margin(1e-6));
    }
}

TEST_CASE("info: what a scene holds and what it would cost", "[cli]") {
    const Directory directory;
    Json scene = cube(3);
    scene["patch_size"] = 0.5;
    scene["surfaces"].push_back({{"name", "sail"},
                                 {"material", "white"},
                                 {"polygon", Json::parse("[[0.2,0.2,0.5],[0.8,0.2,0.5],[0.5,0.8,0.5]]")},
                                 {"two_sided", true}});
    const std::string path = directory.write("cube.json", scene);
    const Outcome text = run_hemi({"info", path});
    CHECK(text.status == 0);
    CHECK(text.out_has("1 triangle, 6 quadrilaterals"));
    CHECK(text.out_has("measured on 62 rows"));
    CHECK(text.out_has("sail"));
    const Json info = run_hemi({"info", path, "--json"}).json();
    CHECK(info["schema"] == "hemi/info/1");
    CHECK(info["kind"] == "scene");
    CHECK(info["surfaces"] == 7);
    CHECK(info["patches"] == 62);
    CHECK(info["groups"].size() == 7);
    CHECK(info["groups"][0]["name"] == "floor");
    CHECK(info["groups"][0]["surfaces"] == 1);
    CHECK(info["groups"][0]["patches"] == 9);
    CHECK(info["groups"][0]["area"].get<double>() == Approx(1.0));
    CHECK(info["materials"].size() == 2);
    CHECK(info["bounds"]["upper"] == Json({1.0, 1.0, 1.0}));
    CHECK(info["enclosure"] == "closed");
    CHECK(info["estimate"]["measured"] == true);
    CHECK(info["estimate"]["rows"] == 62);
    CHECK(info["estimate"]["entries_per_row"] > 10);
    CHECK(info["estimate"]["memory"] > 0);
    CHECK(info["estimate"]["seconds"] > 0);
    CHECK(info["estimate"]["clusters"] == false);
    double sum = 0.0;
    for (const char* stage : {"visibility", "combining pairs", "form factors", "closing rows"}) {
        INFO(stage);
        REQUIRE(info["estimate"]["stages"].contains(stage));
        CHECK(info["estimate"]["stages"][stage] >= 0.0);
        sum += info["estimate"]["stages"][stage].get<double>();
    }
    CHECK(info["estimate"]["seconds"] == sum);
    CHECK(text.out_has("combining pairs"));
    // Where pairs do not fit, far patches are seen in clusters, in one stage.
    const Json clusters = run_hemi({"info", path, "--json", "--max-memory", "20K"}).json()["estimate"];
    CHECK(clusters["clusters"] == true);
    CHECK(clusters["stages"].size() == 1);
    CHECK(clusters["seconds"] == clusters["stages"]["visibility"]);
    CHECK(run_hemi({"info", path, "--json", "--max-memory", "20K", "--clusters", "off"})
              .json()["estimate"]["clusters"] == false);
    const Json plain = run_hemi({"info", path, "--json", "--preset", "plain"}).json()["estimate"];
    CHECK(plain["stages"].size() == 1);
    CHECK(plain["stages"].contains("form factors"));
}

TEST_CASE("info: rows are measured on the device and by the method that are named", "[cli]") {
    const Directory directory;
    const std::string path = directory.write("cube.json", cube(5));
    const auto estimate = [&](const Words& options) {
        Words words{"info", path, "--json"};
        words.insert(words.end(), options.begin(), options.end());
        return Json(run_hemi(words).json()["estimate"]);
    };
    const Json cpu = estimate({"--device", "cpu", "--jobs", "1"});
    CHECK(cpu["renderer"].get<std::string>().starts_with("hemi CPU rasteriser"));
    CHECK(cpu["cores"] == 1);
    CHECK(cpu["rows"] == 64);
    CHECK(estimate({"--device", "osmesa", "--jobs", "1"})["renderer"].get<std::string>().find("llvmpipe") !=
          std::string::npos);
    const Json plain = estimate({"--device", "cpu", "--preset", "plain"});
    CHECK(plain["memory"] < cpu["memory"]); // no pairs
    CHECK(estimate({"--method", "montecarlo", "--rays", "64"})["renderer"] != cpu["renderer"]);

    const Outcome missing = run_hemi({"info", path, "--device", "egl:99"});
    CHECK(missing.status == 4);
    CHECK(missing.err_has("egl:99"));
    REQUIRE(run_hemi({"factors", path, "--preset", "plain", "-o", directory.path("a.mtx")}).status == 0);
    const Outcome file = run_hemi({"info", directory.path("a.mtx"), "--device", "cpu"});
    CHECK(file.status == 2);
    CHECK(file.err_has("--device does not apply"));
}

TEST_CASE("info: a scene whose only patch sees nothing", "[cli]") {
    const Directory directory;
    const std::string path = directory.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Outcome run = run_hemi({"info", path});
    CHECK(run.status == 0);
    CHECK(run.out_has("measured on 1 row,"));
    CHECK(run_hemi({"info", path, "--json"}).json()["estimate"]["entries_per_row"] == 0.0);
}

TEST_CASE("OBJ: --two-sided and --strict", "[cli]") {
    const Directory directory;
    const std::string path = directory.write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\n"
                                                      "o sheet\nf 1 2 3 4\no sliver\nf 1 2 5\n");
    CHECK(run_hemi({"info", path, "--strict"}).status == 3);
    const Outcome skipped = run_hemi({"info", path, "--json"});
    CHECK(skipped.status == 0);
    CHECK(skipped.err_has("warning"));
    CHECK(skipped.json()["patches"] == 1);
    CHECK(run_hemi({"info", path, "--two-sided", "sheet", "--json"}).json()["patches"] == 2);
    CHECK(run_hemi({"info", path, "--two-sided", "sheep"}).err_has("did you mean"));
    CHECK(run_hemi({"info", path, "--patches-per-face", "5", "--json"}).json()["patches"] == 9);
    const std::string json = directory.write("cube.json", cube(2));
    CHECK(run_hemi({"info", json, "--two-sided", "floor"}).status == 2);
}
