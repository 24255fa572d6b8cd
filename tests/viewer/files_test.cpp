#include "support/places.hpp"
#include "viewer/workplace.hpp"

#include "hemi/io/result_file.hpp"

#include <cmath>

using namespace hemi;
using namespace hemi::viewer_test;

namespace {

/// Runs commands for a shell while the window is open: each of `steps` once the file named before it is
/// there.
int view_while(const Workplace& place, const std::string& script,
               const std::vector<std::pair<std::string, std::string>>& steps) {
    place.write("script.txt", script);
    std::string beside;
    for (const auto& [file, step] : steps) {
        beside +=
            fmt::format("for k in $(seq 600); do test -e {} && break; sleep 0.05; done; {}; ", file, step);
    }
    return place.run(fmt::format("{{ ({}) & {}; }}", beside,
                                 Workplace::view_command("room.json", "--device osmesa " + small)));
}

int run_in_shell(const Workplace& place, const std::string& file) {
    return place.run(fmt::format("PATH='{}':$PATH sh {}",
                                 std::filesystem::path(HEMI_PROGRAM).parent_path().string(), file));
}

} // namespace

TEST_CASE("Viewer: follows the file, and keeps the last good picture when that is broken", "[viewer][gl]") {
    const Workplace place;
    std::string dim = place.read("room.json");
    replace(dim, "[20, 18, 12]", "[2, 1.8, 1.2]");
    place.write("dim.json", dim);
    place.write("broken.json", dim.substr(0, dim.size() / 2));
    const int status = view_while(place,
                                  "drag left 150 100 190 80\nclick 150 100\nreport first.json\n"
                                  "screenshot first.png\n"
                                  "changed\nreport broken_report.json\nscreenshot kept.png\n"
                                  "changed\nreport second.json\nscreenshot second.png\n",
                                  {{"first.png", "mv broken.json room.json"},
                                   {"kept.png", "cp dim.json new.json; mv new.json room.json"}});
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto first = place.json("first.json");
    const auto broken = place.json("broken_report.json");
    const auto second = place.json("second.json");
    CHECK(first["message"] == "");
    CHECK(broken["message"].get<std::string>().find("room.json:") != std::string::npos);
    CHECK(place.read("kept.png") == place.read("first.png"));
    CHECK(second["message"] == "");
    CHECK(second["camera"] == first["camera"]);
    CHECK(second["picked"] == first["picked"]);
    CHECK(second["radiosity"][0][0].get<double>() ==
          Approx(0.1 * first["radiosity"][0][0].get<double>()).epsilon(1e-5));
}

TEST_CASE("Viewer: groups stay hidden, and changes can be had back, when the file changes", "[viewer][gl]") {
    const Workplace place;
    std::string more = place.read("room.json");
    replace(more, R"("surfaces": [)", R"("surfaces": [{"name": "mat", "material": "white",
        "polygon": [[0.3,0.3,0.1],[0.7,0.3,0.1],[0.7,0.7,0.1],[0.3,0.7,0.1]]},)");
    place.write("more.json", more);
    const int status = view_while(place,
                                  "hide left\nselect right\nset reflectance 0.1 white\nscreenshot first.png\n"
                                  "changed\nreport second.json\nkey ctrl+Z\nwait\nreport undone.json\n"
                                  "key ctrl+shift+Z\nwait\nreport redone.json\n",
                                  {{"first.png", "mv more.json room.json"}});
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto second = place.json("second.json");
    REQUIRE(second["groups"].size() == 6);
    for (const auto& group : second["groups"]) {
        CHECK(group["visibility"] == (group["name"] == "left" ? "hidden" : "shown"));
    }
    CHECK(second["groups"][second["group"].get<std::size_t>()]["name"] == "right");
    const auto bright = [](const nlohmann::json& report) { // of the floor, which is white
        return report["radiosity"][1][0].get<double>();
    };
    CHECK(bright(place.json("undone.json")) < 0.5 * bright(second));
    CHECK(place.json("redone.json")["radiosity"] == second["radiosity"]);
}

TEST_CASE("Viewer: a file that is dropped on the window is opened", "[viewer][gl]") {
    const Workplace place;
    std::string other = place.read("room.json");
    replace(other, R"("patches": [6, 6])", R"("patches": [2, 3])");
    place.write("other room.json", other);
    const int status =
        place.view("click 150 100\nsave-result room.hres\nscreenshot room.png\n"
                   "drop other room.json\nreport other.json\n"
                   "drop room.hres\nreport result.json\nscreenshot result.png\n"
                   "drop missing.obj\nreport missing.json\ndrop script.txt\nreport wrong.json\n",
                   small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.json("other.json")["radiosity"].size() == 4 * 36 + 6);
    CHECK(place.json("other.json")["picked"].is_null());
    CHECK(place.json("result.json")["radiosity"].size() == 5 * 36);
    CHECK(place.read("result.png") == place.read("room.png"));
    CHECK(place.json("missing.json")["message"].get<std::string>().find("missing.obj") != std::string::npos);
    CHECK(place.json("wrong.json")["message"].get<std::string>().find("script.txt") != std::string::npos);
    CHECK(place.json("wrong.json")["radiosity"].size() == 5 * 36);
}

TEST_CASE("Viewer: a result that is saved is drawn by render as the window shows it", "[viewer][gl]") {
    const Workplace place;
    const int status =
        place.view("set reflectance 0.3,0.5,0.6 white\ndrag left 150 100 190 80\nkey 5\nkey B\n"
                   "key E\nkey S\nkey W\nfov 25\nscreenshot 200x120 2 window.png\n"
                   "save-result changed.hres\ncommand command.txt\nreport light.json\n",
                   small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    // The command draws what the window shows, which is larger and finer.
    std::string command = place.read("command.txt");
    CHECK(command.starts_with("hemi render changed.hres -o room.png --size 300x200 "));
    replace(command, "--size 300x200", "--size 200x120 --samples 2 --device osmesa");
    place.write("draw.sh", command);
    REQUIRE(run_in_shell(place, "draw.sh") == 0);
    CHECK(place.read("room.png") == place.read("window.png"));
    REQUIRE(place.run(fmt::format("'{}' info changed.hres", HEMI_PROGRAM)) == 0);
}

TEST_CASE("Viewer: the command line it copies draws the same picture from the scene", "[viewer][gl]") {
    const Workplace place;
    const int status =
        place.view("drag left 150 100 190 80\nkey T\nkey E\nscreenshot window.png\ncommand command.txt\n",
                   small + " --seed 3 --environment 1,2,0.5");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const std::string command = place.read("command.txt");
    CHECK(command.starts_with("hemi solve room.json "));
    CHECK(command.find("--script") == std::string::npos);
    place.write("draw.sh", command);
    REQUIRE(run_in_shell(place, "draw.sh") == 0);
    CHECK(place.read("room.png") == place.read("window.png"));
    CHECK(place.view("show items\ncommand a.txt\n", small) == 2);
    CHECK(place.view("set exitance 1 white\ncommand a.txt\n", small) == 2);
}

TEST_CASE("Viewer: a camera that is saved into the scene is where it begins next time", "[viewer][gl]") {
    const Workplace place;
    REQUIRE(place.view("drag left 150 100 190 80\nscroll 100 100 2\nfov 50\nsave-camera\nreport saved.json\n"
                       "screenshot saved.png\nkey 7\n",
                       small) == 0);
    REQUIRE(place.view("report begun.json\nscreenshot begun.png\nkey 7\nkey R\nscreenshot reset.png\n",
                       small) == 0);
    CHECK(place.json("begun.json")["camera"] == place.json("saved.json")["camera"]);
    CHECK(place.read("begun.png") == place.read("saved.png"));
    CHECK(place.read("reset.png") == place.read("saved.png"));
    CHECK(place.json("begun.json")["camera"]["fov"] == 50.0);
}

TEST_CASE("Viewer: materials that were changed can be written into the scene", "[viewer][gl]") {
    const Workplace place;
    REQUIRE(place.view(
                "set reflectance 0.25 white\nset exitance 5,6,7 lamp\nset environment 1\nreport light.json\n"
                "save-materials\nreload\nkey Q\nreport never.json\n",
                small) == 0);
    CHECK_FALSE(place.has("never.json")); // nothing is unsaved
    REQUIRE(place.view("report again.json\n", small) == 0);
    const auto light = place.json("light.json")["radiosity"];
    const auto again = place.json("again.json")["radiosity"];
    REQUIRE(again.size() == light.size());
    for (std::size_t i = 0; i < light.size(); i += 7) {
        CHECK(again[i][0].get<double>() == Approx(light[i][0].get<double>()).epsilon(2e-5));
    }
    CHECK(place.view("save-materials\n", small) == 2); // nothing was changed
    CHECK(place.read("errors.txt").find("no material") != std::string::npos);
}

TEST_CASE("Viewer: screenshots have the size and the samples that are asked for", "[viewer][gl]") {
    const Workplace place;
    REQUIRE(
        place.view("screenshot 640x77 1 one.png\nscreenshot 640x77 eight.png\nscreenshot 640x77 8 many.png\n"
                   "screenshot 640x.png\n",
                   small) == 0);
    CHECK(place.read("one.png").substr(16, 8) == std::string("\0\0\x02\x80\0\0\0\x4D", 8));
    CHECK(place.read("one.png") != place.read("many.png"));
    CHECK(place.read("eight.png") != place.read("many.png"));
    CHECK(place.has("640x.png"));
    CHECK(place.view("screenshot 0x77 a.png\n", small) == 3);
    CHECK(place.view("screenshot 10x77\n", small) == 3);
}

TEST_CASE("Viewer: quantities have the pixels that hemi render draws of them", "[viewer][gl]") {
    const Workplace place;
    std::string script = "save-result room.hres\n";
    const std::vector<std::string> quantities{"radiosity",   "irradiance", "exitance",
                                              "reflectance", "emissivity", "environment",
                                              "row-error",   "error",      "area"};
    for (const std::string& quantity : quantities) {
        script += "show " + quantity + "\nscreenshot " + quantity + ".png\ncommand " + quantity + ".txt\n";
    }
    script +=
        "show irradiance\nchannel sum\nmap turbo\nrange 0.1 2\nkey L\nscreenshot own.png\n"
        "command own.txt\nreport own.json\nshow exitance\nreport other.json\n"; // with a scale of its own
    REQUIRE(place.view(script, small) == 0);
    std::vector<std::string> all = quantities;
    all.emplace_back("own");
    std::vector<std::string> seen;
    for (const std::string& name : all) {
        INFO(name);
        const std::string window = place.read(name + ".png");
        const std::string command = place.read(name + ".txt");
        INFO(command);
        CHECK(command.starts_with("hemi render room"));
        place.write("draw.sh", command);
        REQUIRE(run_in_shell(place, "draw.sh") == 0);
        const bool same = place.read("room.png") == window;
        CHECK(same);
        CHECK(std::find(seen.begin(), seen.end(), window) == seen.end());
        seen.push_back(window);
    }
    CHECK(place.json("own.json")["scale"] == nlohmann::json({{"low", 0.1},
                                                             {"high", 2.0},
                                                             {"logarithmic", true},
                                                             {"map", "turbo"},
                                                             {"bands", 0},
                                                             {"lines", nlohmann::json::array()}}));
    CHECK(place.json("other.json")["scale"]["high"] != 2.0);
    CHECK(place.view("show radiance\n", small) == 3);
    CHECK(place.read("errors.txt").find("radiosity") != std::string::npos);
    for (const char* wrong : {"map blue\n", "range 2 1\n", "range 1\n", "channel\n"}) {
        CHECK(place.view(wrong, small) == 3);
    }
    CHECK(place.view("channel infrared\n", small) == 2);
    CHECK(place.view("show direct\n", small) == 2);
}

TEST_CASE("Viewer: stored rows of a scene are used, given or dropped, and no others", "[viewer][gl]") {
    const Workplace place;
    const std::string rows = "--preset exact --patches-per-face 16";
    REQUIRE(place.run(fmt::format("'{}' solve room.json --device osmesa {} --factors room.hff --result "
                                  "solve.hres",
                                  HEMI_PROGRAM, rows)) == 0);
    REQUIRE(place.run(fmt::format("'{}' factors room.json --device osmesa --preset plain --resolution 32 -o "
                                  "other.hff",
                                  HEMI_PROGRAM)) == 0);
    REQUIRE(place.view("live\nclick 150 150\nshow row\nreport row.json\nwait\nreport given.json\n"
                       "show picture\ncommand line.txt\nreload\nreport again.json\nsave-result "
                       "window.hres\ndrop other.hff\nreport refused.json\n",
                       "--size 300x200 --patches-per-face 16 --factors room.hff") == 0);
    const auto row = place.json("row.json"); // at once
    CHECK(row["values"].size() == 80);
    const Solution solve = io::read_hres(place.path("solve.hres")).solution;
    const Solution window = io::read_hres(place.path("window.hres")).solution;
    REQUIRE(window.radiosity.size() == solve.radiosity.size());
    for (std::size_t k = 0; k < solve.radiosity.size(); ++k) {
        REQUIRE(window.radiosity[k] == Approx(solve.radiosity[k]).epsilon(1e-5));
    }
    CHECK(place.json("again.json")["radiosity"] == place.json("given.json")["radiosity"]);
    CHECK(place.read("line.txt").find("--factors room.hff") != std::string::npos);
    const auto refused = place.json("refused.json"); // of another geometry; what was open stays
    CHECK(refused["message"].get<std::string>().find("other.hff") != std::string::npos);
    CHECK(refused["radiosity"] == place.json("given.json")["radiosity"]);
    // Dropped on the scene that is open.
    REQUIRE(place.view("live\ncancel\ndrop room.hff\nreport dropped.json\n",
                       "--size 300x200 --preset exact --patches-per-face 16") == 0);
    CHECK(place.json("dropped.json")["radiosity"] == place.json("given.json")["radiosity"]);
}

TEST_CASE("Viewer: a scene that nothing lights is shown evenly lit, as hemi render draws it",
          "[viewer][gl]") {
    const Workplace place;
    std::string dark = place.read("room.json");
    replace(dark, "[20, 18, 12]", "[0, 0, 0]");
    place.write("room.json", dark);
    const int status = place.view("screenshot window.png\nreport dark.json\nsave-result dark.hres\n"
                                  "command command.txt\nset exitance 1 lamp\nreport lit.json\n",
                                  small + " --background '#304050'");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.json("dark.json")["light_note"].get<std::string>().find("evenly lit") != std::string::npos);
    CHECK(place.json("dark.json")["radiosity"][0][0] == 0.0);
    CHECK(place.read("command.txt").find("--background '#304050'") != std::string::npos);
    CHECK(place.json("lit.json")["light_note"] == "");
    place.write("draw.sh", place.read("command.txt"));
    REQUIRE(run_in_shell(place, "draw.sh") == 0);
    CHECK(place.read("room.png") == place.read("window.png"));
}

TEST_CASE("Viewer: temperatures and net fluxes have the pixels that hemi heat draws", "[viewer][gl][heat]") {
    const Workplace place;
    std::string hot = place.read("room.json");
    replace(hot, R"("channels": ["red", "green", "blue"],)", "");
    replace(hot, R"("red": {"reflectance": [0.6, 0.1, 0.1]})", R"("red": {"emissivity": 0.6})");
    replace(hot, R"("lamp": {"reflectance": 0, "exitance": [20, 18, 12]})", R"("lamp": {"emissivity": 0.9})");
    replace(hot, R"("camera")",
            R"("groups": {"ceiling": {"temperature": 700}, "floor": {"temperature": 300},
                          "left": {"heat_flux": 0}, "right": {"heat_flux": 0}, "back": {"heat_flux": 0}},
               "environment": {"temperature": 280}, "camera")");
    place.write("room.json", hot);
    const std::string options = "--size 300x200 --preset fast --resolution 32";
    const int status = place.view(
        "show temperature\nreport kelvin.json\nscreenshot temperature.png\ncommand temperature.txt\n"
        "show flux\nreport flux.json\nscreenshot flux.png\ncommand flux.txt\n"
        "set reflectance 0.5 lamp at 700 K\nshow temperature\nreport other.json\n"
        "set temperature 400 ceiling\nreport cool.json\nshow exitance\nreport emitted.json\n"
        "set reflectance 0.1 lamp at 700 K\n"
        "show flux\nreport cool_flux.json\n"
        "show temperature\nreport dark.json\nset environment 2000\nreport sky.json\n",
        options);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    REQUIRE(place.run(fmt::format("'{}' heat room.json --device osmesa --preset fast --resolution 32 --json "
                                  "--result heat.hres",
                                  HEMI_PROGRAM)) == 0);
    const auto table = place.json("out.txt");
    // Every wall has 36 patches of one area; of temperatures the mean is that of the fourth power.
    const auto mean = [&](const nlohmann::json& report, std::size_t wall, double power) {
        double sum = 0.0;
        for (std::size_t i = 36 * wall; i < 36 * (wall + 1); ++i) {
            sum += std::pow(report["values"][i].get<double>(), power) / 36.0;
        }
        return std::pow(sum, 1.0 / power);
    };
    for (std::size_t wall = 0; wall < 5; ++wall) {
        CHECK(mean(place.json("kelvin.json"), wall, 4.0) == Approx(table["temperature"][wall].get<double>()));
        CHECK(mean(place.json("flux.json"), wall, 1.0) ==
              Approx(table["net_flux"][wall].get<double>()).margin(1e-6));
    }
    CHECK(place.json("kelvin.json")["unit"] == "K");
    CHECK(mean(place.json("sky.json"), 2, 4.0) > mean(place.json("dark.json"), 2, 4.0) + 10.0); // adiabatic
    CHECK(place.json("cool.json")["values"][40] == 400.0);
    REQUIRE(place.run(fmt::format("'{}' heat room.json --device osmesa --preset fast --resolution 32 --json "
                                  "--temperature ceiling=400",
                                  HEMI_PROGRAM)) == 0);
    const auto cool = place.json("out.txt");
    for (std::size_t wall = 0; wall < 5; ++wall) {
        CHECK(mean(place.json("cool_flux.json"), wall, 1.0) ==
              Approx(cool["net_flux"][wall].get<double>()).margin(1e-6));
    }
    for (std::size_t i = 36; i < 72; ++i) { // the ceiling's light follows, too; it is warmed by nothing but
        CHECK(place.json("cool_flux.json")["radiosity"][i][0].get<double>() >= // itself and its reflection
              Approx(0.9 * 5.670374419e-8 * std::pow(400.0, 4.0)));
    }
    CHECK(place.json("emitted.json")["values"][40].get<double>() == // by the emissivity as it was then
          Approx(0.5 * 5.670374419e-8 * std::pow(400.0, 4.0)));
    CHECK(place.view("set temperature 400 left\n", options) == 2);
    CHECK(place.view("set temperature 400 ceiling\nsave-result a.hres\n", options) == 2);
    // A ceiling that emits less warms the walls less.
    CHECK(place.json("other.json")["values"][80].get<double>() <
          place.json("kelvin.json")["values"][80].get<double>() - 10.0);
    for (const std::string name : {"temperature", "flux"}) {
        const std::string command = place.read(name + ".txt");
        INFO(command);
        CHECK(command.starts_with("hemi heat room.json "));
        place.write("draw.sh", command);
        REQUIRE(run_in_shell(place, "draw.sh") == 0);
        CHECK(place.read("room.png") == place.read(name + ".png"));
    }
    CHECK(place.view("set reflectance 0.1 red\nshow flux\ncommand a.txt\n", options) == 2);

    // The stored result shows the same.
    place.write("script.txt", "show temperature\nreport stored.json\nscreenshot stored.png\nshow flux\n"
                              "report stored_flux.json\nclick 150 100\nreport picked.json\n");
    REQUIRE(place.run(Workplace::view_command("heat.hres", "--size 300x200")) == 0);
    const auto same = [&](const std::string& stored, const std::string& solved) {
        const auto is = place.json(stored)["values"];
        const auto was = place.json(solved)["values"];
        REQUIRE(is.size() == was.size());
        for (std::size_t i = 0; i < is.size(); ++i) {
            CHECK(is[i].get<double>() == Approx(was[i].get<double>()).margin(1e-6));
        }
    };
    same("stored.json", "kelvin.json");
    same("stored_flux.json", "flux.json");
    CHECK(place.read("stored.png") == place.read("temperature.png"));
    CHECK(place.json("picked.json")["picked"].is_number());
}
