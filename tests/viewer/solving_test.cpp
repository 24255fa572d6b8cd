#include "viewer/workplace.hpp"

#include "display/picture_renderer.hpp"
#include "gl/context.hpp"
#include "hemi/core/diagnostics.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "support/places.hpp"

#include <array>
#include <cmath>
#include <random>

using namespace hemi;
using namespace hemi::viewer_test;

namespace {

hemi::Camera camera_of(const nlohmann::json& report) {
    const auto& camera = report["camera"];
    const auto point = [](const nlohmann::json& p) {
        return Vec3(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
    };
    return {point(camera["eye"]), point(camera["target"]), point(camera["up"]), camera["fov"].get<double>(),
            camera["orthographic"].get<bool>()};
}

} // namespace

TEST_CASE("Viewer: picks what the item buffer holds, in perspective and without", "[viewer][gl]") {
    const Workplace place;
    std::mt19937 random(3);
    std::string script = "drag left 150 100 170 80\nscroll 150 100 2\n";
    std::vector<std::array<std::uint32_t, 2>> pixels;
    for (int k = 0; k < 40; ++k) {
        script += k == 20 ? "key 5\n" : "";
        pixels.push_back(
            {static_cast<std::uint32_t>(random() % 300), static_cast<std::uint32_t>(random() % 200)});
        script += fmt::format("click {} {}\nreport {}.json\n", pixels[static_cast<std::size_t>(k)][0],
                              pixels[static_cast<std::size_t>(k)][1], k);
    }
    REQUIRE(place.view(script, small) == 0);
    Diagnostics diagnostics;
    const Scene scene = io::read_scene(place.path("room.json"), {}, diagnostics);
    const PatchMesh mesh(scene);
    const auto context = gl::make_context("osmesa");
    PictureRenderer renderer;
    renderer.upload(make_picture_mesh(mesh, 1, std::vector<double>(mesh.size(), 1.0), {}, {0, 0, 0}));
    PictureSettings settings;
    settings.width = 300;
    settings.height = 200;
    std::size_t patches = 0;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const auto report = place.json(fmt::format("{}.json", k));
        const auto items = renderer.items(camera_of(report), settings);
        const std::uint32_t item = items[pixels[k][1] * 300 + pixels[k][0]];
        INFO(k << ": " << pixels[k][0] << ", " << pixels[k][1]);
        CHECK((report["picked"].is_null() ? PictureRenderer::no_item
                                          : report["picked"].get<std::uint32_t>()) == item);
        patches += item == PictureRenderer::no_item ? 0 : 1;
    }
    CHECK(patches > 20);
}

TEST_CASE("Viewer: the light converges a sweep at a time, to the same solution", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("report solved.json\nkey G\nreport one.json\nkey G\nreport two.json\n"
                                  "screenshot two.png\nkey shift+G\nreport all.json\n",
                                  small);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto solved = place.json("solved.json");
    const auto one = place.json("one.json");
    const auto two = place.json("two.json");
    const auto all = place.json("all.json");
    REQUIRE(one["residuals"].size() == 1);
    REQUIRE(two["residuals"].size() == 2);
    CHECK(two["residuals"][0] == one["residuals"][0]);
    CHECK(two["residuals"][1].get<double>() < one["residuals"][0].get<double>());
    CHECK(all["residuals"] == solved["residuals"]);
    CHECK(all["radiosity"] == solved["radiosity"]);
    // Light is added by every sweep, from the lamps' own on.
    CHECK(one["radiosity"][0][0].get<double>() > 0.0);
    CHECK(two["radiosity"][0][0].get<double>() > one["radiosity"][0][0].get<double>());
    CHECK(solved["radiosity"][0][0].get<double>() > two["radiosity"][0][0].get<double>());
    CHECK(two["light"].get<std::string>().find("sweep 2") != std::string::npos);
}

TEST_CASE("Viewer: shows patches as they are cut, and the light of hemi solve in the end", "[viewer][gl]") {
    const Workplace place;
    const std::string options = "--preset default --patches-per-face 9 --refine 120";
    const int status = place.view("live\nreport coarse.json\npatches 46\n"
                                  "report cut.json\nwait\nreport all.json\n"
                                  "screenshot all.png\nsave-result window.hres\nclick 150 150\nshow row\n"
                                  "report row.json\nset exitance 40,36,24 lamp\nreport twice.json\n"
                                  "save-result twice.hres\n",
                                  "--size 300x200 " + options);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.json("coarse.json")["radiosity"].size() == 45);
    const auto cut = place.json("cut.json");
    CHECK(cut["radiosity"].size() > 45);
    CHECK(cut["light"].get<std::string>().find("on the way") != std::string::npos);
    REQUIRE(place.run(fmt::format("'{}' solve room.json --device osmesa --result solve.hres {}", HEMI_PROGRAM,
                                  options)) == 0);
    const io::ResultFile window = io::read_hres(place.path("window.hres"));
    const io::ResultFile solve = io::read_hres(place.path("solve.hres"));
    REQUIRE(window.solution.radiosity.size() == solve.solution.radiosity.size());
    REQUIRE(window.solution.vertex_radiosity.size() == solve.solution.vertex_radiosity.size());
    CHECK(place.json("all.json")["radiosity"].size() * 3 == solve.solution.radiosity.size());
    for (std::size_t k = 0; k < solve.solution.radiosity.size(); ++k) {
        REQUIRE(window.solution.radiosity[k] == Approx(solve.solution.radiosity[k]).epsilon(1e-5));
    }
    CHECK(window.subdivision == solve.subdivision);
    CHECK(window.parts.patch_of == solve.parts.patch_of);
    const auto once = place.json("all.json")["radiosity"];
    const auto twice = place.json("twice.json")["radiosity"];
    for (std::size_t i = 0; i < once.size(); ++i) {
        REQUIRE(twice[i][0].get<double>() == Approx(2.0 * once[i][0].get<double>()).epsilon(1e-5));
    }
    CHECK(window.solution.patch_size_error);
    CHECK_FALSE(io::read_hres(place.path("twice.hres")).solution.patch_size_error); // it was of other light
    const auto row = place.json("row.json");
    CHECK(row["quantity"] == "row");
    CHECK(row["values"].size() * 3 == window.solution.radiosity.size());
}

TEST_CASE("Viewer: what is cut stays when the rest is cancelled", "[viewer][gl]") {
    const Workplace place;
    const int status =
        place.view("live\npatches 46\ncancel\nreport rest.json\nscreenshot rest.png\n",
                   "--size 300x200 --preset default --patches-per-face 9 --refine 3000 --jobs 1");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto rest = place.json("rest.json");
    CHECK(rest["radiosity"].size() > 45);
    CHECK(rest["radiosity"].size() < 3000);
    CHECK(rest["light"].get<std::string>().find("stopped") != std::string::npos);
}

TEST_CASE("Viewer: sun and sky give the light that they give elsewhere", "[viewer][gl][sun]") {
    const Workplace place;
    std::string scene = place.read("room.json");
    replace(scene, R"({"hemi": 1,)", R"({"hemi": 1,
  "sun": {"azimuth": 190, "elevation": 40, "normal_irradiance": 700},
  "environment": {"sky": "overcast", "horizontal_irradiance": [100, 120, 150], "ground": 0.1},)");
    place.write("room.json", scene);
    REQUIRE(place.view("save-result window.hres\nscreenshot window.png\n", small) == 0);
    REQUIRE(place.run(fmt::format("'{}' solve room.json --device osmesa --preset plain --resolution 32 "
                                  "--result solve.hres",
                                  HEMI_PROGRAM)) == 0);
    const Solution window = io::read_hres(place.path("window.hres")).solution;
    const Solution solve = io::read_hres(place.path("solve.hres")).solution;
    REQUIRE(window.direct.size() == solve.radiosity.size());
    CHECK(window.direct == solve.direct);
    for (std::size_t k = 0; k < solve.radiosity.size(); ++k) {
        REQUIRE(window.radiosity[k] == Approx(solve.radiosity[k]).epsilon(1e-5));
        REQUIRE(window.irradiance[k] == Approx(solve.irradiance[k]).epsilon(1e-5));
    }
}

TEST_CASE("Viewer: patches that are cut in the sun are those of hemi solve", "[viewer][gl][sun]") {
    const Workplace place;
    std::string scene = place.read("room.json");
    replace(scene, R"({"hemi": 1,)", R"({"hemi": 1,
  "sun": {"azimuth": 190, "elevation": 40, "normal_irradiance": 70, "diameter": 0.53},)");
    place.write("room.json", scene);
    const std::string options = "--preset fast --patches-per-face 4 --refine 32";
    REQUIRE(place.view("save-result window.hres\n", "--size 300x200 " + options) == 0);
    REQUIRE(place.run(fmt::format("'{}' solve room.json --device osmesa --result solve.hres {}", HEMI_PROGRAM,
                                  options)) == 0);
    const io::ResultFile window = io::read_hres(place.path("window.hres"));
    const io::ResultFile solve = io::read_hres(place.path("solve.hres"));
    CHECK(window.solution.radiosity.size() >= 3 * 32);
    CHECK(window.subdivision == solve.subdivision);
    REQUIRE(window.solution.direct.size() == solve.solution.radiosity.size());
    CHECK(window.solution.direct == solve.solution.direct);
    for (std::size_t k = 0; k < solve.solution.radiosity.size(); ++k) {
        REQUIRE(window.solution.radiosity[k] == Approx(solve.solution.radiosity[k]).epsilon(1e-5));
    }
}

TEST_CASE("Viewer: a large scene shows about its light before its form factors are there", "[viewer][gl]") {
    const Workplace place;
    // 5 x 900 patches; the window's own light is that of 5 x 196 or so.
    const int status = place.view("live\npreview\ncancel\nreport preview.json\nscreenshot preview.png\n",
                                  "--size 300x200 --preset exact --patches-per-face 900 --jobs 1");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto preview = place.json("preview.json");
    CHECK(preview["light"].get<std::string>().find("preview") != std::string::npos);
    REQUIRE(preview["radiosity"].size() == 4500);
    REQUIRE(place.view("report fine.json\n", "--size 300x200 --preset fast --patches-per-face 225") == 0);
    const auto fine = place.json("fine.json")["radiosity"];
    // Means over walls.
    for (std::size_t wall = 0; wall < 5; ++wall) {
        double coarse_sum = 0.0;
        double fine_sum = 0.0;
        for (std::size_t i = 0; i < 900; ++i) {
            coarse_sum += preview["radiosity"][wall * 900 + i][1].get<double>() / 900.0;
        }
        for (std::size_t i = 0; i < 225; ++i) {
            fine_sum += fine[wall * 225 + i][1].get<double>() / 225.0;
        }
        INFO("wall " << wall);
        CHECK(coarse_sum == Approx(fine_sum).epsilon(0.02));
    }
}

TEST_CASE("Viewer: while rows come in, patches show the light that reaches them straight from the lamps",
          "[viewer][gl]") {
    const Workplace place;
    const std::string slow = "--patches-per-face 64 --preset plain --resolution 1024 --jobs 1";
    const int status = place.view("live\nrows 0.2\ncancel\nshow radiosity\nreport half.json\n"
                                  "show picture\nscreenshot half.png\n",
                                  "--size 300x200 " + slow);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto report = place.json("half.json");
    const FormFactorMatrix factors = place.factors(slow);
    REQUIRE(factors.size() == 5 * 64);
    // Floor, lamp, left, right, back.
    const std::array<double, 3> lamp{20.0, 18.0, 12.0};
    const std::array<double, 3> red{0.6, 0.1, 0.1};
    std::size_t known = 0;
    std::size_t wrong = 0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const std::uint32_t wall = i / 64;
        double from_lamp = 0.0;
        const RowView row = factors.row(i);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            from_lamp += row.columns[k] / 64 == 1 ? static_cast<double>(row.values[k]) : 0.0;
        }
        known += report["values"][i].is_null() || wall == 1 ? 0 : 1;
        for (std::size_t c = 0; c < 3; ++c) {
            const double reflectance = wall == 2 ? red[c] : 0.7;
            const bool dark = report["values"][i].is_null();
            const double light = wall == 1 ? lamp[c] : (dark ? 0.0 : reflectance * from_lamp * lamp[c]);
            wrong += std::abs(report["radiosity"][i][c].get<double>() - light) > 1e-9 ? 1 : 0;
        }
    }
    CHECK(wrong == 0);
    CHECK(known >= 32);
    CHECK(known < 4 * 64);
    CHECK(report["light"].get<std::string>().find("stopped: lamps' light at ") == 0);
    CHECK(place.view("rows 1.5\n", small) == 3);
}

TEST_CASE("Viewer: rows that come in sharpen the coarse preview of a large scene", "[viewer][gl]") {
    const Workplace place;
    // 5 x 900 patches, of which the preview has 5 x 196 or so. Their rows take longer than a few frames.
    const std::string large = "--patches-per-face 900 --preset plain --resolution 64 --eye-points 4 --jobs 1";
    const int status = place.view("live\npreview\nreport preview.json\nrows 0.1\ncancel\nreport half.json\n",
                                  "--size 300x200 " + large);
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const auto preview = place.json("preview.json")["radiosity"];
    const auto half = place.json("half.json")["radiosity"];
    const FormFactorMatrix factors = place.factors(large);
    REQUIRE(factors.size() == 4500);
    std::size_t sharper = 0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        if (half[i] == preview[i]) {
            continue;
        }
        double light = i / 900 == 1 ? 18.0 : 0.0;
        const double reflectance = i / 900 == 2 ? 0.1 : (i / 900 == 1 ? 0.0 : 0.7);
        const RowView row = factors.row(i);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            light +=
                reflectance * static_cast<double>(row.values[k]) * preview[row.columns[k]][1].get<double>();
        }
        CHECK(half[i][1].get<double>() == Approx(light).epsilon(1e-9));
        ++sharper;
    }
    CHECK(sharper >= 400);
    CHECK(place.json("half.json")["light"].get<std::string>().find("stopped: preview, ") !=
          std::string::npos);
}

TEST_CASE("Viewer: Blender's controls turn with the middle button and leave the left one for picking",
          "[viewer][gl]") {
    const Workplace place;
    const std::string blender = small + " --controls blender";
    REQUIRE(place.view("report start.json\ndrag left 150 100 190 80\nreport left.json\n"
                       "drag middle 150 100 190 80\nreport turned.json\nkey R\n"
                       "drag shift+middle 150 100 190 80\nreport panned.json\nkey R\n"
                       "drag ctrl+middle 150 100 150 60\nreport zoomed.json\nkey Home\nreport framed.json\n"
                       "click 150 100\nreport picked.json\nkey F1\n",
                       blender) == 0);
    REQUIRE(place.view("drag left 150 100 190 80\nreport turned_too.json\nkey R\n"
                       "drag middle 150 100 190 80\nreport panned_too.json\nkey R\n"
                       "drag right 150 100 150 60\nreport zoomed_too.json\nkey F\nreport framed_too.json\n",
                       small) == 0);
    const auto camera = [&](const char* name) { return place.json(name)["camera"]; };
    CHECK(camera("left.json") == camera("start.json"));
    CHECK(camera("turned.json") == camera("turned_too.json"));
    CHECK(camera("panned.json") == camera("panned_too.json"));
    CHECK(camera("zoomed.json") == camera("zoomed_too.json"));
    CHECK(camera("framed.json") == camera("framed_too.json"));
    CHECK(camera("turned.json") != camera("start.json"));
    CHECK_FALSE(place.json("picked.json")["picked"].is_null());
    CHECK(place.view("quit\n", small + " --controls maya") == 2);
}

TEST_CASE("Viewer: a room without a camera is begun inside, an object from outside", "[viewer][gl]") {
    const Workplace place;
    std::string scene = place.read("room.json");
    const std::size_t camera = scene.find(",\n  \"camera\"");
    REQUIRE(camera != std::string::npos);
    const std::string open = scene.substr(0, camera) + "}";
    std::string closed = open;
    closed.insert(closed.find("\n    {\"name\": \"ceiling\""),
                  R"({"name": "front", "material": "white", "polygon": [[0,0,0],[0,0,1],[1,0,1],[1,0,0]]},)");
    const auto eye = [&](const std::string& text, const char* name) {
        place.write("room.json", text);
        REQUIRE(place.view(fmt::format("report {}\n", name), small) == 0);
        return camera_of(place.json(name));
    };
    const Camera inside = eye(closed, "closed.json");
    for (const double coordinate :
         {inside.eye.x, inside.eye.y, inside.eye.z, inside.target.x, inside.target.y}) {
        CHECK((coordinate > 0.0 && coordinate < 1.0));
    }
    CHECK(glm::length(inside.target - inside.eye) > 0.4);
    const Camera outside = eye(open, "open.json");
    CHECK(glm::length(outside.eye - Vec3(0.5)) > 1.5);
}
