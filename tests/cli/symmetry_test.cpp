#include "cli/program.hpp"
#include "support/picture_difference.hpp"
#include "support/places.hpp"
#include "support/png.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace hemi::cli_test;
using hemi::test::picture_difference;
using hemi::test::read_png;

namespace {

const std::string quarter = HEMI_SOURCE_DIR "/scenes/furnace-quarter.json";

/// The half of cube() with x > 0.5.
Json half_cube(int n) {
    Json scene = cube(n);
    Json kept = Json::array();
    for (Json& surface : scene["surfaces"]) {
        bool beyond = true;
        bool across = false;
        for (Json& corner : surface["polygon"]) {
            beyond = beyond && corner[0] == 0;
            across = across || (corner[0] == 0 && surface["name"] != "left");
            corner[0] = std::max(0.5, corner[0].get<double>());
        }
        if (beyond) {
            continue;
        }
        if (across) { // u runs along x but where the second corner has the first one's x
            const bool along_u = surface["polygon"][0][0] != surface["polygon"][1][0];
            surface["patches"][along_u ? 0 : 1] = n / 2;
        }
        kept.push_back(surface);
    }
    scene["surfaces"] = kept;
    return scene;
}

Words on_cpu(Words words, const Words& more = {}) {
    words.insert(words.end(), {"--device", "cpu", "--jobs", "1", "--no-estimate"});
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

void refused(const Words& words, int status, const std::string& message) {
    const Outcome run = run_hemi(words);
    INFO(run.err);
    CHECK(run.status == status);
    CHECK(run.err_has(message));
}

} // namespace

TEST_CASE("Symmetry: a quarter of a furnace has the heat of the whole one", "[cli]") {
    const Json whole =
        run_hemi(on_cpu({"heat", HEMI_SOURCE_DIR "/scenes/furnace-hot.json", "--json"})).json();
    const Json part = run_hemi(on_cpu({"heat", quarter, "--json"})).json();
    REQUIRE(part["groups"] == whole["groups"]);
    for (std::size_t g = 0; g < part["groups"].size(); ++g) {
        INFO(part["groups"][g]);
        CHECK(part["areas"][g].get<double>() == Approx(0.25 * whole["areas"][g].get<double>()));
        CHECK(part["temperature"][g].get<double>() ==
              Approx(whole["temperature"][g].get<double>()).epsilon(1e-3));
        const double scale = std::abs(whole["net_power"][3].get<double>());
        CHECK(4.0 * part["net_power"][g].get<double>() ==
              Approx(whole["net_power"][g].get<double>()).margin(5e-4 * scale));
    }
}

TEST_CASE("Symmetry: info tells the images and what need not be computed", "[cli]") {
    const Outcome run = run_hemi({"info", quarter, "--device", "cpu", "--json"});
    REQUIRE(run.status == 0);
    const Json info = run.json();
    CHECK(info["symmetry"]["images"] == 4);
    CHECK(info["estimate"]["entries_per_row"].get<int>() <= info["patches"].get<int>());
    CHECK(info["symmetry"]["patches"] == 4 * info["patches"].get<int>());
    CHECK(run_hemi({"info", quarter, "--device", "cpu"}).out_has("4 images (mirror x=1, mirror y=0.6)"));
}

TEST_CASE("Symmetry: half a cube has the whole one's factors, files, check and picture", "[cli]") {
    const Directory directory;
    const std::string whole = directory.write("whole.json", cube(4));
    const std::string half = directory.write("half.json", half_cube(4));
    const Words mirror{"--mirror", "x=0.5"};
    const Json all = run_hemi(on_cpu({"factors", whole, "--by-group", "--json"})).json();
    const Json part = run_hemi(on_cpu({"factors", half, "--by-group", "--json"}, mirror)).json();
    const auto index = [](const Json& table, const std::string& group) {
        const auto& groups = table["groups"];
        return static_cast<std::size_t>(std::find(groups.begin(), groups.end(), group) - groups.begin());
    };
    const auto factor = [&](const Json& table, const std::string& from, const std::string& to) {
        return table["factors"][index(table, from)][index(table, to)].get<double>();
    };
    CHECK(factor(part, "right", "right") == Approx(factor(all, "right", "left")).margin(1e-6));
    CHECK(factor(part, "floor", "ceiling") == Approx(factor(all, "floor", "ceiling")).margin(1e-6));
    CHECK(factor(part, "floor", "right") ==
          Approx(factor(all, "floor", "right") + factor(all, "floor", "left")).margin(1e-6));

    // A file of rows belongs to its symmetry.
    const std::string file = directory.path("F.hff");
    REQUIRE(run_hemi(on_cpu({"factors", half, "-o", file}, mirror)).status == 0);
    CHECK(run_hemi({"check", file}).status == 0);
    CHECK(run_hemi({"check", half, mirror[0], mirror[1], "--device", "cpu"}).status == 0);
    refused({"solve", half, "--factors", file, "--mirror", "x=0.4"}, 3, "another geometry");

    const Words view{"--camera", "0.1,0.1,0.5:1,1,0.4", "--size", "80x60"};
    const std::string result = directory.path("half.hres");
    const auto drawn = [&](Words words, const std::string& picture) {
        words.insert(words.end(), {"-o", directory.path(picture)});
        words.insert(words.end(), view.begin(), view.end());
        const Outcome run = run_hemi(words);
        INFO(run.err);
        REQUIRE(run.status == 0);
        return read_png(directory.path(picture));
    };
    const auto of_half =
        drawn(on_cpu({"solve", half, "--factors", file, "--result", result}, mirror), "half.png");
    const auto of_whole = drawn(on_cpu({"solve", whole}), "whole.png");
    CHECK(picture_difference(of_half, of_whole).percentile_99 < 1.0);
    (void)drawn({"render", result}, "again.png");
    CHECK(directory.read("again.png") == directory.read("half.png"));
}

TEST_CASE("Symmetry: what does not go with it is refused, with what is wrong", "[cli]") {
    const Directory directory;
    const std::string half = directory.write("half.json", half_cube(2));
    refused({"info", half, "--mirror", "x=0.75"}, 3, "beyond the mirror plane x=0.75");
    refused({"info", half, "--mirror", "x=1"}, 3, "lies in the mirror plane x=1");
    refused({"info", half, "--mirror", "x=0.5", "--mirror", "x=0"}, 3, "are not perpendicular");
    refused({"info", half, "--mirror", "0.5"}, 2, "must be a plane across an axis, as x=0");
    refused({"info", half, "--rotate", "w,6"}, 2, "must be an axis and a number, as z,6");
    refused({"info", half, "--rotate", "z,1"}, 2, "--rotate 1");
    refused({"info", half, "--periodic", "1,0"}, 2, "must be three numbers DX,DY,DZ");
    refused({"info", half, "--images", "3"}, 2, "--periodic");
    refused({"factors", half, "--mirror", "x=0.5", "--rows", "0:4", "-o", directory.path("a.hff")}, 2,
            "symmetry cannot be computed in parts");
    Json scene = half_cube(2);
    scene["symmetry"] = {{"mirror", {"x=0.5"}}};
    scene["sun"] = {{"direction", {1, 0, 1}}, {"normal_irradiance", 1}};
    refused({"info", directory.write("sun.json", scene)}, 3, "must be the same in all images");
    scene.erase("sun");
    scene["symmetry"] = {{"images", 3}};
    refused({"info", directory.write("images.json", scene)}, 3,
            "symmetry.images: images without \"periodic\"");
    scene["symmetry"] = {{"mirror", {"x"}}};
    refused({"info", directory.write("plane.json", scene)}, 3, "symmetry.mirror[0]");
    scene["symmetry"] = {{"rotate", {"z", 1}}};
    refused({"info", directory.write("folds.json", scene)}, 3, "symmetry.rotate[1]");
}
