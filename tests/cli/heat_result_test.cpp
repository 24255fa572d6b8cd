#include "cli/heat_scenes.hpp"

#include <catch2/catch.hpp>

#include <map>

using namespace hemi::cli_test;

namespace {

/// Cells of a column of a table, as text.
Words column(const std::string& text, const std::string& wanted) {
    std::istringstream lines(text);
    std::string line;
    Words found;
    std::size_t at = 0;
    for (bool first = true; std::getline(lines, line); first = false) {
        std::istringstream fields(line);
        Words cells;
        for (std::string cell; std::getline(fields, cell, ',');) {
            cells.push_back(cell);
        }
        if (line.ends_with(',')) {
            cells.emplace_back();
        }
        if (first) {
            at = static_cast<std::size_t>(std::find(cells.begin(), cells.end(), wanted) - cells.begin());
        }
        if (at >= cells.size()) {
            return {};
        }
        found.push_back(cells[at]);
    }
    return found;
}

} // namespace

TEST_CASE("hemi heat: a stored result has temperatures and net fluxes, for info, convert, diff and pictures",
          "[cli][heat]") {
    const Directory directory;
    const std::string scene = directory.write("box.json", box(1, 2, 3, 2));
    const std::string result = directory.path("a.hres");
    REQUIRE(run_hemi(on_cpu({"heat", scene, "--result", result, "--fluxes", directory.path("a.csv"), "-o",
                             directory.path("direct.png"), "--celsius", "--size", "120x90"}))
                .status == 0);
    REQUIRE(run_hemi({"convert", result, directory.path("b.csv")}).status == 0);
    for (const char* name : {"temperature", "net_flux"}) {
        const Words direct = column(directory.read("a.csv"), name);
        CHECK(direct.size() == 25);
        CHECK(column(directory.read("b.csv"), name) == direct);
    }
    REQUIRE(run_hemi({"convert", result, directory.path("b.vtp")}).status == 0);
    CHECK(directory.read("b.vtp").find("Name=\"net_flux\"") != std::string::npos);

    const Json info = run_hemi({"info", result, "--json"}).json();
    CHECK(info["temperature"]["min"].get<double>() == Approx(300.0));
    CHECK(info["temperature"]["max"].get<double>() == Approx(550.0));
    CHECK(info["net_flux"]["min"] < 0.0);
    CHECK(run_hemi({"info", result}).out_has("temperature   300 to 550 K"));

    const Outcome render = run_hemi({"render", result, "--show", "temperature", "--celsius", "--size",
                                     "120x90", "-o", directory.path("stored.png")});
    INFO(render.err);
    REQUIRE(render.status == 0);
    CHECK(directory.read("stored.png") == directory.read("direct.png"));
    CHECK(run_hemi({"render", result, "--show", "flux", "--celsius"}).err_has("--celsius needs --show temp"));

    REQUIRE(
        run_hemi(on_cpu({"heat", scene, "--temperature", "top=310", "--result", directory.path("c.hres")}))
            .status == 0);
    const Json diff =
        run_hemi({"diff", result, directory.path("c.hres"), "--show", "temperature", "--json"}).json();
    CHECK(diff["unit"] == "K");
    CHECK(diff["groups"][1] == "top");
    CHECK(diff["difference"][1].get<double>() == Approx(10.0));
    CHECK(diff["difference"][0] == 0.0);

    // A solution of light has none.
    const std::string light = directory.path("light.hres");
    REQUIRE(run_hemi(on_cpu({"solve", scene, "--result", light})).status == 0);
    CHECK(run_hemi({"info", light, "--json"}).json()["temperature"].is_null());
    const Outcome none = run_hemi({"render", light, "--show", "temperature"});
    CHECK(none.status == 2);
    CHECK(none.err_has("temperature: `hemi heat` finds it"));
}

TEST_CASE("hemi heat: mean radiant temperatures of a stored result are those of the scene", "[cli][heat]") {
    const Directory directory;
    Json room = box(1, 2, 3, 2);
    room["channels"] = {"red", "green", "blue"}; // of which heat makes one band
    const std::string scene = directory.write("box.json", room);
    const std::string points = directory.write("p.csv", "x,y,z,nx,ny,nz\n0.5,1,1,,,\n0.2,0.4,2,0,0,1\n");
    const std::string result = directory.path("a.hres");
    REQUIRE(run_hemi(on_cpu({"heat", scene, "--result", result})).status == 0);
    const Words how{"--points", points, "--person", "standing", "--device", "cpu", "--jobs", "1", "--json"};
    Words words{"points", scene};
    words.insert(words.end(), how.begin(), how.end());
    const Outcome of_scene = run_hemi(words);
    REQUIRE(of_scene.status == 0);
    words[1] = result;
    const Outcome of_result = run_hemi(words);
    INFO(of_result.err);
    REQUIRE(of_result.status == 0);
    const Json& is = of_result.json();
    const Json& was = of_scene.json();
    for (const char* key : {"irradiance", "sky", "mean_radiant_temperature"}) {
        CHECK(is[key] == was[key]);
    }
    CHECK(is["mean_radiant_temperature"][0].get<double>() > 300.0);
    CHECK(is["mean_radiant_temperature"][0].get<double>() < 550.0);

    const std::string light = directory.path("light.hres");
    REQUIRE(run_hemi(on_cpu({"solve", scene, "--result", light})).status == 0);
    const Outcome none = run_hemi({"points", light, "--points", points, "--person", "seated"});
    CHECK(none.status == 2);
    CHECK(none.err_has("--person needs temperatures, which"));
}

TEST_CASE("hemi heat: of buried patches and of emissivities by temperature, a stored result says what the "
          "scene does",
          "[cli][heat]") {
    const Directory directory;
    Json room = box(1, 1, 1, 4);
    room["materials"]["steel"] = {{"emissivity", {{300, 0.2}, {500, 0.8}}}};
    const auto side = [](std::vector<std::array<double, 3>> corners) {
        return face("load", "steel", Json(std::move(corners)), 2);
    };
    for (const Json& surface : {side({{0.2, 0.2, 0.4}, {0.8, 0.2, 0.4}, {0.8, 0.8, 0.4}, {0.2, 0.8, 0.4}}),
                                side({{0.2, 0.2, 0.0}, {0.2, 0.8, 0.0}, {0.8, 0.8, 0.0}, {0.8, 0.2, 0.0}}),
                                side({{0.2, 0.2, 0.0}, {0.8, 0.2, 0.0}, {0.8, 0.2, 0.4}, {0.2, 0.2, 0.4}}),
                                side({{0.8, 0.2, 0.0}, {0.8, 0.8, 0.0}, {0.8, 0.8, 0.4}, {0.8, 0.2, 0.4}}),
                                side({{0.8, 0.8, 0.0}, {0.2, 0.8, 0.0}, {0.2, 0.8, 0.4}, {0.8, 0.8, 0.4}}),
                                side({{0.2, 0.8, 0.0}, {0.2, 0.2, 0.0}, {0.2, 0.2, 0.4}, {0.2, 0.8, 0.4}})}) {
        room["surfaces"].push_back(surface);
    }
    room["groups"]["load"] = {{"temperature", 400}};
    room["groups"]["bottom"] = {{"heat_flux", 0}}; // what is under the load has no temperature
    room["groups"]["left"] = {{"temperature", 550}};
    const std::string scene = directory.write("furnace.json", room);
    const std::string result = directory.path("a.hres");
    const Outcome heat = run_hemi(on_cpu(
        {"heat", scene, "--no-imprint", "--result", result, "--fluxes", directory.path("a.csv"), "--json"}));
    INFO(heat.err);
    REQUIRE(heat.status == 0);
    CHECK(heat.json()["buried"].get<int>() >= 8); // of the floor and of the load
    REQUIRE(run_hemi({"convert", result, directory.path("b.csv")}).status == 0);
    for (const auto& [name, stored] :
         std::map<std::string, std::string>{{"temperature", "temperature"},
                                            {"net_flux", "net_flux"},
                                            {"radiosity", "radiosity_grey"},
                                            {"irradiation", "irradiance_grey"}}) {
        INFO(name);
        const Words direct = column(directory.read("a.csv"), name);
        CHECK(direct.size() == 6 * 16 + 6 * 4 + 1);
        const Words again = column(directory.read("b.csv"), stored);
        CHECK(Words(direct.begin() + 1, direct.end()) == Words(again.begin() + 1, again.end()));
    }
    const Words emissivity = column(directory.read("b.csv"), "emissivity_grey");
    CHECK(std::stod(emissivity.back()) == Approx(0.5)); // of the load at 400 K

    const std::string points =
        directory.write("p.csv", "x,y,z,nx,ny,nz\n0.5,0.5,0.7,,,\n0.1,0.1,0.05,0,0,1\n");
    Words words{"points",   scene,      "--no-imprint", "--points", points, "--person",
                "standing", "--device", "cpu",          "--jobs",   "1",    "--json"};
    const Json of_scene = run_hemi(words).json();
    words[1] = result;
    words.erase(words.begin() + 2);
    const Json of_result = run_hemi(words).json();
    for (const char* key : {"irradiance", "mean_radiant_temperature"}) {
        CHECK(of_result[key] == of_scene[key]);
    }
    CHECK(run_hemi({"bake", result, "-o", directory.path("a.ply")}).err_has("has heat, which is no light"));
}
