#include "viewer/workplace.hpp"

#include <cmath>

using namespace hemi::viewer_test;

namespace {

int run_in_shell(const Workplace& place, const std::string& file) {
    return place.run(fmt::format("PATH='{}':$PATH sh {}",
                                 std::filesystem::path(HEMI_PROGRAM).parent_path().string(), file));
}

std::string visibilities(const nlohmann::json& report) {
    std::string text;
    for (const auto& group : report["groups"]) {
        text += group["visibility"].get<std::string>().front();
    }
    return text;
}

} // namespace

TEST_CASE("Viewer: groups are selected, hidden and isolated by script, click and key", "[viewer][gl]") {
    const Workplace place;
    // The groups are floor, ceiling, left, right, back. The back wall is behind everything.
    const int status =
        place.view("report start.json\nscreenshot start.png\n"
                   "select ceiling\nreport selected.json\nkey N\nreport hidden.json\nscreenshot hidden.png\n"
                   "key I\nreport alone.json\nkey A\nreport all.json\nscreenshot all.png\n"
                   "click 150 100\nreport picked.json\nkey O\nreport outlined.json\nscreenshot outlined.png\n"
                   "click 150 100\nreport through.json\nshow-group back\nhide left\noutline floor\n"
                   "report words.json\nshow-all\nisolate right\nreport right.json\n"
                   "show-all\nclick 150 100\nshow row\nreport row.json\n",
                   small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto start = place.json("start.json");
    CHECK(visibilities(start) == "sssss");
    CHECK(start["group"].is_null());
    CHECK(start["groups"][1]["name"] == "ceiling");
    CHECK(start["groups"][1]["area"].get<double>() == Approx(1.0));
    // The ceiling is black: its radiosity is its exitance.
    CHECK(start["groups"][1]["mean"].get<double>() == Approx((20.0 + 18.0 + 12.0) / 3.0));
    CHECK(start["groups"][1]["net_power"].is_null());
    CHECK(place.json("selected.json")["group"] == 1);
    CHECK(visibilities(place.json("hidden.json")) == "shsss");
    CHECK(visibilities(place.json("alone.json")) == "hshhh");
    CHECK(visibilities(place.json("all.json")) == "sssss");
    CHECK(place.read("hidden.png") != place.read("start.png"));
    CHECK(place.read("all.png") == place.read("start.png"));
    CHECK(place.json("hidden.json")["radiosity"] == start["radiosity"]); // it still shines
    CHECK(place.json("picked.json")["group"] == 4);
    CHECK(visibilities(place.json("outlined.json")) == "sssso");
    CHECK(place.json("through.json")["picked"].is_null()); // one looks through it
    CHECK(visibilities(place.json("words.json")) == "oshss");
    CHECK(visibilities(place.json("right.json")) == "hhhsh");
    const auto row = place.json("row.json");
    double sum = 0.0;
    for (std::size_t j = 3 * 36; j < 4 * 36; ++j) {
        sum += row["values"][j].is_null() ? 0.0 : row["values"][j].get<double>();
    }
    CHECK(row["groups"][3]["mean"].get<double>() == Approx(sum / 36.0));
    CHECK(row["groups"][4]["mean"] == 0.0); // a wall does not see itself
    CHECK(place.view("hide roof\n", small) == 2);
    CHECK(place.read("errors.txt").find("group roof: there is no such group") != std::string::npos);
    CHECK(place.view("hide\n", small) == 3);
}

TEST_CASE("Viewer: the command line it copies leaves out what the window leaves out", "[viewer][gl]") {
    const Workplace place;
    const int status =
        place.view("hide ceiling\noutline left\nclip y<0.8\nscreenshot window.png\n"
                   "command command.txt\nreport report.json\n"
                   "click 150 100\nreport behind.json\n"
                   "clip off\nclick 150 100\nclip patch\nscreenshot patch.png\n"
                   "command patch.txt\nkey shift+K\nreport turned.json\nkey K\nreport off.json\n",
                   small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const std::string command = place.read("command.txt");
    CHECK(command.find(" --hide ceiling --outlines-of left --clip 'y<0.8'") != std::string::npos);
    place.write("draw.sh", command);
    REQUIRE(run_in_shell(place, "draw.sh") == 0);
    CHECK(place.read("room.png") == place.read("window.png"));
    CHECK(place.json("report.json")["clip"] == "y<0.8");
    CHECK(place.json("behind.json")["picked"].is_null()); // the back wall is cut away
    place.write("draw.sh", place.read("patch.txt"));
    REQUIRE(run_in_shell(place, "draw.sh") == 0);
    CHECK(place.read("room.png") == place.read("patch.png"));
    // The back wall faces -y at y = 1: what is shown lies behind it.
    CHECK(place.json("turned.json")["clip"].get<std::string>().starts_with("y<0.99"));
    CHECK(place.json("off.json")["clip"].is_null());
    CHECK(place.view("clip patch\n", small) == 2);
    CHECK(place.view("clip q<3\n", small) == 3);
    REQUIRE(place.run(
                fmt::format("'{}' solve room.json --device osmesa -o a.png --hide roof", HEMI_PROGRAM)) == 2);
    CHECK(place.read("errors.txt").find("--hide roof: there is no such group") != std::string::npos);
    CHECK(place.run(fmt::format("'{}' solve room.json -o a.png --clip 3", HEMI_PROGRAM)) == 2);
    CHECK(place.run(fmt::format("'{}' solve room.json -o a.png --hide left --outlines-of left",
                                HEMI_PROGRAM)) == 2);
}

TEST_CASE("Viewer: options leave groups out of the first scene, not of those that are opened after",
          "[viewer][gl]") {
    const Workplace place;
    std::string other = place.read("room.json");
    replace(other, R"({"name": "left")", R"({"name": "west")");
    place.write("other.json", other);
    const int status = place.view("report first.json\ndrop other.json\nreport other_report.json\n",
                                  small + " --hide left --clip 'z<0.5'");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(visibilities(place.json("first.json")) == "sshss");
    CHECK(place.json("first.json")["clip"] == "z<0.5");
    CHECK(place.json("other_report.json")["message"] == "");
    CHECK(visibilities(place.json("other_report.json")) == "sssss");
    CHECK(place.json("other_report.json")["clip"].is_null());
    CHECK(place.view("quit\n", small + " --hide roof") == 2);
}

TEST_CASE("Viewer: the list of groups is searched, and its rows select and hide", "[viewer][gl]") {
    const Workplace place;
    // The list stands below the section Show, in a panel that is 380 wide.
    const int status =
        place.view("windowshot start.png\n"
                   "click 450 218\ntype BAC\nkey Backspace\ntype C\nkey Q\nwindowshot found.png\n"
                   "click 500 261\nreport selected.json\nwindowshot selected.png\n"
                   "click 343 261\nreport outlined.json\nclick 343 261\nreport hidden.json\n",
                   "--size 708x640 --preset plain --resolution 32");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.read("found.png") != place.read("start.png"));
    CHECK(place.json("selected.json")["group"] == 4);
    CHECK(place.json("selected.json")["asks_to_close"] == false); // Q was a letter
    CHECK(visibilities(place.json("outlined.json")) == "sssso");
    CHECK(visibilities(place.json("hidden.json")) == "ssssh");
}

TEST_CASE("Viewer: bands and iso-lines are those of the command that it copies", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("show irradiance\nbands 5\niso-lines on\nreport report.json\n"
                                  "screenshot window.png\ncommand command.txt\nwindowshot seen.png\n"
                                  "bands off\nscreenshot lines.png\niso-lines off\nscreenshot smooth.png\n",
                                  small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto scale = place.json("report.json")["scale"];
    CHECK(scale["bands"] == 5);
    REQUIRE(scale["lines"].size() == 4);
    const double low = scale["low"];
    const double high = scale["high"];
    CHECK(scale["lines"][0].get<double>() == Approx(low + (high - low) / 5.0));
    const std::string command = place.read("command.txt");
    CHECK(command.find(" --bands 5 --iso-lines") != std::string::npos);
    place.write("draw.sh", command);
    REQUIRE(run_in_shell(place, "draw.sh") == 0);
    CHECK(place.read("room.png") == place.read("window.png"));
    CHECK(place.read("lines.png") != place.read("smooth.png"));
    CHECK(place.view("bands 1\n", small) == 3);
    CHECK(place.view("iso-lines maybe\n", small) == 3);
}
