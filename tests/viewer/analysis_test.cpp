#include "viewer/workplace.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <vector>

using namespace hemi::viewer_test;

TEST_CASE("Viewer: a line between two points has a length and the values along it", "[viewer][gl]") {
    const Workplace place;
    // Two points of the back wall, in its third row of patches from below; see the test of clicks.
    const int status =
        place.view("show irradiance\nmeasure 130 105 170 105\nreport line.json\n"
                   "save-probe line.csv\nwindowshot line.png\nshow radiosity\nreport other.json\n"
                   "key Escape\nreport closed.json\nkey D\nclick 130 105\nreport half.json\n"
                   "click 150 105\nreport clicked.json\n",
                   small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto report = place.json("line.json");
    const auto line = report["line"];
    REQUIRE(line.is_object());
    const double unit = 200.0 / (2.0 * std::tan(std::acos(-1.0) / 12.0) * 3.4); // pixels a length of 1
    CHECK(line["length"].get<double>() == Approx(40.0 / unit).epsilon(1e-9));
    CHECK(line["ends"][0][1].get<double>() == Approx(1.0));
    REQUIRE(line["values"].size() == 201);
    // The pixel's upper left corner is clicked: columns of patches are 1/6.
    const auto patch = [&](double share) {
        const double u = 0.5 + (130.0 + 40.0 * share - 150.0) / unit;
        return 4 * 36 + 2 * 6 + static_cast<std::size_t>(u * 6.0);
    };
    std::size_t wrong = 0;
    for (std::size_t k = 0; k <= 200; ++k) {
        const auto value = line["values"][k];
        wrong += value == report["values"][patch(static_cast<double>(k) / 200.0)] ? 0 : 1;
    }
    CHECK(wrong <= 2); // on the edges between patches
    std::istringstream csv(place.read("line.csv"));
    std::string row;
    std::getline(csv, row);
    CHECK(row == "length,x,y,z,patch,irradiance");
    std::size_t rows = 0;
    double last = 0.0;
    while (std::getline(csv, row)) {
        ++rows;
        last = std::stod(row);
    }
    CHECK(rows == 201);
    CHECK(last == Approx(40.0 / unit));
    CHECK(place.json("other.json")["line"]["values"] != line["values"]);
    CHECK(place.json("closed.json")["line"].is_null());
    CHECK(place.json("half.json")["line"].is_null());
    CHECK(place.json("half.json")["picked"].is_null()); // clicks measure
    CHECK(place.json("clicked.json")["line"]["length"].get<double>() == Approx(20.0 / unit).epsilon(1e-9));
    CHECK(place.view("measure 130 100 2 2\n", small) == 2);
    CHECK(place.view("save-probe line.csv\n", small) == 2);
    CHECK(place.view("save-probe line.txt\n", small) == 3);
}

TEST_CASE("Viewer: the histogram is of area, and a drag over it chooses the range", "[viewer][gl]") {
    const Workplace place;
    // The legend is 380 wide at most, in the lower left; its bar ends 29 before its right edge.
    const int status = place.view("show irradiance\nreport whole.json\nwindowshot whole.png\n"
                                  "drag left 100 350 200 350\nreport part.json\nwindowshot part.png\n"
                                  "click 150 350\nclick 150 350\nreport again.json\n"
                                  "drag left 60 298 60 268\ndrag left 100 320 200 320\nreport moved.json\n",
                                  with_panel);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto sum = [](const nlohmann::json& report) {
        const auto shares = report["histogram"].get<std::vector<double>>();
        return std::accumulate(shares.begin(), shares.end(), 0.0);
    };
    const auto whole = place.json("whole.json");
    CHECK(sum(whole) == Approx(1.0));
    const double low = whole["scale"]["low"];
    const double high = whole["scale"]["high"];
    const auto part = place.json("part.json");
    const double right = 10.0 + (328.0 - 20.0) - 29.0;
    CHECK(part["scale"]["low"].get<double>() ==
          Approx(low + (high - low) * (100.0 - 33.0) / (right - 33.0)).epsilon(1e-4));
    CHECK(part["scale"]["high"].get<double>() ==
          Approx(low + (high - low) * (200.0 - 33.0) / (right - 33.0)).epsilon(1e-4));
    // What is beyond is in none of its steps; patches are all of one size.
    const auto values = whole["values"].get<std::vector<double>>();
    const auto inside = std::count_if(values.begin(), values.end(), [&](double value) {
        return value >= part["scale"]["low"].get<double>() && value <= part["scale"]["high"].get<double>();
    });
    CHECK(sum(part) == Approx(static_cast<double>(inside) / static_cast<double>(values.size())));
    CHECK(place.json("again.json")["scale"]["low"].get<double>() == low);
    CHECK(part["camera"] == whole["camera"]); // the drag was not the scene's
    // Its title moves it.
    CHECK(place.json("moved.json")["scale"] == part["scale"]);
    CHECK(place.json("moved.json")["camera"] == whole["camera"]);
    // No range that a drag can give closes the window.
    REQUIRE(place.view("show irradiance\nrange -200 -100\nkey L\nreport negative.json\n", small) == 0);
    CHECK(place.json("negative.json")["scale"]["logarithmic"] == false);
}

TEST_CASE("Viewer: cameras are kept beside the scene", "[viewer][gl]") {
    const Workplace place;
    const int status =
        place.view("key 7\nkey ctrl+2\nscreenshot top.png\nkey R\nkey alt+2\nscreenshot back.png\n"
                   "key 5\nkey ctrl+9\nreport nine.json\nkey R\nreport home.json\nkey alt+3\n"
                   "report none.json\n",
                   small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.read("back.png") == place.read("top.png"));
    CHECK(place.json("none.json")["camera"] == place.json("home.json")["camera"]);
    REQUIRE(place.has("room.json.cameras"));
    REQUIRE(place.view("key alt+9\nreport kept.json\n", small) == 0);
    CHECK(place.json("kept.json")["camera"] == place.json("nine.json")["camera"]);
    CHECK(place.json("kept.json")["camera"] != place.json("home.json")["camera"]);
    // A file that is none of these is told of, and the scene is shown all the same.
    place.write("room.json.cameras",
                "{\"schema\": \"hemi/cameras/1\", \"cameras\": {\"1\": {\"eye\": [0]}}}");
    REQUIRE(place.view("report broken.json\n", small) == 0);
    CHECK(place.json("broken.json")["message"].get<std::string>().find("room.json.cameras: ") !=
          std::string::npos);
}

TEST_CASE("Viewer: an orthographic picture says that backs are not drawn where it hides some",
          "[viewer][gl]") {
    const Workplace place;
    // From the left one looks at the back of the left wall, from the front into the room.
    const int status = place.view("key 5\nkey 1\nreport front.json\nkey shift+3\nreport left.json\n"
                                  "screenshot empty.png\nkey B\nreport shown.json\nkey B\nkey 5\n"
                                  "report perspective.json\n",
                                  small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.json("front.json")["hides_backs"] == false);
    CHECK(place.json("left.json")["hides_backs"] == true);
    CHECK(place.json("shown.json")["hides_backs"] == false);
    CHECK(place.json("perspective.json")["hides_backs"] == false);
}

TEST_CASE("Viewer: axes and a scale bar are drawn over the scene, and can be left out", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("windowshot with.png\nkey U\nwindowshot without.png\n"
                                  "screenshot picture.png\nkey U\nkey 5\nwindowshot parallel.png\n",
                                  with_panel);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.read("with.png") != place.read("without.png"));
    CHECK(place.read("parallel.png") != place.read("with.png"));
}

TEST_CASE("Viewer: one walks by W, A, S and D, and looks around", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("report home.json\nkey J\nkey W\nkey shift+W\nreport ahead.json\n"
                                  "key D\nkey S\nreport aside.json\ndrag left 100 100 160 100\n"
                                  "report turned.json\nkey Escape\nkey W\nreport end.json\n",
                                  small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto eye = [&](const char* name) {
        return place.json(name)["camera"]["eye"].get<std::vector<double>>();
    };
    const double step = 0.01 * std::sqrt(3.0); // the room is 1 x 1 x 1, the camera looks along +y
    CHECK(eye("ahead.json")[1] == Approx(-2.4 + 5.0 * step));
    CHECK(eye("ahead.json")[0] == Approx(0.5));
    CHECK(eye("aside.json")[1] == Approx(-2.4 + 4.0 * step));
    CHECK(eye("aside.json")[0] == Approx(0.5 + step));
    CHECK(eye("turned.json") == eye("aside.json"));
    CHECK(place.json("turned.json")["camera"]["target"] != place.json("aside.json")["camera"]["target"]);
    CHECK(eye("end.json") == eye("turned.json")); // W draws outlines again
}

TEST_CASE("Viewer: window and panels are as large as the monitor's scale asks for", "[viewer][gl]") {
    const Workplace place;
    place.write("script.txt", "windowshot large.png\nshow irradiance\ndrag left 150 525 300 525\n"
                              "report large.json\n");
    // At a scale of 1.5 the window would be larger than the monitor: it becomes as large as that.
    const std::string view = Workplace::view_command(
        "room.json", "--device osmesa --size 1600x900 --preset plain --resolution 32");
    const std::size_t program = view.find('\'' + std::string(HEMI_PROGRAM));
    REQUIRE(program != std::string::npos);
    place.write("large.sh",
                "xprop -root -f RESOURCE_MANAGER 8s -set RESOURCE_MANAGER \"Xft.dpi: 144\n\" && " +
                    view.substr(program));
    // A display that does not forget what was set when no other program uses it.
    const std::string display = hemi::test::virtual_display("Xauthority", "1062x600x24 -noreset");
    REQUIRE(place.run(display + " sh large.sh") == 0);
    const std::string picture = place.read("large.png");
    REQUIRE(picture.size() > 24);
    CHECK(picture.substr(16, 8) == std::string("\0\0\x04\x26\0\0\x02\x58", 8)); // 1062 x 600
    // The same drag over the legend as at a scale of 1 chooses the same range.
    REQUIRE(place.view("show irradiance\ndrag left 100 350 200 350\nreport usual.json\n", with_panel) == 0);
    for (const char* end : {"low", "high"}) {
        CHECK(place.json("large.json")["scale"][end].get<double>() ==
              Approx(place.json("usual.json")["scale"][end].get<double>()));
    }
}
