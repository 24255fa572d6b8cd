#include "cli/program.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

using namespace hemi::cli_test;

namespace {

constexpr double sigma = 5.670374419e-8;

/// `words`, and a device on which rows come fast.
Words on_cpu(Words words) {
    words.insert(words.end(), {"--device", "cpu", "--jobs", "1", "--no-estimate"});
    return words;
}

/// A box seen from inside, one patch a face: bottom and top have temperatures, the sides are adiabatic.
Json box(double x, double y, double z, int n = 1) {
    const auto polygon = [&](std::vector<std::array<double, 3>> unit) {
        Json points = Json::array();
        for (const auto& p : unit) {
            points.push_back({p[0] * x, p[1] * y, p[2] * z});
        }
        return points;
    };
    return {{"hemi", 1},
            {"materials",
             {{"bottom", {{"emissivity", 0.9}}},
              {"top", {{"emissivity", 0.75}}},
              {"side", {{"emissivity", 0.5}}}}},
            {"surfaces",
             {face("bottom", "bottom", polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}), n),
              face("top", "top", polygon({{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}), n),
              face("left", "side", polygon({{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}), n),
              face("right", "side", polygon({{1, 0, 0}, {1, 0, 1}, {1, 1, 1}, {1, 1, 0}}), n),
              face("front", "side", polygon({{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}), n),
              face("back", "side", polygon({{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}), n)}},
            {"groups",
             {{"bottom", {{"temperature", 550}}},
              {"top", {{"temperature", 300}}},
              {"left", {{"heat_flux", 0}}},
              {"right", {{"heat_flux", 0}}},
              {"front", {{"heat_flux", 0}}},
              {"back", {{"power", 0}}}}},
            {"enclosure", "closed"}};
}

/// Between opposite rectangles a x b at distance c.
double opposite(double a, double b, double c) {
    const double x = a / c;
    const double y = b / c;
    const double x1 = std::sqrt(1.0 + x * x);
    const double y1 = std::sqrt(1.0 + y * y);
    return 2.0 / (std::numbers::pi * x * y) *
           (std::log(x1 * y1 / std::sqrt(1.0 + x * x + y * y)) + x * y1 * std::atan(x / y1) +
            y * x1 * std::atan(y / x1) - x * std::atan(x) - y * std::atan(y));
}

/// F of the box's faces (bottom, top, left, right, front, back); neighbours from closure and reciprocity:
/// three unknowns a_xy, a_xz, a_yz, exchange areas of a face with each of two pairs of neighbours.
std::vector<std::vector<double>> box_factors(double x, double y, double z) {
    const double xy = x * y;
    const double yz = y * z;
    const double xz = x * z;
    // What a face leaves for its neighbours, half of it to either side.
    const double b = 0.5 * xy * (1.0 - opposite(x, y, z));
    const double l = 0.5 * yz * (1.0 - opposite(y, z, x));
    const double f = 0.5 * xz * (1.0 - opposite(x, z, y));
    // b = bl + bf, l = bl + lf, f = bf + lf.
    const double bl = 0.5 * (b + l - f);
    const double bf = 0.5 * (b + f - l);
    const double lf = 0.5 * (l + f - b);
    const double areas[6] = {xy, xy, yz, yz, xz, xz};
    const double own[3] = {opposite(x, y, z), opposite(y, z, x), opposite(x, z, y)};
    std::vector<std::vector<double>> factors(6, std::vector<double>(6, 0.0));
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 6; ++j) {
            if (i / 2 == j / 2) {
                factors[i][j] = i == j ? 0.0 : own[i / 2];
                continue;
            }
            const std::size_t kinds =
                i / 2 + j / 2; // 1: bottom and left, 2: bottom and front, 3: left and front
            factors[i][j] = (kinds == 1 ? bl : kinds == 2 ? bf : lf) / areas[i];
        }
    }
    return factors;
}

/// Solves A x = b.
std::vector<double> solve(std::vector<std::vector<double>> a, std::vector<double> b) {
    const std::size_t n = b.size();
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k; i < n; ++i) {
            pivot = std::abs(a[i][k]) > std::abs(a[pivot][k]) ? i : pivot;
        }
        std::swap(a[k], a[pivot]);
        std::swap(b[k], b[pivot]);
        for (std::size_t i = 0; i < n; ++i) {
            if (i != k) {
                const double factor = a[i][k] / a[k][k];
                for (std::size_t j = k; j < n; ++j) {
                    a[i][j] -= factor * a[k][j];
                }
                b[i] -= factor * b[k];
            }
        }
    }
    for (std::size_t k = 0; k < n; ++k) {
        b[k] /= a[k][k];
    }
    return b;
}

/// MOOSE's cavity as a duct of length 1, whose ends do not count: rows come from a file.
Json cavity() {
    Json scene = box(1, 1, 2);
    scene["surfaces"] = {scene["surfaces"][0], scene["surfaces"][3], scene["surfaces"][1],
                         scene["surfaces"][2]};
    scene["materials"]["bottom"]["emissivity"] = 1;
    scene["groups"].erase("front");
    scene["groups"].erase("back");
    return scene;
}

std::string cavity_factors() {
    const double ends = std::sqrt(5.0) - 2.0;
    const double sides = (std::sqrt(5.0) - 1.0) / 2.0;
    const double to_side = (1.0 - ends) / 2.0;
    const double to_end = (1.0 - sides) / 2.0;
    const double rows[4][4] = {{0.0, to_side, ends, to_side},
                               {to_end, 0.0, to_end, sides},
                               {ends, to_side, 0.0, to_side},
                               {to_end, sides, to_end, 0.0}};
    std::string text = "i,j,F\n";
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
            if (i != j) {
                char line[64];
                std::snprintf(line, sizeof line, "%d,%d,%.17g\n", i, j, rows[i][j]);
                text += line;
            }
        }
    }
    return text;
}

} // namespace

TEST_CASE("hemi heat: a re-radiating box is its 6 x 6 system", "[cli][heat]") {
    const Directory directory;
    const Outcome run =
        run_hemi(on_cpu({"heat", directory.write("box.json", box(1, 2, 3)), "--json", "--preset", "exact"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json heat = run.json();
    const auto factors = box_factors(1, 2, 3);
    // J = eps sigma T⁴ + (1 - eps) F J, and J = F J of the sides.
    const double eps[6] = {0.9, 0.75, 0, 0, 0, 0};
    std::vector<std::vector<double>> system(6, std::vector<double>(6, 0.0));
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 6; ++j) {
            system[i][j] = (i == j ? 1.0 : 0.0) - (1.0 - eps[i]) * factors[i][j];
        }
    }
    const auto radiosity = solve(
        system, {0.9 * sigma * std::pow(550.0, 4), 0.75 * sigma * std::pow(300.0, 4), 0.0, 0.0, 0.0, 0.0});
    for (std::size_t i = 0; i < 6; ++i) {
        CHECK(heat["radiosity"][i].get<double>() == Approx(radiosity[i]).epsilon(1e-6));
        if (i >= 2) {
            CHECK(heat["temperature"][i].get<double>() ==
                  Approx(std::pow(radiosity[i] / sigma, 0.25)).epsilon(1e-6));
            CHECK(heat["net_flux"][i].get<double>() == Approx(0.0).margin(1e-9));
        }
    }
    CHECK(heat["balance"]["relative"].get<double>() < 1e-9);
}

TEST_CASE("hemi heat: the JSON has all that is promised, in the right sizes", "[cli][heat]") {
    const Directory directory;
    const Outcome run =
        run_hemi({"heat", directory.write("box.json", box(1, 2, 3, 3)), "--json", "--device", "cpu",
                  "--fluxes", directory.path("box.csv"), "-o", directory.path("box.vtp")});
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json heat = run.json();
    CHECK(heat["schema"] == "hemi/heat/1");
    CHECK(heat["groups"] == Json({"bottom", "top", "left", "right", "front", "back"}));
    for (const char* key : {"areas", "emissivity", "temperature", "emitted", "absorbed", "irradiation",
                            "radiosity", "net_flux", "net_power"}) {
        INFO(key);
        REQUIRE(heat[key].size() == 6);
        CHECK(heat[key][0].is_number());
    }
    REQUIRE(heat["error"]["net_flux"].size() == 6);
    CHECK(heat["error"]["net_flux"][0] > 0.0);
    CHECK(heat["error"]["net_flux"][2] == 0.0); // adiabatic
    CHECK(heat["areas"][0].get<double>() == Approx(2.0));
    CHECK(heat["temperature"][0].get<double>() == Approx(550.0));
    CHECK(heat["emissivity"][0].get<double>() == Approx(0.9));
    CHECK(heat["net_power"][0].get<double>() == Approx(2.0 * heat["net_flux"][0].get<double>()));
    CHECK(heat["environment_power"] == 0.0);
    CHECK(std::abs(heat["balance"]["relative"].get<double>()) < 1e-7);
    CHECK(heat["seconds"]["total"] > 0.0);
    CHECK_FALSE(heat.contains("series"));
    const Outcome quiet = run_hemi(on_cpu({"heat", directory.path("box.json"), "-q"}));
    CHECK(quiet.err.empty());
    CHECK(quiet.out.starts_with("group "));
    const std::string table = directory.read("box.csv");
    CHECK(table.starts_with("index,group,area,cx,cy,cz,nx,ny,nz,temperature,net_flux,emitted,absorbed,"
                            "irradiation,radiosity\n0,bottom,"));
    CHECK(std::count(table.begin(), table.end(), '\n') == 55);
    CHECK(directory.read("box.vtp").find("Name=\"net_flux\"") != std::string::npos);
}

TEST_CASE("hemi heat: the estimated error of a flux is about what it is off by", "[cli][heat]") {
    const Directory directory;
    const Json heat =
        run_hemi({"heat", directory.write("box.json", box(1, 2, 3, 4)), "--json", "--device", "cpu"}).json();
    // From 8 x 8 and 16 x 16 patches a face, 1470.22 and 1455.83, extrapolated by the square of their size.
    const double error = std::abs(heat["net_flux"][0].get<double>() - 1451.03);
    const double estimate = heat["error"]["net_flux"][0].get<double>();
    CHECK(estimate > 0.6 * error);
    CHECK(estimate < 1.7 * error);
    CHECK(heat["error"]["parts"]["patch_size"][0].get<double>() > 0.9 * estimate);
}

TEST_CASE("hemi heat: black surfaces have no error by the patches' size", "[cli][heat]") {
    const Directory directory;
    Json scene = box(1, 2, 3);
    for (const char* material : {"bottom", "top", "side"}) {
        scene["materials"][material]["emissivity"] = 1;
    }
    for (const char* side : {"left", "right", "front", "back"}) {
        scene["groups"][side] = {{"temperature", 400}};
    }
    const Json error =
        run_hemi({"heat", directory.write("box.json", scene), "--json", "--device", "cpu"}).json()["error"];
    for (std::size_t g = 0; g < 6; ++g) {
        CHECK(error["parts"]["patch_size"][g] == 0.0);
        CHECK(error["net_flux"][g].is_number());
    }
}

TEST_CASE("hemi heat: a power cannot leave a group that is covered", "[cli][heat]") {
    const Directory directory;
    Json scene = box(4, 4, 4, 4);
    // On the floor, without its bottom; "under" is there in its place.
    for (const char* points : {"[[1,1,2],[3,1,2],[3,3,2],[1,3,2]]", "[[1,1,0],[3,1,0],[3,1,2],[1,1,2]]",
                               "[[1,3,0],[1,3,2],[3,3,2],[3,3,0]]", "[[1,1,0],[1,1,2],[1,3,2],[1,3,0]]",
                               "[[3,1,0],[3,3,0],[3,3,2],[3,1,2]]"}) {
        scene["surfaces"].push_back(face("block", "top", Json::parse(points), 1));
    }
    scene["surfaces"].push_back(face("under", "top", Json::parse("[[1,1,0],[1,3,0],[3,3,0],[3,1,0]]"), 1));
    scene["groups"]["block"] = {{"heat_flux", 0}};
    scene["groups"]["under"] = {{"power", 500}};
    const std::string file = directory.write("block.json", scene);
    for (const Words& words : {Words{"heat", file}, Words{"heat", file, "--no-imprint"}}) {
        const Outcome run = run_hemi(on_cpu(words));
        INFO(run.err);
        CHECK(run.status == 3);
        CHECK(run.err_has("group under: a power of 500 W cannot leave"));
        Words other = words;
        other.insert(other.end(), {"--power", "under=5"});
        CHECK(run_hemi(on_cpu(other)).err_has("5 W cannot leave"));
        other.back() = "under=0";
        const Outcome none = run_hemi(on_cpu(other));
        CHECK(none.status == 0);
        CHECK_FALSE(none.out_has("nan"));
    }
    // Of its patches nothing is known but that they have no flux.
    const std::string fluxes = directory.path("fluxes.csv");
    CHECK(run_hemi(on_cpu({"heat", file, "--no-imprint", "--power", "under=0", "--fluxes", fluxes})).status ==
          0);
    const std::string table = directory.read("fluxes.csv");
    const std::size_t under = table.find(",under,");
    REQUIRE(under != std::string::npos);
    CHECK(table.substr(under, table.find('\n', under) - under).ends_with(",,0,,,,"));
}

TEST_CASE("hemi heat: MOOSE's cavity by factors from a file", "[cli][heat]") {
    const Directory directory;
    const std::string scene = directory.write("cavity.json", cavity());
    const std::string factors = directory.write("F.csv", cavity_factors());
    const Outcome run = run_hemi({"heat", scene, "--factors", factors, "--json"});
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json heat = run.json();
    CHECK(heat["net_flux"][0].get<double>() == Approx(2423.657817).epsilon(1e-7));
    CHECK(heat["radiosity"][2].get<double>() == Approx(1267.186267).epsilon(1e-7));
    CHECK(heat["temperature"][1].get<double>() == Approx(488.460360).epsilon(1e-7));
    // Areas of another length of the duct, from a table.
    const std::string areas = directory.write("areas.csv", "group,area\nbottom,600\nright,1200\ntop,600\n"
                                                           "left,1200\n");
    const Json longer = run_hemi({"heat", scene, "--factors", factors, "--areas", areas, "--json"}).json();
    CHECK(longer["net_power"][0].get<double>() == Approx(600.0 * 2423.657817).epsilon(1e-7));
    CHECK(run_hemi({"heat", scene, "--areas", areas}).status == 2);
    CHECK(run_hemi({"heat", scene, "--factors", factors, "--preset", "fast"}).err_has("another program"));
    const Outcome wrong =
        run_hemi({"heat", scene, "--factors", directory.write("G.csv", "i,j,F\n0,1,1\n1,0,1\n")});
    CHECK(wrong.status == 3);
    CHECK(wrong.err_has("2 rows"));
}

TEST_CASE("hemi heat: MOOSE's cavity as a duct of 600 m", "[cli][heat]") {
    const Directory directory;
    Json duct = box(1, 600, 2);
    duct["materials"]["bottom"]["emissivity"] = 1;
    duct["groups"]["back"] = {{"heat_flux", 0}};
    const Outcome run = run_hemi(on_cpu({"heat", directory.write("duct.json", duct), "--json"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json heat = run.json();
    CHECK(heat["net_flux"][0].get<double>() == Approx(2423.657817).epsilon(1e-3));
    CHECK(heat["radiosity"][1].get<double>() == Approx(1267.186267).epsilon(1e-3));
    CHECK(heat["temperature"][2].get<double>() == Approx(488.460360).epsilon(1e-3));
}

TEST_CASE("hemi solve, heat: energy balances in every closed scene that comes with hemi",
          "[cli][heat][scenes]") {
    int closed = 0;
    for (const auto& entry : std::filesystem::directory_iterator(HEMI_SOURCE_DIR "/scenes")) {
        if (entry.path().extension() != ".json") {
            continue;
        }
        std::ifstream file(entry.path());
        const Json scene = Json::parse(file);
        if (!scene.contains("enclosure") || scene["enclosure"] != "closed") {
            continue;
        }
        ++closed;
        INFO(entry.path());
        const bool heat = scene.contains("groups") &&
                          std::any_of(scene["groups"].begin(), scene["groups"].end(),
                                      [](const Json& group) { return group.contains("temperature"); });
        // Coarse, which does not matter to it.
        Words words = on_cpu({heat ? "heat" : "solve", entry.path().string(), "--json", "--patches-per-face",
                              "1", "--preset", "fast", "--resolution", "16", "--eye-points", "1"});
        if (!heat) {
            words.insert(words.end(), {"--tolerance", "1e-10"});
        }
        const Outcome run = run_hemi(words);
        INFO(run.err);
        REQUIRE(run.status == 0);
        const Json balance = run.json()["balance"];
        if (heat) {
            CHECK(std::abs(balance["relative"].get<double>()) < 1e-7);
            continue;
        }
        const double emitted = balance["emitted"];
        REQUIRE(emitted > 0.0);
        CHECK(balance["lost"] == 0.0);
        CHECK(std::abs(balance["environment"].get<double>()) < 1e-7 * emitted);
        CHECK(balance["absorbed"].get<double>() == Approx(emitted).epsilon(1e-7));
    }
    CHECK(closed == 5);
}

TEST_CASE("hemi heat: a furnace with a load on its hearth balances", "[cli][heat][scenes]") {
    const Outcome run = run_hemi(on_cpu({"heat", HEMI_SOURCE_DIR "/scenes/furnace-hot.json", "--json"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json heat = run.json();
    // Of the hearth, what lies under the load is buried or left out.
    CHECK(heat["areas"][0].get<double>() - 0.01 * heat["buried"].get<double>() == Approx(2.08));
    CHECK(std::abs(heat["balance"]["relative"].get<double>()) < 1e-7);
    const std::size_t heaters = 3;
    const std::size_t load = 4;
    REQUIRE(heat["groups"][heaters] == "heaters");
    CHECK(heat["net_power"][heaters].get<double>() ==
          Approx(-heat["net_power"][load].get<double>()).epsilon(1e-7));
    CHECK(heat["net_power"][heaters] > 1e4);
    for (const std::size_t brick : {0u, 1u, 2u}) {
        CHECK(heat["temperature"][brick] > 723.15);
        CHECK(heat["temperature"][brick] < 1273.15);
    }
    CHECK(heat["emissivity"][load].get<double>() == Approx(0.6 + 0.2 * 430.0 / 780.0));
}

TEST_CASE("hemi heat: a street in the sun balances, and its sunny side is the warmer one",
          "[cli][heat][scenes][sun]") {
    const Outcome run =
        run_hemi(on_cpu({"heat", HEMI_SOURCE_DIR "/scenes/street-heat.json", "--json", "--preset", "fast"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json heat = run.json();
    CHECK(std::abs(heat["balance"]["relative"].get<double>()) < 1e-7);
    std::map<std::string, std::size_t> index;
    for (std::size_t g = 0; g < heat["groups"].size(); ++g) {
        index[heat["groups"][g]] = g;
    }
    const auto of = [&](const char* quantity, const char* group) {
        return heat[quantity][index.at(group)].get<double>();
    };
    // At half past three in summer time the sun is in the south-west: it shines on what looks west.
    CHECK(of("direct", "wall_east") > 2.0 * of("direct", "wall_west"));
    CHECK(of("direct", "roofs") > 500.0);
    CHECK(of("direct", "road") < of("irradiation", "road"));
    for (const auto& [name, g] : index) {
        INFO(name);
        CHECK(heat["temperature"][g] > 283.0);
        CHECK(heat["temperature"][g] < 360.0);
    }
    CHECK(heat["environment_power"] > 0.0);
}

TEST_CASE("hemi heat: groups of a mesh get what the command line says", "[cli][heat]") {
    const Directory directory;
    const std::string mesh = directory.write("plates.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                                           "v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                                                           "g floor\nf 1 2 3 4\ng ceiling\nf 8 7 6 5\n");
    const Words words = on_cpu({"heat", mesh, "--json", "--temperature", "floor=226.85C", "--emissivity",
                                "floor=0.8", "--heat-flux", "ceiling=0", "--environment-temperature", "300"});
    const Outcome run = run_hemi(words);
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json heat = run.json();
    CHECK(heat["temperature"][0].get<double>() == Approx(500.0));
    CHECK(heat["emissivity"][0].get<double>() == Approx(0.8));
    CHECK(heat["net_power"][1].get<double>() == Approx(0.0).margin(1e-9));
    CHECK(heat["environment_power"].get<double>() ==
          Approx(-heat["net_power"][0].get<double>()).epsilon(1e-9));
    // Of the same mesh in millimetres the powers are a millionth.
    Words small = words;
    small.insert(small.end(), {"--unit", "mm"});
    CHECK(run_hemi(small).json()["net_power"][0].get<double>() ==
          Approx(1e-6 * heat["net_power"][0].get<double>()));
    const Outcome nearest = run_hemi(on_cpu({"heat", mesh, "--temperature", "flor=300"}));
    CHECK(nearest.status == 2);
    CHECK(nearest.err_has("\"floor\""));
    CHECK(run_hemi({"heat", mesh, "--temperature", "floor=300", "--heat-flux", "floor=0"}).status == 2);
    CHECK(run_hemi({"heat", mesh, "--temperature", "floor=-1"}).err_has("below 0 K"));
    CHECK(run_hemi({"heat", mesh, "--emissivity", "floor=1.5"}).status == 2);
    CHECK(run_hemi({"heat", mesh, "--temperature", "floor"}).err_has("GROUP=T"));
    CHECK(run_hemi({"heat", mesh, "--emissivity", "floor=0.5", "--emissivity", "floor=0.6"})
              .err_has("an emissivity already"));
    // Materials that no surface uses any more may have colours.
    directory.write("red.mtl", "newmtl red\nKd 0.8 0.2 0.1\n");
    const std::string red = directory.write("red.obj", "mtllib red.mtl\n" + directory.read("plates.obj") +
                                                           "usemtl red\ng lid\nf 1 2 6 5\n");
    const Words coloured = on_cpu({"heat", red, "--temperature", "floor=500"});
    CHECK(run_hemi(coloured).err_has("equal channels"));
    Words grey = coloured;
    grey.insert(grey.end(), {"--emissivity", "lid=0.5"});
    CHECK(run_hemi(grey).status == 0);
    const Outcome dark = run_hemi(on_cpu({"heat", mesh, "--temperature", "floor=500"}));
    CHECK(dark.status == 0);
    CHECK(dark.err_has("0 K"));
    CHECK(dark.err_has("ceiling")); // nothing is known of it
}

TEST_CASE("hemi heat: groups from a table", "[cli][heat]") {
    const Directory directory;
    Json scene = box(1, 2, 3);
    const Words words{"heat", directory.write("box.json", scene), "--json"};
    const Json expected = run_hemi(on_cpu(words)).json();
    scene.erase("groups");
    scene["materials"]["top"]["emissivity"] = 0.1;
    const std::string bare = directory.write("bare.json", scene);
    const std::string table = directory.write("groups.csv", "group,temperature,emissivity,heat_flux,power\n"
                                                            "bottom,276.85C,,,\ntop,300,0.75,,\n"
                                                            "left,,,0,\nright,,,0,\nfront,,,0,\nback,,,,0\n");
    const Json heat = run_hemi(on_cpu({"heat", bare, "--groups", table, "--json"})).json();
    for (std::size_t g = 0; g < 6; ++g) {
        CHECK(heat["radiosity"][g].get<double>() ==
              Approx(expected["radiosity"][g].get<double>()).epsilon(1e-9));
    }
    const auto refused = [&](const std::string& text, const std::string& message) {
        const Outcome run = run_hemi({"heat", bare, "--groups", directory.write("bad.csv", text)});
        CHECK(run.status != 0);
        INFO(run.err);
        CHECK(run.err_has(message));
    };
    // Options say more than the table.
    const Json over = run_hemi(on_cpu({"heat", bare, "--groups", table, "--json", "--temperature", "left=400",
                                       "--emissivity", "top=0.5"}))
                          .json();
    CHECK(over["temperature"][2].get<double>() == Approx(400.0));
    CHECK(over["emissivity"][1].get<double>() == Approx(0.5));
    CHECK(over["temperature"][0].get<double>() == Approx(550.0));
    refused("group,temperature\ntop,300\ntop,400\n", "bad.csv:3");
    refused("group,temperature,power\ntop,300,4\n", "bad.csv:2");
    refused("group,emissivity\ntop,0.3\ntop,0.4\n", "bad.csv:3");
    refused("group,temperature,temperature\ntop,300,\n", "two columns");
    refused("group,temprature\ntop,300\n", "\"temperature\"");
    refused("group,temperature\ntop,300,4\n", "bad.csv:2");
    refused("group,temperature\ntop,-3\n", "0 K");
    refused("group,emissivity\ntop,2\n", "at most 1");
    refused("group,power\ntop,20C\n", "a number");
    refused("group,power\ntopp,20\n", "\"top\"");
}

TEST_CASE("hemi solve: surfaces radiate by their temperatures", "[cli][heat]") {
    const Directory directory;
    Json scene = box(1, 2, 3);
    for (const char* side : {"left", "right", "front", "back"}) {
        scene["groups"][side] = {{"temperature", 400}};
    }
    const std::string file = directory.write("box.json", scene);
    const Json heat = run_hemi(on_cpu({"heat", file, "--json"})).json();
    const Json light = run_hemi(on_cpu({"solve", file, "--json", "--tolerance", "1e-9"})).json();
    for (std::size_t g = 0; g < 6; ++g) {
        CHECK(light["radiosity"][g][0].get<double>() ==
              Approx(heat["radiosity"][g].get<double>()).epsilon(1e-7));
    }
    scene["groups"]["left"] = {{"heat_flux", 0}};
    CHECK(run_hemi(on_cpu({"solve", directory.write("flux.json", scene)})).err_has("hemi heat"));
}

TEST_CASE("hemi heat: slips in temperatures and units are told", "[cli][heat]") {
    const Directory directory;
    Json scene = box(1, 2, 3);
    scene["groups"]["top"]["temperature"] = 20;
    CHECK(run_hemi(on_cpu({"heat", directory.write("cold.json", scene)})).err_has("\"20 C\""));
    CHECK(run_hemi(on_cpu({"heat", directory.write("large.json", box(100, 200, 600))})).err_has("no unit"));
    Json isothermal = box(1, 2, 3);
    isothermal["groups"]["top"]["isothermal"] = true;
    CHECK(run_hemi({"heat", directory.write("isothermal.json", isothermal)}).err_has("beside"));
    Json closed = box(1, 2, 3);
    closed["groups"]["bottom"] = {{"power", 10}};
    closed["groups"]["top"] = {{"power", 10}};
    const Outcome singular = run_hemi(on_cpu({"heat", directory.write("closed.json", closed)}));
    CHECK(singular.status == 3);
    CHECK(singular.err_has("bottom"));
    CHECK(singular.err_has("20 W"));
    // Reflectance 1 is adiabatic here, and an error where light is solved for.
    Json mirrors = box(1, 2, 3);
    mirrors["materials"]["side"] = {{"reflectance", 1}};
    for (const char* side : {"left", "right", "front", "back"}) {
        mirrors["groups"].erase(side);
    }
    const std::string file = directory.write("mirrors.json", mirrors);
    CHECK(run_hemi(on_cpu({"heat", file})).status == 0);
    CHECK(run_hemi(on_cpu({"solve", file})).err_has("below 1"));
    const Outcome factors = run_hemi(on_cpu({"factors", file})); // they know no reflectance
    CHECK(factors.status == 0);
    CHECK(factors.err.empty());
}

TEST_CASE("hemi heat: a series of temperatures", "[cli][heat]") {
    const Directory directory;
    const std::string scene = directory.write("box.json", box(1, 2, 3, 2));
    const std::string times = directory.write("times.csv", "time,top,bottom\n0 h,300,550\n1 h,20C,600\n");
    const Outcome run = run_hemi(on_cpu({"heat", scene, "--series", times, "--json"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json heat = run.json();
    REQUIRE(heat["series"].size() == 2);
    CHECK(heat["series"][0]["time"] == "0 h");
    for (std::size_t g = 0; g < 6; ++g) {
        CHECK(heat["series"][0]["temperature"][g].get<double>() ==
              Approx(heat["temperature"][g].get<double>()).epsilon(1e-9));
        CHECK(heat["series"][0]["net_power"][g].get<double>() ==
              Approx(heat["net_power"][g].get<double>()).epsilon(1e-9).margin(1e-6));
    }
    CHECK(heat["series"][1]["temperature"][1].get<double>() == Approx(293.15));
    const Outcome unknown =
        run_hemi(on_cpu({"heat", scene, "--series", directory.write("unknown.csv", "time,botom\n0,300\n")}));
    CHECK(unknown.status == 3);
    CHECK(unknown.err_has("\"bottom\""));
    const Outcome word = run_hemi(
        on_cpu({"heat", scene, "--series", directory.write("word.csv", "time,top\n0,300\n1,warm\n")}));
    CHECK(word.status == 3);
    CHECK(word.err_has("word.csv:3"));
    // What is wrong with a series is told before anything is computed or written.
    const std::string fluxes = directory.path("fluxes.csv");
    const auto refused = [&](const std::string& text, const std::string& message) {
        const Outcome bad = run_hemi(
            on_cpu({"heat", scene, "--series", directory.write("bad.csv", text), "--fluxes", fluxes}));
        INFO(bad.err);
        CHECK(bad.status == 3);
        CHECK(bad.err_has(message));
        CHECK_FALSE(std::filesystem::exists(fluxes));
    };
    refused("time,bottom\n0,300\n1,-5\n", "bad.csv:3");
    refused("time,left\n0,0\n1,20C\n", "a number");
    refused("time,back\n0,20C\n", "a number");
    refused("time,botom\n0,300\n", "\"bottom\"");
    refused("time,left\n0 h,0\n1 h,-50000\n", "line 2 (\"1 h\"): group left");
}

TEST_CASE("hemi exchange: conductances are reciprocal and balance", "[cli][heat]") {
    const Directory directory;
    Json scene = box(1, 2, 3, 2);
    scene.erase("groups");
    scene["materials"]["top"] = {{"reflectance", 1}};
    const Outcome run = run_hemi(on_cpu({"exchange", directory.write("box.json", scene), "--json",
                                         "--emissivity", "left=0.05", "-o", directory.path("box.csv")}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json exchange = run.json();
    CHECK(exchange["schema"] == "hemi/exchange/1");
    CHECK(exchange["emissivity"][2].get<double>() == Approx(0.05));
    for (std::size_t g = 0; g < 6; ++g) {
        double sum = exchange["environment"][g].get<double>();
        for (std::size_t h = 0; h < 6; ++h) {
            sum += exchange["script_f"][g][h].get<double>();
            CHECK(exchange["conductance"][g][h] == exchange["conductance"][h][g]);
        }
        CHECK(sum == Approx(exchange["emissivity"][g].get<double>()).epsilon(1e-9).margin(1e-12));
    }
    CHECK(exchange["gebhart"][1][0].is_null()); // emits nothing
    CHECK(exchange["gebhart"][0][2].get<double>() > 0.0);
    const std::string table = directory.read("box.csv");
    CHECK(table.starts_with("from,to,gebhart,script_f,conductance\nbottom,bottom,"));
    CHECK(std::count(table.begin(), table.end(), '\n') == 1 + 6 * 7);
    CHECK(run_hemi({"exchange", directory.path("box.json"), "--temperature", "top=300"}).status == 2);
    CHECK(run_hemi({"exchange", directory.path("box.csv")}).err_has("exchange needs a scene"));
    const Outcome large = run_hemi(
        {"exchange", directory.write("large.json", box(100, 200, 600)), "--device", "cpu", "--json"});
    CHECK(large.err_has("no unit"));
    CHECK_FALSE(large.err_has("temperature"));
    CHECK(large.json()["seconds"]["estimate"] == 0.0);
}

TEST_CASE("hemi exchange --min: small conductances go to the others", "[cli][heat]") {
    const Directory directory;
    Json scene = box(1, 2, 3, 2);
    scene.erase("groups");
    const std::string file = directory.write("box.json", scene);
    const std::string table = directory.path("box.csv");
    const Json whole = run_hemi(on_cpu({"exchange", file, "--json"})).json();
    CHECK(whole["cutoff"].is_null());
    const Outcome run = run_hemi(on_cpu({"exchange", file, "--json", "--min", "0.2", "-o", table}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json cut = run.json();
    std::uint64_t dropped = 0;
    double change = 0.0;
    for (std::size_t g = 0; g < 6; ++g) {
        double sum = cut["environment"][g].get<double>();
        for (std::size_t h = 0; h < 6; ++h) {
            const double was = whole["conductance"][g][h].get<double>();
            const double is = cut["conductance"][g][h].get<double>();
            sum += cut["script_f"][g][h].get<double>();
            CHECK(is == cut["conductance"][h][g].get<double>());
            CHECK((g == h || is == 0.0 || is >= 0.2));
            dropped += g < h && is == 0.0 ? 1 : 0;
            change = g != h && is > 0.0 ? std::max(change, std::abs(is / was - 1.0)) : change;
        }
        CHECK(sum == Approx(cut["emissivity"][g].get<double>()).epsilon(1e-9));
    }
    CHECK(dropped > 0);
    CHECK(dropped < 15);
    CHECK(cut["cutoff"]["min"] == 0.2);
    CHECK(cut["cutoff"]["dropped"] == dropped);
    CHECK(cut["cutoff"]["kept"] == 15 - dropped);
    CHECK(cut["cutoff"]["largest_change"].get<double>() == Approx(change).epsilon(1e-9));
    const std::string lines =
        directory.read("box.csv"); // a line of names, groups with themselves, pairs both ways
    CHECK(std::count(lines.begin(), lines.end(), '\n') ==
          1 + 6 + 2 * (15 - static_cast<std::int64_t>(dropped)));
    const Outcome told = run_hemi(on_cpu({"exchange", file, "--min", "0.2"}));
    CHECK(told.out_has(std::to_string(dropped) + " of 15 conductances below 0.2 m²"));
    const Outcome apart = run_hemi(on_cpu({"exchange", file, "--min", "100"}));
    CHECK(apart.status == 0);
    CHECK(apart.err_has("nothing is left between bottom, top, left, right, front, back"));
    CHECK(run_hemi({"exchange", file, "--min", "0"}).status == 2);
    CHECK(run_hemi({"exchange", file, "--min", "small"}).status == 2);
}

TEST_CASE("hemi exchange -o: a NumPy archive, View3D's table with reflection", "[cli][heat]") {
    const Directory directory;
    // Infinite plates but for what leaves at the rim: 2000 wide and 1 apart.
    Json scene = {{"hemi", 1},
                  {"materials", {{"hot", {{"emissivity", 0.8}}}, {"cold", {{"emissivity", 0.3}}}}},
                  {"surfaces",
                   {face("oben ü", "hot", {{0, 0, 1}, {0, 2000, 1}, {2000, 2000, 1}, {2000, 0, 1}}, 1),
                    face("unten", "cold", {{0, 0, 0}, {2000, 0, 0}, {2000, 2000, 0}, {0, 2000, 0}}, 1)}},
                  {"unit", "m"}};
    const std::string file = directory.write("plates.json", scene);
    const std::string npz = directory.path("plates.npz");
    const Outcome run = run_hemi(on_cpu({"exchange", file, "--json", "--preset", "exact", "-o", npz}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json exchange = run.json();
    CHECK(exchange["script_f"][0][1].get<double>() ==
          Approx(1.0 / (1.0 / 0.8 + 1.0 / 0.3 - 1.0)).epsilon(2e-3));
    const std::string archive = directory.read("plates.npz");
    CHECK(archive.starts_with("PK"));
    for (const char* name : {"groups.npy", "areas.npy", "emissivity.npy", "gebhart.npy", "script_f.npy",
                             "conductance.npy", "environment.npy"}) {
        CHECK(archive.find(name) != std::string::npos);
    }
    CHECK(archive.find("'descr': '<U6', 'fortran_order': False, 'shape': (2,)") != std::string::npos);
    CHECK(archive.find("'descr': '<f8', 'fortran_order': False, 'shape': (2, 2)") != std::string::npos);
    const double area = exchange["areas"][0].get<double>();
    CHECK(archive.find(std::string(reinterpret_cast<const char*>(&area), sizeof(area))) != std::string::npos);
    // Program, version, text, open or closed, reflection, N; areas, script-F, emissivities.
    REQUIRE(run_hemi(on_cpu({"exchange", file, "--preset", "exact", "-o", directory.path("plates.txt")}))
                .status == 0);
    std::istringstream table(directory.read("plates.txt"));
    std::string program;
    std::string version;
    std::array<int, 4> head{};
    table >> program >> version >> head[0] >> head[1] >> head[2] >> head[3];
    CHECK(head == std::array<int, 4>{0, 0, 1, 2});
    std::vector<double> numbers;
    for (double number = 0.0; table >> number;) {
        numbers.push_back(number);
    }
    REQUIRE(numbers.size() == 8);
    CHECK(numbers[0] == area);
    for (std::size_t k = 0; k < 4; ++k) {
        CHECK(numbers[2 + k] == exchange["script_f"][k / 2][k % 2].get<double>());
    }
    CHECK(numbers[6] == Approx(0.8).epsilon(1e-12));
    CHECK(numbers[7] == Approx(0.3).epsilon(1e-12));
    CHECK(run_hemi({"factors", directory.path("plates.txt")}).status != 0);
    CHECK(run_hemi({"heat", file, "--factors", directory.path("plates.txt")}).err_has("include reflection"));
    CHECK(run_hemi({"exchange", file, "-o", directory.path("plates.mtx")}).status == 2);
}

TEST_CASE("hemi heat -o PICTURE.png: temperatures and fluxes in false colours", "[cli][heat][gl]") {
    const Directory directory;
    const std::string file = directory.write("box.json", box(1, 2, 3, 2));
    const std::string kelvin = directory.path("kelvin.png");
    const auto draw = [&](const std::string& path, const Words& more) {
        Words words{"heat", file, "--device", "osmesa", "--no-estimate", "--size", "240x200", "-o", path};
        words.insert(words.end(), more.begin(), more.end());
        return run_hemi(words);
    };
    const Outcome run = draw(kelvin, {});
    INFO(run.err);
    REQUIRE(run.status == 0);
    CHECK(run.out_has("kelvin.png (240 x 200, temperature)"));
    CHECK(directory.read("kelvin.png").substr(1, 3) == "PNG");
    CHECK(draw(directory.path("celsius.png"), {"--celsius"}).status == 0);
    CHECK(draw(directory.path("flux.png"), {"--show", "flux"}).out_has("(240 x 200, flux)"));
    CHECK(directory.read("celsius.png") != directory.read("kelvin.png")); // by the legend alone
    CHECK(directory.read("flux.png") != directory.read("kelvin.png"));
    CHECK(draw(directory.path("flux.png"), {"--show", "flux", "--celsius"}).status == 2);
    CHECK(draw(directory.path("flux.png"), {"--show", "power"}).err_has("temperature"));
    CHECK(draw(directory.path("flux.png"), {"--show", "temprature"}).err_has("did you mean temperature?"));
    CHECK(draw(directory.path("flux.png"), {"--show", "error"}).status == 2);
    CHECK(draw(directory.path("g.png"), {"--show", "irradiance", "--range", "0,2000", "--map", "inferno"})
              .out_has("(240 x 200, irradiance)"));
    CHECK(draw(directory.path("plain.png"), {"--no-legend"}).status == 0);
    CHECK(draw(directory.path("plain.png"), {"--show", "radiosity", "--channel", "grene"}).status == 2);
    CHECK(directory.read("plain.png") != directory.read("kelvin.png"));
    const Outcome table = run_hemi({"heat", file, "-o", directory.path("box.vtp"), "--outlines"});
    CHECK(table.status == 2);
    CHECK(table.err_has("--outlines is for a picture"));
    CHECK(run_hemi({"heat", file, "--show", "flux"}).status == 2);
}
