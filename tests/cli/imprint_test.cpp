#include "cli/program.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

using namespace hemi::cli_test;

namespace {

/// A cube with a floor of 3 x 3 patches and a block on it, whose foot covers the middle one whole and others
/// in part.
Json cube_with_block() {
    Json scene = cube(3);
    const auto add = [&scene](const char* polygon) {
        scene["surfaces"].push_back(
            {{"name", "block"}, {"material", "white"}, {"polygon", Json::parse(polygon)}});
    };
    add("[[0.3,0.3,0.25],[0.75,0.3,0.25],[0.75,0.7,0.25],[0.3,0.7,0.25]]");
    add("[[0.3,0.3,0],[0.75,0.3,0],[0.75,0.3,0.25],[0.3,0.3,0.25]]");
    add("[[0.75,0.3,0],[0.75,0.7,0],[0.75,0.7,0.25],[0.75,0.3,0.25]]");
    add("[[0.75,0.7,0],[0.3,0.7,0],[0.3,0.7,0.25],[0.75,0.7,0.25]]");
    add("[[0.3,0.7,0],[0.3,0.3,0],[0.3,0.3,0.25],[0.3,0.7,0.25]]");
    return scene;
}

constexpr std::size_t patches = 6 * 9 + 5;
constexpr double foot = 0.45 * 0.4;

Words on_cpu(Words words) {
    words.insert(words.end(), {"--device", "cpu", "--jobs", "1"});
    return words;
}

/// Columns of a table of patches by their names; groups are left out.
std::map<std::string, std::vector<double>> table(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);
    std::vector<std::string> names;
    std::istringstream header(line);
    for (std::string name; std::getline(header, name, ',');) {
        names.push_back(name);
    }
    std::map<std::string, std::vector<double>> columns;
    while (std::getline(lines, line)) {
        std::istringstream fields(line);
        std::size_t k = 0;
        for (std::string field; std::getline(fields, field, ','); ++k) {
            if (names[k] != "group") {
                columns[names[k]].push_back(std::stod(field));
            }
        }
    }
    return columns;
}

double sum_of_products(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        sum += a[k] * b[k];
    }
    return sum;
}

} // namespace

TEST_CASE("imprint: factors are those of the scene's patches, with the area that is left of them", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("block.json", cube_with_block());
    const std::string hff = directory.path("f.hff");
    const Outcome run =
        run_hemi(on_cpu({"factors", scene, "-o", hff, "--patches", directory.path("p.csv"), "--json"}));
    REQUIRE(run.status == 0);
    CHECK(run.json()["patches"] == patches);
    CHECK(run.json()["parts"] > patches);
    const auto columns = table(directory.read("p.csv"));
    const std::vector<double>& areas = columns.at("area");
    REQUIRE(areas.size() == patches);
    CHECK(areas[4] == 0.0); // the middle of the floor
    double floor = 0.0;
    for (std::size_t i = 0; i < 9; ++i) {
        floor += areas[i];
    }
    CHECK(floor == Approx(1.0 - foot));
    // Left of the block: a strip, and what is left of a corner is none.
    CHECK(columns.at("cx")[3] == Approx(0.15));
    CHECK(columns.at("cy")[3] == Approx(0.5));
    CHECK(areas[3] == Approx(0.3 / 3.0));

    // The same from the scene, from the file, and as a row.
    REQUIRE(run_hemi({"convert", hff, directory.path("a.csv")}).status == 0);
    REQUIRE(run_hemi(on_cpu({"factors", scene, "-o", directory.path("b.csv")})).status == 0);
    CHECK(directory.read("a.csv") == directory.read("b.csv"));
    const Json row = run_hemi({"factors", hff, "--row", "3", "--json"}).json();
    CHECK(row["patches"] == patches);
    CHECK(row["sum"].get<double>() == Approx(1.0).margin(1e-6));
    const Json raw = run_hemi(on_cpu({"factors", scene, "--row", "3", "--json"})).json();
    CHECK(raw["sum"].get<double>() == Approx(1.0).margin(1e-3));
    CHECK(raw["entries"].size() == row["entries"].size());
    const Json covered = run_hemi({"factors", hff, "--row", "4", "--json"}).json();
    CHECK(covered["blocked"] == 1.0);
    CHECK(covered["entries"].empty());
    CHECK(run_hemi({"factors", hff, "--row", std::to_string(patches)}).status == 2);

    // Radiosity from a stored solution is that of the same patches.
    REQUIRE(run_hemi(on_cpu({"solve", scene, "--result", directory.path("a.hres"), "--radiosity",
                             directory.path("direct.csv")}))
                .status == 0);
    REQUIRE(run_hemi({"convert", directory.path("a.hres"), directory.path("stored.csv")}).status == 0);
    CHECK(directory.read("stored.csv") == directory.read("direct.csv"));
    CHECK(table(directory.read("stored.csv")).at("area") == areas);

    // In a .vtp parts are cells: that of patch 1 is its mean over its own parts.
    const Outcome cells = run_hemi({"convert", directory.path("a.hres"), directory.path("a.vtp"), "--factors",
                                    hff, "--row", "1", "--json"});
    CHECK(cells.json()["patches"] == patches);
    CHECK(cells.json()["parts"] > patches);
    for (const char* array : {"patch_of", "F_1"}) {
        CHECK(directory.read("a.vtp").find(array) != std::string::npos);
    }

    // From a point above the floor, parts of a patch count as one.
    const Json seen = run_hemi({"factors", scene, "--from-point", "0.1,0.1,0.5,0,0,-1", "--json"}).json();
    CHECK(seen["patches"] == patches);
    std::vector<int> listed;
    for (const Json& entry : seen["entries"]) {
        listed.push_back(entry["patch"].get<int>());
    }
    std::sort(listed.begin(), listed.end());
    CHECK(std::adjacent_find(listed.begin(), listed.end()) == listed.end());
    CHECK(seen["sum"].get<double>() == Approx(1.0).margin(1e-3));
}

TEST_CASE("imprint: light is told by the scene's patches, and none of it is lost", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("block.json", cube_with_block());
    const Outcome run = run_hemi(on_cpu({"solve", scene, "--radiosity", directory.path("r.csv"), "--factors",
                                         directory.path("f.hff"), "--tolerance", "1e-10", "--json"}));
    REQUIRE(run.status == 0);
    CHECK(run.json()["patches"] == patches);
    auto columns = table(directory.read("r.csv"));
    REQUIRE(columns.at("area").size() == patches);
    // All but the lamp reflect half: what is absorbed is half of the irradiation, and all of the lamp's own.
    std::vector<double>& irradiance = columns.at("irradiance_grey");
    for (std::size_t i = 0; i < patches; ++i) {
        const bool lamp = columns.at("exitance_grey")[i] > 0.0;
        irradiance[i] *= lamp ? 1.0 : 0.5;
    }
    CHECK(sum_of_products(columns.at("area"), irradiance) == Approx(1.0).epsilon(1e-6));
    // Rows of the file are used again.
    const Outcome again =
        run_hemi({"solve", scene, "--factors", directory.path("f.hff"), "--tolerance", "1e-10", "--json"});
    REQUIRE(again.status == 0);
    CHECK(again.json()["radiosity"] == run.json()["radiosity"]);
    // They are not those of the faces as they are.
    const Outcome uncut = run_hemi({"solve", scene, "--factors", directory.path("f.hff"), "--no-imprint"});
    CHECK(uncut.status == 3);
}

TEST_CASE("imprint: info and check say what was cut", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("block.json", cube_with_block());
    const Outcome info = run_hemi(on_cpu({"info", scene, "--json"}));
    REQUIRE(info.status == 0);
    CHECK(info.json()["patches"] == patches);
    CHECK(info.json()["surfaces"] == 11);
    const Json imprint = info.json()["imprint"];
    CHECK(imprint["covered"].get<double>() == Approx(foot));
    REQUIRE(imprint["faces"].size() == 1);
    CHECK(imprint["faces"][0]["what"] == "cut");
    CHECK(imprint["faces"][0]["face"] == 0);
    CHECK(info.json()["groups"][0]["name"] == "floor");
    CHECK(info.json()["groups"][0]["area"].get<double>() == Approx(1.0 - foot)); // what is left
    const Outcome check = run_hemi(on_cpu({"check", scene}));
    CHECK(check.status == 0);
    CHECK(check.out_has("1 face is cut where others stand on it or pass through it: face 0 of floor"));
    CHECK(check.out_has("buried        none"));

    const Outcome uncut = run_hemi(on_cpu({"check", scene, "--no-imprint"}));
    CHECK_FALSE(uncut.out_has("faces touch"));
    CHECK(uncut.out_has("buried        1 patch"));
    CHECK(run_hemi(on_cpu({"check", scene, "--no-imprint", "--json"})).json()["imprint"].is_null());
}

TEST_CASE("imprint: a group of which nothing is left is blocked, and its means are null", "[cli]") {
    const Directory directory;
    Json room = cube(1);
    for (const char* name : {"mat", "rug"}) { // of equal faces in one place the last one is seen
        room["surfaces"].push_back(
            {{"name", name},
             {"material", "white"},
             {"polygon", Json::parse("[[0.2,0.2,0],[0.6,0.2,0],[0.6,0.6,0],[0.2,0.6,0]]")}});
    }
    const std::string scene = directory.write("rug.json", room);
    const std::string hff = directory.path("rug.hff");
    const Json info = run_hemi(on_cpu({"info", scene, "--json"})).json();
    CHECK(info["groups"][6]["name"] == "mat");
    CHECK(info["groups"][6]["area"] == 0.0);
    const Outcome factors = run_hemi(on_cpu({"factors", scene, "--by-group", "--json", "-o", hff}));
    REQUIRE(factors.status == 0);
    const Json table = factors.json();
    CHECK(table["areas"][6] == 0.0);
    CHECK(table["blocked"][6] == 1.0);
    CHECK(table["environment"][6] == 0.0);
    CHECK(table["factors"][6] == Json::array({0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}));
    CHECK(run_hemi({"factors", hff, "--by-group", "--json"}).json()["blocked"][6] == 1.0);
    CHECK_FALSE(run_hemi({"factors", hff, "--by-group"}).out_has("1.000000"));
    const Json solution = run_hemi(on_cpu({"solve", scene, "--factors", hff, "--json"})).json();
    CHECK(solution["radiosity"][6][0].is_null());
    CHECK(solution["radiosity"][7][0].is_number());
    const Json row = run_hemi(on_cpu({"factors", scene, "--row", "6", "--json"})).json();
    CHECK(row["group"] == "mat");
    CHECK(row["sum"] == 0.0);
    CHECK(row["environment"] == 0.0);
    CHECK(row["blocked"] == 1.0);
    CHECK(row["entries"].empty());
}

TEST_CASE("imprint: a warning names patches of the user that a sheet divides", "[cli]") {
    const Directory directory;
    Json room = cube(2);
    room["surfaces"].push_back({{"name", "screen"},
                                {"material", "white"},
                                {"two_sided", true},
                                {"polygon", Json::parse("[[0.6,0,0],[0.6,1,0],[0.6,1,1],[0.6,0,1]]")}});
    const std::string scene = directory.write("screen.json", room);
    const Outcome run = run_hemi(on_cpu({"info", scene}));
    CHECK(run.status == 0);
    CHECK(run.err_has("8 patches lie on both sides of a sheet")); // of floor, ceiling and two walls
    CHECK(run.err_has("of floor by face 6 of screen"));
    // Patches of a size are no one's.
    CHECK_FALSE(run_hemi(on_cpu({"info", scene, "--patch-size", "0.5"})).err_has("sheet"));
    // At their edges there is nothing to divide.
    room["surfaces"].back()["polygon"] = Json::parse("[[0.5,0,0],[0.5,1,0],[0.5,1,1],[0.5,0,1]]");
    CHECK_FALSE(run_hemi(on_cpu({"info", directory.write("edge.json", room)})).err_has("sheet"));
}

TEST_CASE("imprint: a foot that another one covers in part is left out by a body, and all faces are listed",
          "[cli]") {
    const Directory directory;
    Json room = cube(1);
    const auto add_box = [&room](const std::string& name, double x, double y, double size, double height) {
        const auto add = [&](const std::vector<std::vector<double>>& polygon) {
            room["surfaces"].push_back({{"name", name}, {"material", "white"}, {"polygon", polygon}});
        };
        const double a = x + size;
        const double b = y + size;
        add({{x, y, 0}, {x, b, 0}, {a, b, 0}, {a, y, 0}});
        add({{x, y, height}, {a, y, height}, {a, b, height}, {x, b, height}});
        add({{x, y, 0}, {a, y, 0}, {a, y, height}, {x, y, height}});
        add({{a, y, 0}, {a, b, 0}, {a, b, height}, {a, y, height}});
        add({{a, b, 0}, {x, b, 0}, {x, b, height}, {a, b, height}});
        add({{x, b, 0}, {x, y, 0}, {x, y, height}, {x, b, height}});
    };
    add_box("b", 0.2, 0.2, 0.4, 0.3);
    add_box("c", 0.45, 0.4, 0.3, 0.4);
    const std::string scene = directory.write("boxes.json", room);
    const Outcome brief = run_hemi(on_cpu({"info", scene}));
    CHECK_FALSE(brief.err_has("covered by"));
    CHECK(brief.out_has("faces are left out: they lie inside other bodies: face 6 of b, face 12 of c"));
    CHECK(brief.out_has(", ..."));
    const Outcome all = run_hemi(on_cpu({"info", scene, "-v"}));
    CHECK_FALSE(all.out_has(", ..."));
}
