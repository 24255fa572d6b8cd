#include "viewer/workplace.hpp"

#include "support/png.hpp"

#include "hemi/io/result_file.hpp"
#include "hemi/matrix/expansion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

using namespace hemi;
using namespace hemi::viewer_test;

namespace {

constexpr std::uint32_t no_patch = 0xFFFFFFFFU;

std::uint32_t picked(const nlohmann::json& report) {
    return report["picked"].is_null() ? no_patch : report["picked"].get<std::uint32_t>();
}

double factor(const FormFactorMatrix& factors, std::uint32_t i, std::uint32_t j) {
    const RowView row = factors.row(i);
    const auto found = std::lower_bound(row.columns.begin(), row.columns.end(), j);
    return found == row.columns.end() || *found != j
               ? 0.0
               : static_cast<double>(row.values[static_cast<std::size_t>(found - row.columns.begin())]);
}

} // namespace

TEST_CASE("Viewer: a click picks the patch that is seen there, and none beside the scene", "[viewer][gl]") {
    const Workplace place;
    // The camera looks along +y at the centre of the back wall, 3.4 away: a wall of 1 x 1 in a view of
    // 2 tan(15 degrees) 3.4 = 1.822 heights. Wall patches are 1/6, so 18.3 pixels of 200.
    const int status = place.view("click 150 100\nreport middle.json\n"
                                  "click 160 90\nreport above.json\n"
                                  "click 2 2\nreport none.json\n"
                                  "click 160 90\nkey Escape\nreport let_go.json\n"
                                  "drag left 150 100 190 100\nreport dragged.json\n",
                                  small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    // The back wall's patches begin at 4 * 36; u goes right, v up.
    const auto wall = [](double x, double y) {
        const double unit = 200.0 / (2.0 * std::tan(std::numbers::pi / 12.0) * 3.4);
        const double u = 0.5 + (x + 0.5 - 150.0) / unit;
        const double v = 0.5 - (y + 0.5 - 100.0) / unit;
        return 4 * 36 + static_cast<std::uint32_t>(v * 6.0) * 6 + static_cast<std::uint32_t>(u * 6.0);
    };
    CHECK(picked(place.json("middle.json")) == wall(150, 100));
    CHECK(picked(place.json("above.json")) == wall(160, 90));
    CHECK(picked(place.json("none.json")) == no_patch);
    CHECK(picked(place.json("let_go.json")) == no_patch);
    CHECK(picked(place.json("dragged.json")) == no_patch);
}

TEST_CASE("Viewer: heat maps show the row and the column of the picked patch", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("click 150 100\nshow row\nreport row.json\nscreenshot row.png\n"
                                  "key H\nreport column.json\nkey L\nscreenshot linear.png\n"
                                  "key H\nreport off.json\n",
                                  small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto factors = place.factors("--preset plain --resolution 32");
    const auto value = [&](std::uint32_t i, std::uint32_t j) { return factor(factors, i, j); };
    const auto row = place.json("row.json");
    const auto column = place.json("column.json");
    const std::uint32_t patch = picked(row);
    REQUIRE(patch < factors.size());
    REQUIRE(row["values"].size() == factors.size());
    CHECK(column["quantity"] == "column");
    CHECK(place.json("off.json")["quantity"] == "picture");
    std::size_t wrong = 0;
    for (std::uint32_t j = 0; j < factors.size(); ++j) {
        const auto shown = [j](const nlohmann::json& report) {
            return report["values"][j].is_null() ? 0.0 : report["values"][j].get<double>();
        };
        wrong += (shown(row) != value(patch, j) ? 1U : 0U) + (shown(column) != value(j, patch) ? 1U : 0U);
    }
    CHECK(wrong == 0);
    CHECK(place.read("row.png") != place.read("linear.png"));
    // The list of partners begins with the largest factor.
    double largest = 0.0;
    for (std::uint32_t j = 0; j < factors.size(); ++j) {
        largest = std::max(largest, value(patch, j));
    }
    CHECK(value(patch, row["partners"][0]) == largest);
}

TEST_CASE("Viewer: far patches are seen in clusters, and a picked one shows what they share out",
          "[viewer][gl]") {
    const Workplace place;
    const std::string rows = "--preset fast --clusters on --cluster-error 10%";
    const std::string script = "click 150 100\nshow row\nreport row.json\nkey H\nreport column.json\n"
                               "show findings\nreport findings.json\nsave-result window.hres\n";
    REQUIRE(place.view(script, "--size 300x200 " + rows) == 0);
    const FormFactorMatrix with_clusters = place.factors(rows);
    REQUIRE(with_clusters.clusters() != nullptr);
    const FormFactorMatrix factors = expand_clusters(with_clusters, ~std::uint64_t{0});
    const auto row = place.json("row.json");
    const auto column = place.json("column.json");
    const std::uint32_t patch = picked(row);
    REQUIRE(patch < factors.size());
    REQUIRE(row["values"].size() == factors.size());
    CHECK(with_clusters.row(patch).columns.back() >= factors.size());
    const auto shown = [](const nlohmann::json& report, std::uint32_t j) {
        return report["values"][j].is_null() ? 0.0 : report["values"][j].get<double>();
    };
    for (std::uint32_t j = 0; j < factors.size(); ++j) {
        CHECK(shown(row, j) == Approx(factor(factors, patch, j)).epsilon(1e-5));
        CHECK(shown(column, j) == Approx(factor(factors, j, patch)).epsilon(1e-5));
    }
    REQUIRE(place.run(fmt::format("'{}' solve room.json --device osmesa {} --result solve.hres", HEMI_PROGRAM,
                                  rows)) == 0);
    const Solution solve = io::read_hres(place.path("solve.hres")).solution;
    const Solution window = io::read_hres(place.path("window.hres")).solution;
    REQUIRE(window.radiosity.size() == solve.radiosity.size());
    for (std::size_t k = 0; k < solve.radiosity.size(); ++k) {
        REQUIRE(window.radiosity[k] == Approx(solve.radiosity[k]).epsilon(1e-5));
    }
    // The same from stored rows; and where pairs do not fit.
    REQUIRE(place.view("click 150 100\nshow row\nreport stored.json\n",
                       "--size 300x200 --factors room.hff") == 0);
    CHECK(place.json("stored.json")["values"] == row["values"]);
    REQUIRE(place.view("report little.json\n",
                       "--size 300x200 --preset fast --patches-per-face 256 --max-memory 14M") == 0);
    INFO(place.read("errors.txt"));
    CHECK(place.read("errors.txt").find("Far patches are seen in clusters") != std::string::npos);
    CHECK(place.json("little.json")["light"].get<std::string>().find("no solution") == std::string::npos);
}

TEST_CASE("Viewer: the hemicube of the picked patch shows the patches of its row", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("click 174 200\nwindowshot light.png\nreport seen.json\n"
                                  "show items\nwindowshot items.png\nkey C\nwindowshot none.png\n"
                                  "report none.json\n",
                                  with_panel);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto report = place.json("seen.json");
    const auto factors = place.factors("--preset plain --resolution 32");
    const hemi::RowView row = factors.row(picked(report));
    REQUIRE(row.columns.size() > 50);
    CHECK(report["hemicube"] == std::vector<std::uint32_t>(row.columns.begin(), row.columns.end()));
    CHECK(place.json("none.json")["hemicube"].empty());
    CHECK(place.read("items.png") != place.read("none.png"));
}

TEST_CASE("Viewer: light follows a change of materials as a fresh solution has it", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("set reflectance 0.3,0.5,0.6 white\nset exitance 30,5,12 lamp\n"
                                  "set exitance 0.5 red\nreport changed.json\nscreenshot changed.png\n"
                                  "set exitance 0 lamp\nset exitance 0 red\nreport dark.json\n",
                                  small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    std::string scene = place.read("room.json");
    replace(scene, "\"reflectance\": 0.7", "\"reflectance\": [0.3, 0.5, 0.6]");
    replace(scene, "[20, 18, 12]", "[30, 5, 12]");
    replace(scene, "[0.6, 0.1, 0.1]", "[0.6, 0.1, 0.1], \"exitance\": 0.5");
    place.write("room.json", scene);
    REQUIRE(place.view("report fresh.json\n", small) == 0);
    const auto changed = place.json("changed.json")["radiosity"];
    const auto fresh = place.json("fresh.json")["radiosity"];
    REQUIRE(changed.size() == fresh.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < fresh.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double was = fresh[i][c];
            const double is = changed[i][c];
            largest = std::max(largest, std::abs(is - was) / was);
        }
    }
    CHECK(largest < 2e-5); // both are solved to a residual of 1e-6
    const auto dark = place.json("dark.json")["radiosity"];
    CHECK(dark.size() == fresh.size());
    for (const auto& patch : dark) {
        CHECK(patch == std::vector<double>(3, 0.0));
    }
    CHECK(place.view("set exitance 1 gold\n", small) == 2);
    CHECK(place.view("set reflectance 1 white\n", small) == 3);
}

TEST_CASE("Viewer: light follows a change of the environment, and is stored with it", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("screenshot start.png\nset environment 3,1,2\nreport changed.json\n"
                                  "screenshot changed.png\nsave-result changed.hres\ncommand changed.txt\n"
                                  "key ctrl+Z\nwait\nscreenshot back.png\n",
                                  small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    REQUIRE(place.view("report fresh.json\n", small + " --environment 3,1,2") == 0);
    const auto changed = place.json("changed.json")["radiosity"];
    const auto fresh = place.json("fresh.json")["radiosity"];
    REQUIRE(changed.size() == fresh.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < fresh.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double was = fresh[i][c];
            const double is = changed[i][c];
            largest = std::max(largest, std::abs(is - was) / was);
        }
    }
    CHECK(largest < 2e-5); // both are solved to a residual of 1e-6
    CHECK(place.read("back.png") == place.read("start.png"));
    CHECK(place.read("changed.txt").starts_with("hemi render changed.hres "));
    place.write("draw.sh", place.read("changed.txt"));
    REQUIRE(place.run(fmt::format("PATH='{}':$PATH sh draw.sh",
                                  std::filesystem::path(HEMI_PROGRAM).parent_path().string())) == 0);
    CHECK(place.read("room.png") == place.read("changed.png"));
    CHECK(place.view("set environment 1,2\n", small) == 2);
    CHECK(place.view("set environment 1 white\n", small) == 3);
}

TEST_CASE("Viewer: while a scene is solved, it is shown by the light of its lamps", "[viewer][gl]") {
    const Workplace place;
    const int status =
        place.view("live\nreport lamps.json\nwindowshot lamps.png\nkey 7\ndrag left 90 90 120 90\n"
                   "wait\nreport solved.json\nwindowshot solved.png\n",
                   with_panel);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto lamps = place.json("lamps.json")["radiosity"];
    const auto solved = place.json("solved.json")["radiosity"];
    CHECK(lamps[0] == std::vector<double>(3, 0.0));
    CHECK(lamps[36] == std::vector<double>{20.0, 18.0, 12.0});
    CHECK(solved[0][0].get<double>() > 1.0);
}

TEST_CASE("Viewer: solving can be stopped, by hand and by closing the window", "[viewer][gl]") {
    const Workplace place;
    const std::string slow = "--size 708x400 --patches-per-face 200 --preset exact";
    REQUIRE(place.view("live\ncancel\nreport stopped.json\nwindowshot stopped.png\n", slow) == 0);
    const auto stopped = place.json("stopped.json");
    CHECK(stopped["light"].get<std::string>().starts_with("stopped: "));
    CHECK(stopped["residuals"].empty());
    REQUIRE(place.view("live\nwindowshot open.png\nquit\n", slow) == 0);
    CHECK(place.read("errors.txt").find("error") == std::string::npos);
}

TEST_CASE("Viewer: every quantity and every panel draws", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("windowshot start.png\nclick 150 200\nwindowshot picked.png\n"
                                  "show outlines\nwindowshot outlines.png\nshow items\nwindowshot items.png\n"
                                  "show radiosity\nwindowshot radiosity.png\nkey L\nwindowshot log.png\n"
                                  "show reflectance\nwindowshot reflectance.png\n"
                                  "show exitance\nwindowshot exitance.png\n"
                                  "show row-error\nwindowshot row-error.png\n"
                                  "show error\nwindowshot error.png\n"
                                  "show row\nwindowshot row.png\nshow column\nwindowshot column.png\n"
                                  "key F1\nwindowshot help.png\nkey Escape\nkey Escape\n"
                                  "show picture\nkey Tab\nwindowshot bare.png\nscreenshot bare_too.png\n",
                                  with_panel);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    std::vector<std::string> seen;
    for (const char* name : {"start", "picked", "outlines", "items", "radiosity", "log", "reflectance",
                             "exitance", "row-error", "error", "row", "column", "help", "bare"}) {
        INFO(name);
        const std::string content = place.read(std::string(name) + ".png");
        CHECK_FALSE(content.empty());
        CHECK(std::find(seen.begin(), seen.end(), content) == seen.end());
        seen.push_back(content);
    }
    CHECK(place.read("bare.png") == place.read("bare_too.png"));
}

TEST_CASE("Viewer: sliders take numbers, controls have tips, and the hemicube's window moves and closes",
          "[viewer][gl]") {
    const Workplace place;
    // Exposure is the first slider of the panel, which is 380 wide; the hemicube is in the view's upper
    // right.
    const int status = place.view("move 470 93\nwindowshot tip.png\nmove 330 399\nwindowshot plain.png\n"
                                  "click 470 93\nclick 470 93\ntype 2\nkey Enter\nscreenshot typed.png\n"
                                  "click 500 93\nclick 500 93\ntype 99\nkey Enter\nscreenshot most.png\n"
                                  "click 440 93\nclick 440 93\ntype 0\nkey Enter\nscreenshot zero.png\n"
                                  "click 100 330\nreport open.json\nwindowshot open.png\n"
                                  "drag left 230 26 180 76\nwindowshot moved.png\nclick 252 76\n"
                                  "report closed.json\nclick 120 330\nreport other.json\n"
                                  "key E\nkey E\nkey E\nkey E\nkey E\nkey E\nscreenshot pressed.png\n",
                                  with_panel);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.read("tip.png") != place.read("plain.png"));
    CHECK(place.read("typed.png") == place.read("pressed.png"));
    CHECK(place.read("zero.png") != place.read("typed.png"));
    CHECK(place.read("most.png") != place.read("typed.png"));
    CHECK_FALSE(place.json("open.json")["hemicube"].empty());
    CHECK(place.read("moved.png") != place.read("open.png"));
    CHECK(place.json("closed.json")["hemicube"].empty());
    CHECK(place.json("closed.json")["picked"] == place.json("open.json")["picked"]);
    CHECK(place.json("other.json")["picked"] != place.json("open.json")["picked"]);
    CHECK(place.json("other.json")["hemicube"].empty()); // it stays closed
}

TEST_CASE("Viewer: Escape closes what is open, and never the window", "[viewer][gl]") {
    const Workplace place;
    // The list of quantities stands at the top of the panel, which is 380 wide.
    const int status = place.view("windowshot start.png\nclick 480 41\nwindowshot list.png\nkey Escape\n"
                                  "move 100 200\nwindowshot closed.png\n"
                                  "key F1\nkey Escape\nclick 150 200\nkey Escape\nreport let_go.json\n"
                                  "key Escape\nkey Escape\nreport open.json\n",
                                  with_panel);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.read("list.png") != place.read("start.png"));
    REQUIRE(place.has("closed.png"));
    CHECK(picked(place.json("let_go.json")) == no_patch);
    CHECK(place.has("open.json"));
}

TEST_CASE("Viewer: changes that are not saved are asked for before it quits", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("set reflectance 0.1 white\nkey Q\nreport asks.json\nwindowshot asks.png\n"
                                  "key Escape\nreport stays.json\nwindowshot stays.png\n"
                                  "save-result kept.hres\nkey Q\nreport never.json\n",
                                  with_panel);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.json("asks.json")["asks_to_close"] == true);
    CHECK(place.json("stays.json")["asks_to_close"] == false);
    CHECK(place.read("asks.png") != place.read("stays.png"));
    CHECK_FALSE(place.has("never.json"));
    REQUIRE(place.view("set reflectance 0.1 white\nkey Q\nkey Q\nreport never.json\n", small) == 0);
    CHECK_FALSE(place.has("never.json"));
    // Light that took long is asked for as well, until it is saved; that of a moment is not.
    REQUIRE(place.view("long-work 0\nkey Q\nreport long.json\nkey Escape\nsave-result long.hres\nkey Q\n"
                       "report never.json\n",
                       small) == 0);
    CHECK(place.json("long.json")["asks_to_close"] == true);
    CHECK_FALSE(place.has("never.json"));
    REQUIRE(place.view("key Q\nreport never.json\n", small) == 0);
    CHECK_FALSE(place.has("never.json"));
    // What is taken back after saving is other light again; at once, before it is found.
    REQUIRE(place.view("set reflectance 0.1 white\nset reflectance 0.2 white\nsave-result kept.hres\n"
                       "key ctrl+Z\nkey Q\nreport undone.json\nkey Q\n",
                       small) == 0);
    CHECK(place.json("undone.json")["asks_to_close"] == true);
}

TEST_CASE("Viewer: changes of materials are taken back and redone to the bits of the light", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("report first.json\nscreenshot first.png\n"
                                  "set reflectance 0.1 white\nscreenshot second.png\n"
                                  "set exitance 1 lamp\nscreenshot third.png\n"
                                  "key ctrl+Z\nwait\nscreenshot back.png\n"
                                  "key ctrl+shift+Z\nwait\nscreenshot again.png\n"
                                  "key ctrl+Z\nkey ctrl+Z\nkey ctrl+Z\nwait\nscreenshot start.png\n"
                                  "key ctrl+Q\nset reflectance 0.3 white\nkey ctrl+shift+Z\nwait\n"
                                  "key ctrl+Z\nwait\nreport end.json\nscreenshot end.png\n",
                                  small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.read("second.png") != place.read("first.png"));
    CHECK(place.read("third.png") != place.read("second.png"));
    CHECK(place.read("back.png") == place.read("second.png"));
    CHECK(place.read("again.png") == place.read("third.png"));
    CHECK(place.read("start.png") == place.read("first.png"));
    CHECK(place.read("end.png") == place.read("first.png"));
    CHECK(place.json("end.json")["radiosity"] == place.json("first.json")["radiosity"]);
}

TEST_CASE("Viewer: what is under the cursor is told", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("click 150 200\nreport picked.json\nmove 150 200\nreport there.json\n"
                                  "windowshot light.png\nshow radiosity\nwindowshot field.png\n"
                                  "move 500 200\nreport panel.json\n",
                                  with_panel);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto there = place.json("there.json")["under_cursor"];
    REQUIRE(there.is_object());
    CHECK(there["patch"] == place.json("picked.json")["picked"]);
    CHECK(place.json("panel.json")["under_cursor"].is_null());
}

TEST_CASE("Viewer: what cannot be shown is refused with the reason", "[viewer][gl]") {
    const Workplace place;
    REQUIRE(place.view("show row\n", small) == 2);
    CHECK(place.read("errors.txt").find("click a patch first") != std::string::npos);
    REQUIRE(place.view("show colour\n", small) == 3);
    CHECK(place.read("errors.txt").find("script.txt:1: quantity \"colour\"") != std::string::npos);
    CHECK(place.view("windowshot a.hdr\n", small) == 3);
    CHECK(place.view("report a.txt\n", small) == 3);
    CHECK(place.view("click 3\n", small) == 3);
}

TEST_CASE("Viewer: the window shows the pixels of the screenshot beside its panel", "[viewer][gl]") {
    const Workplace place;
    REQUIRE(place.view("key U\ndrag left 150 200 190 180\nwindowshot window.png\nscreenshot picture.png\n",
                       with_panel) == 0);
    const hemi::test::SrgbPicture window = hemi::test::read_png(place.path("window.png"));
    const hemi::test::SrgbPicture picture = hemi::test::read_png(place.path("picture.png"));
    REQUIRE(window.width == 708);
    REQUIRE(window.height == 400);
    REQUIRE(picture.height == 400);
    REQUIRE(picture.width > 300);
    REQUIRE(picture.width < 400);
    std::size_t wrong = 0;
    for (std::size_t y = 0; y < picture.height; ++y) {
        const auto shown = window.pixels.begin() + static_cast<std::ptrdiff_t>(y * window.width * 3);
        const auto drawn = picture.pixels.begin() + static_cast<std::ptrdiff_t>(y * picture.width * 3);
        const auto end = drawn + static_cast<std::ptrdiff_t>(picture.width * 3);
        wrong += std::equal(drawn, end, shown) ? 0 : 1;
    }
    CHECK(wrong == 0);
}
