#include "viewer/workplace.hpp"

#include "hemi/io/result_file.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace hemi;
using namespace hemi::viewer_test;

TEST_CASE("Viewer: a second result that is dropped on the first shows the difference", "[viewer][gl]") {
    const Workplace place;
    REQUIRE(place.view("save-result a.hres\nset exitance 10,9,6 lamp\nsave-result b.hres\n", small) == 0);
    place.write("script.txt", "report alone.json\ndrop b.hres\nreport dropped.json\nscreenshot dropped.png\n"
                              "command command.txt\nwindowshot panel.png\nshow irradiance\n"
                              "map viridis\nscreenshot irradiance.png\ncommand irradiance.txt\n"
                              "difference off\nreport off.json\ndifference on\nshow picture\n"
                              "report picture.json\nreload\nreport again.json\n"
                              "drop room.json\nreport scene.json\n");
    const int status = place.run(Workplace::view_command("a.hres", "--size 708x400"));
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.json("alone.json")["compared"].is_null());
    const auto dropped = place.json("dropped.json");
    CHECK(dropped["compared"].get<std::string>().ends_with("b.hres"));
    CHECK(dropped["difference"] == true);
    CHECK(dropped["quantity"] == "radiosity");
    const Solution a = io::read_hres(place.path("a.hres")).solution;
    const Solution b = io::read_hres(place.path("b.hres")).solution;
    REQUIRE(dropped["values"].size() * 3 == a.radiosity.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < dropped["values"].size(); ++i) {
        double mean = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            mean += (b.radiosity[3 * i + c] - a.radiosity[3 * i + c]) / 3.0;
        }
        CHECK(dropped["values"][i].get<double>() == Approx(mean));
        largest = i < 36 || i >= 72 ? std::max(largest, std::abs(mean)) : largest; // lamps do not count
    }
    CHECK(dropped["scale"]["map"] == "cool-warm");
    CHECK(dropped["scale"]["high"].get<double>() == Approx(largest));
    CHECK(dropped["scale"]["low"].get<double>() == Approx(-largest));
    CHECK(dropped["groups"][0]["mean"].get<double>() < 0.0);
    CHECK(place.json("off.json")["difference"] == false);
    CHECK(place.json("off.json")["values"][0].get<double>() > 0.0);
    CHECK(place.json("picture.json")["difference"] == false); // of light there is none
    CHECK(place.json("again.json")["compared"] == dropped["compared"]);
    CHECK(place.json("scene.json")["compared"].is_null());
    for (const std::string name : {"command", "irradiance"}) {
        const std::string command = place.read(name + ".txt");
        INFO(command);
        CHECK(command.starts_with("hemi diff a.hres b.hres "));
        place.write("draw.sh", command);
        REQUIRE(place.run(fmt::format("PATH='{}':$PATH sh draw.sh",
                                      std::filesystem::path(HEMI_PROGRAM).parent_path().string())) == 0);
        CHECK(place.read("a.png") == place.read(name == "command" ? "dropped.png" : "irradiance.png"));
    }

    // Named together, they are compared at once; a result is compared with no scene.
    place.write("script.txt", "report named.json\n");
    REQUIRE(place.run(Workplace::view_command("a.hres b.hres", "--size 300x200")) == 0);
    CHECK(place.json("named.json")["values"] == dropped["values"]);
    CHECK(place.run(Workplace::view_command("a.hres room.json", "--size 300x200")) == 2);

    // What cannot be compared ends the difference, not the window.
    std::string lumens = place.read("room.json");
    replace(lumens, R"(, "exitance": [20, 18, 12])", "");
    replace(lumens, R"("name": "ceiling")", R"("name": "ceiling", "luminous_flux": [20, 18, 12])");
    place.write("lumens.json", lumens);
    REQUIRE(place.run(fmt::format("'{}' solve lumens.json --result lumens.hres --device osmesa -q",
                                  HEMI_PROGRAM)) == 0);
    place.write("script.txt", "report lumens-and-watts.json\n");
    const int ended = place.run(Workplace::view_command("a.hres lumens.hres", "--size 300x200"));
    INFO(place.read("errors.txt"));
    REQUIRE(ended == 0);
    CHECK(place.json("lumens-and-watts.json")["difference"] == false);
}

TEST_CASE("Viewer: what check finds is shown in colours, and gone to", "[viewer][gl]") {
    const Workplace place;
    std::string wrong = place.read("room.json");
    replace(wrong, "[[0,0,0],[0,1,0],[0,1,1],[0,0,1]]", "[[0,0,0],[0,0,1],[0,1,1],[0,1,0]]"); // turned
    replace(wrong, R"("surfaces": [)", // and a mat above the floor
            R"("surfaces": [{"name": "mat", "material": "white",
                            "polygon": [[0.3,0.3,0.02],[0.7,0.3,0.02],[0.7,0.7,0.02],[0.3,0.7,0.02]]},)");
    place.write("room.json", wrong);
    const int status =
        place.view("screenshot light.png\nshow findings\nreport found.json\n"
                   "screenshot findings.png\nfinding reversed 1\nreport there.json\n"
                   "click 150 100\nreport clicked.json\nfinding buried 1\nreport buried.json\n",
                   small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    (void)place.run(fmt::format("'{}' check room.json --device osmesa --preset plain --resolution 32 --json",
                                HEMI_PROGRAM));
    const auto check = place.json("out.txt");
    const auto found = place.json("found.json")["findings"];
    CHECK(found["buried"].size() == check["covered"]["count"]);
    CHECK(found["buried"].size() >= 4);
    CHECK(found["partly-buried"].size() == check["straddled"]["count"]);
    CHECK(found["back-faces"].size() == check["blocked"]["count"]);
    CHECK(found["near"].size() == check["near"]["count"]);
    CHECK(found["unseen"].size() == check["unseen"]["count"]);
    CHECK(found["reversed"].size() == 36);
    for (const auto& patch : found["reversed"]) { // the mat is patch 0
        CHECK(patch.get<std::size_t>() >= 1 + 2 * 36);
        CHECK(patch.get<std::size_t>() < 1 + 3 * 36);
    }
    CHECK(place.read("findings.png") != place.read("light.png"));
    // One looks at its front, from near.
    const auto there = place.json("there.json");
    CHECK(there["picked"] == found["reversed"][0]);
    CHECK(there["camera"]["target"][0].get<double>() == Approx(0.0).margin(1e-12));
    CHECK(there["camera"]["eye"][0].get<double>() < -0.1);
    CHECK(place.json("clicked.json")["picked"] == found["reversed"][0]);
    CHECK(place.json("buried.json")["picked"] == found["buried"][0]);
    CHECK(place.json("buried.json")["camera"]["eye"][2].get<double>() > 0.0);
    CHECK(place.view("finding leak 100000\n", small) == 3);
    CHECK(place.view("finding holes 1\n", small) == 3);
}
