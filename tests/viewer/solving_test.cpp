#include "viewer/workplace.hpp"

#include "display/picture_renderer.hpp"
#include "gl/context.hpp"
#include "hemi/core/diagnostics.hpp"
#include "hemi/io/scene_reader.hpp"

#include <cmath>
#include <random>

using namespace hemi;
using hemi::viewer_test::Workplace;

namespace {

const std::string small = "--size 300x200 --preset plain --resolution 32";

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
