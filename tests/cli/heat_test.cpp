#include "cli/heat_scenes.hpp"
#include "support/places.hpp"

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
    CHECK(table.starts_with("index,group,area,cx,cy,cz,nx,ny,nz,temperature,net_flux,net_power,emitted,"
                            "absorbed,irradiation,radiosity\n0,bottom,"));
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
    CHECK(table.substr(under, table.find('\n', under) - under).ends_with(",,0,0,,,,"));
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
    const Outcome much = run_hemi(
        {"heat", scene, "--factors", directory.write("H.csv", "i,j,F\n0,2,1.5\n1,3,1\n2,0,1\n3,1,1\n")});
    CHECK(much.status == 3);
    CHECK(much.err_has("H.csv: the factors of row 0 add up to 1.5; must be at most 1"));
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
    CHECK(closed == 6);
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
          "[cli][heat][scenes][sun][slow]") {
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
    refused("time,left\n0 h,0\n# a comment\n1 h,-50000\n", "bad.csv: line 4 (\"1 h\"): group left");
    refused("bottom,top\n550,300\n", "the first column is called bottom, which is a group");
    refused("time,bottom,bottom\n0,300,300\n", "bad.csv: two columns \"bottom\"");

    // Lines in a table; other files hold the scene's own state, which is told. Temperatures in °C likewise.
    const std::string lines = directory.path("lines.csv");
    const Outcome written =
        run_hemi(on_cpu({"heat", scene, "--series", directory.write("cold.csv", "time,top\n0 h,20\n1 h,25\n"),
                         "-o", lines, "--fluxes", fluxes}));
    INFO(written.err);
    REQUIRE(written.status == 0);
    CHECK(written.err_has("--fluxes: what the scene itself says, not a line of the series"));
    CHECK(written.err_has("column top has 25 K at most"));
    std::istringstream table(directory.read("lines.csv"));
    std::string header;
    std::string first;
    REQUIRE(std::getline(table, header));
    REQUIRE(std::getline(table, first));
    CHECK(header.starts_with("time,temperature_bottom,temperature_top,"));
    CHECK(header.ends_with(",net_power_back,environment_power"));
    CHECK(first.starts_with("0 h,550,20,"));
    CHECK(run_hemi(on_cpu({"heat", scene, "-o", lines})).err_has("--fluxes writes"));
}

TEST_CASE("hemi heat: what is isothermal stays so by another power", "[cli][heat]") {
    const Directory directory;
    Json scene = box(1, 2, 3, 3);
    scene["groups"]["back"] = {{"power", 100}, {"isothermal", true}};
    const Json own = run_hemi(on_cpu({"heat", directory.write("a.json", scene), "--json"})).json();
    scene["groups"]["back"]["power"] = 0;
    const Json given =
        run_hemi(on_cpu({"heat", directory.write("b.json", scene), "--power", "back=100", "--json"})).json();
    CHECK(given["temperature"] == own["temperature"]);
}

TEST_CASE("hemi heat: areas of a table are in the scene's unit, powers in W", "[cli][heat]") {
    const Directory directory;
    const auto powers = [&](const Json& scene, Words more) {
        const std::string file = directory.path("power.csv");
        more.insert(more.begin(), {"heat", directory.write("scene.json", scene), "--fluxes", file, "-q"});
        const Outcome run = run_hemi(on_cpu(std::move(more)));
        REQUIRE(run.status == 0);
        std::istringstream table(directory.read("power.csv"));
        std::string line;
        REQUIRE(std::getline(table, line));
        CHECK(line.starts_with("index,group,area,cx,cy,cz,nx,ny,nz,temperature,net_flux,net_power,"));
        std::vector<double> result;
        while (std::getline(table, line)) {
            std::istringstream cells(line);
            std::string cell;
            for (int k = 0; k < 12; ++k) {
                std::getline(cells, cell, ',');
            }
            result.push_back(std::stod(cell));
        }
        return result;
    };
    const std::vector<double> metres = powers(box(1, 2, 3), {});
    const std::vector<double> millimetres = powers(box(1000, 2000, 3000), {"--unit", "mm"});
    REQUIRE(metres.size() == 6);
    for (std::size_t i = 0; i < 6; ++i) {
        CHECK(millimetres[i] == Approx(metres[i]).epsilon(1e-9).margin(1e-6));
    }
    CHECK(std::abs(metres[0]) > 100.0);
}

TEST_CASE("hemi heat: what meets backs is told", "[cli][heat]") {
    const Directory directory;
    Json scene = box(1, 2, 3);
    scene["surfaces"].push_back({{"name", "baffle"},
                                 {"material", "side"},
                                 {"polygon", {{0.2, 0.2, 1}, {0.8, 0.2, 1}, {0.8, 1.8, 1}, {0.2, 1.8, 1}}}});
    scene["groups"]["baffle"] = {{"temperature", 400}};
    const Outcome run = run_hemi(on_cpu({"heat", directory.write("baffle.json", scene), "--json"}));
    INFO(run.err);
    CHECK(run.err_has("of the radiation meets backs of one-sided surfaces, most of it from bottom"));
    const Json balance = run.json()["balance"];
    CHECK(balance["backs"].get<double>() > 0.05);
    CHECK(balance["emitted"].get<double>() > 1000.0);
    const Json whole = run_hemi(on_cpu({"heat", directory.write("box.json", box(1, 2, 3)), "--json"})).json();
    CHECK(whole["balance"]["backs"] == 0.0);
    CHECK(whole["balance"]["emitted"].get<double>() ==
          Approx(whole["balance"]["absorbed"].get<double>()).epsilon(1e-9));
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
