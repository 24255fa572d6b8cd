#include "cli/program.hpp"
#include "support/scene_file.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

using namespace hemi::cli_test;

namespace {

/// One open unit square.
Json square(double reflectance, double exitance, double environment) {
    return {{"hemi", 1},
            {"channels", {"grey"}},
            {"materials", {{"grey", {{"reflectance", reflectance}, {"exitance", exitance}}}}},
            {"surfaces",
             {{{"name", "square"},
               {"material", "grey"},
               {"polygon", Json::parse("[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]")}}}},
            {"environment", {{"exitance", environment}}}};
}

double radiosity_of(const std::string& scene, const std::string& preset, std::size_t group = 0) {
    const Outcome run =
        run_hemi({"solve", scene, "--json", "--device", "osmesa", "--jobs", "1", "--preset", preset});
    INFO(run.err);
    REQUIRE(run.status == 0);
    return run.json()["radiosity"][group][0];
}

} // namespace

TEST_CASE("extremes: one patch has what it gives and reflects of the environment", "[cli]") {
    const Directory directory;
    const std::string lit = directory.write("lit.json", square(0.5, 1.0, 3.0));
    const std::string dark = directory.write("dark.json", square(0.5, 0.0, 0.0));
    const std::string black = directory.write("black.json", square(0.0, 1.0, 3.0));
    for (const char* preset : {"plain", "default"}) {
        INFO(preset);
        CHECK(radiosity_of(lit, preset) == Approx(2.5));
        CHECK(radiosity_of(dark, preset) == 0.0);
        CHECK(radiosity_of(black, preset) == 1.0);
    }
    CHECK(run_hemi({"solve", dark, "--device", "osmesa"}).err_has("nothing radiates"));
}

TEST_CASE("extremes: two patches light each other as their factor says", "[cli]") {
    const Directory directory;
    Json scene = square(0.5, 1.0, 0.0);
    scene["surfaces"].push_back({{"name", "lid"},
                                 {"material", "grey"},
                                 {"polygon", Json::parse("[[0,0,1],[0,1,1],[1,1,1],[1,0,1]]")}});
    const std::string path = directory.write("two.json", scene);
    // B = 1 + F B / 2 on both; F = 0.19982 of the unit squares, 0.2394 from the centre of one.
    CHECK(radiosity_of(path, "plain") == Approx(1.0 / (1.0 - 0.5 * 0.2394)).margin(1e-3));
    CHECK(radiosity_of(path, "exact", 1) == Approx(1.0 / (1.0 - 0.5 * 0.199824895698)).margin(1e-6));
}

TEST_CASE("extremes: where all is black, all patches have what they give, and nothing is computed", "[cli]") {
    const Directory directory;
    Json scene = cube(3);
    scene["materials"]["white"]["reflectance"] = 0;
    scene["materials"]["white"]["exitance"] = 0.25;
    const Json solution = run_hemi(quick({"solve", directory.write("black.json", scene), "--json"})).json();
    CHECK(solution["renderer"] == "none");
    CHECK(solution["radiosity"][0][0] == 0.25);
    CHECK(solution["radiosity"][5][0] == 1.0);
}

TEST_CASE("extremes: a scene of faces without area is refused", "[cli]") {
    const Directory directory;
    Json scene = square(0.5, 1.0, 0.0);
    scene["surfaces"][0]["polygon"] = Json::parse("[[0,0,0],[1,0,0],[2,0,0],[3,0,0]]");
    const std::string path = directory.write("flat.json", scene);
    const Outcome refused = run_hemi({"solve", path, "--strict"});
    CHECK(refused.status == 3);
    CHECK(refused.err_has("surfaces[0].polygon: zero area"));
    const Outcome empty = run_hemi({"solve", path});
    CHECK(empty.status == 3);
    CHECK(empty.err_has("the scene has no surfaces"));
}

TEST_CASE("extremes: a scene lost in the rounding of its coordinates is refused", "[cli]") {
    const Directory directory;
    const hemi::Scene room = hemi::test::scaled(hemi::test::room_with_blocks(2), 1e-3);
    const auto at = [&](double distance) {
        const hemi::Scene scene = hemi::test::moved(room, hemi::Vec3(distance, 0.0, 0.0));
        return run_hemi({"info", directory.write("far.json", hemi::test::scene_json(scene))});
    };
    CHECK(at(1e5).status == 0);
    const Outcome refused = at(1e10);
    CHECK(refused.status == 3);
    CHECK(refused.err_has("move it towards the origin"));
}

TEST_CASE("extremes: 100,000 patches in too little memory are refused with figures", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("many.json", cube(130));
    for (const char* preset : {"plain", "default"}) {
        const Outcome run = run_hemi({"factors", scene, "--preset", preset, "--resolution", "32", "--device",
                                      "osmesa", "--max-memory", "200M"});
        INFO(preset << ": " << run.err);
        CHECK(run.status == 1);
        CHECK(run.err_has("101,400 rows of about"));
        CHECK(run.err_has("the limit is 200 MiB"));
    }
}

TEST_CASE("extremes: scales of 1e-6 and 1e6 change no factor by group", "[cli]") {
    const Directory directory;
    const auto table = [&](double scale, const char* preset) {
        const hemi::Scene scene = hemi::test::scaled(hemi::test::room_with_blocks(3), scale);
        const Outcome run =
            run_hemi({"factors", directory.write("room.json", hemi::test::scene_json(scene)), "--by-group",
                      "--json", "-q", "--device", "osmesa", "--preset", preset});
        REQUIRE(run.status == 0);
        return run.json()["factors"];
    };
    for (const char* preset : {"plain", "default"}) {
        const Json base = table(1.0, preset);
        for (const double scale : {1e-6, 1e6}) {
            const Json other = table(scale, preset);
            for (std::size_t g = 0; g < base.size(); ++g) {
                for (std::size_t h = 0; h < base.size(); ++h) {
                    INFO(preset << ", scaled by " << scale << ", " << g << " to " << h);
                    CHECK(other[g][h].get<double>() ==
                          Approx(base[g][h].get<double>()).margin(5e-4).epsilon(0));
                }
            }
        }
    }
}
