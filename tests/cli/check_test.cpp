#include "cli/program.hpp"

#include <catch2/catch.hpp>

using namespace hemi::cli_test;

namespace {

/// A box of side 0.4 from (0.3, 0.3, 0) up, without its bottom, seen from outside; in group "box".
void add_box(Json& scene, const std::string& material) {
    const char* faces[] = {"[[0.3,0.3,0.4],[0.7,0.3,0.4],[0.7,0.7,0.4],[0.3,0.7,0.4]]",
                           "[[0.3,0.3,0],[0.7,0.3,0],[0.7,0.3,0.4],[0.3,0.3,0.4]]",
                           "[[0.7,0.3,0],[0.7,0.7,0],[0.7,0.7,0.4],[0.7,0.3,0.4]]",
                           "[[0.7,0.7,0],[0.3,0.7,0],[0.3,0.7,0.4],[0.7,0.7,0.4]]",
                           "[[0.3,0.7,0],[0.3,0.3,0],[0.3,0.3,0.4],[0.3,0.7,0.4]]"};
    for (const char* face : faces) {
        scene["surfaces"].push_back(
            {{"name", "box"}, {"material", material}, {"polygon", Json::parse(face)}, {"patches", {2, 2}}});
    }
}

} // namespace

TEST_CASE("check: a sound closed scene passes", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(4));
    const Outcome run = run_hemi(quick({"check", scene}));
    CHECK(run.status == 0);
    CHECK(run.out_has("closed (declared)"));
    CHECK(run.out_has("reciprocity"));
    CHECK(run.out_has("within 0.0001"));
    const Json json = run_hemi(quick({"check", scene, "--json"})).json();
    CHECK(json["schema"] == "hemi/check/1");
    CHECK(json["ok"] == true);
    CHECK(json["rows"] == 96);
    CHECK(json["leaks"]["count"] == 0);
    CHECK(json["blocked"]["count"] == 0);
    CHECK(json["unseen"]["count"] == 0);
    CHECK(json["balance_error"] < 1e-6);
    CHECK(json["reciprocity"]["pairs"] > 100);
    CHECK(json["reciprocity"]["worst"].size() == 2);

    const std::string file = directory.path("a.hff");
    REQUIRE(run_hemi(quick({"factors", scene, "-o", file})).status == 0);
    const Outcome stored = run_hemi({"check", file, "--json"});
    CHECK(stored.status == 0);
    CHECK(stored.json()["row_sum"] == json["row_sum"]);
    CHECK(stored.json()["reciprocity"] == json["reciprocity"]);
    CHECK(run_hemi({"check", file, "--seed", "1"}).status == 2);
    REQUIRE(run_hemi({"convert", file, directory.path("a.mtx"), "-q"}).status == 0);
    CHECK(run_hemi({"check", directory.path("a.mtx")}).status == 2);
}

TEST_CASE("check: leaks of a closed scene are listed with their places", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("open.json", open_cube(2, "closed"));
    const Outcome run = run_hemi(quick({"check", scene}));
    CHECK(run.status == 5);
    CHECK(run.out_has("20 patches: they see the environment"));
    CHECK(run.out_has("patch 0 (floor, at 0.25 0.25 0): 0.2"));
    CHECK(run.out_has(", towards "));
    CHECK(run.out_has("and 10 more"));
    CHECK(run.out_has("out of tolerance (0.0001): 20 patches leak"));
    const Json json = run_hemi(quick({"check", scene, "--json"})).json();
    CHECK(json["ok"] == false);
    CHECK(json["leaks"]["count"] == 20);
    CHECK(json["leaks"]["worst"].size() == 10);
    CHECK(json["leaks"]["worst"][0]["centre"].size() == 3);
    CHECK(json["leaks"]["worst"][0]["towards"].size() == 3);
    CHECK(run_hemi(quick({"check", scene, "--enclosure", "open"})).status == 0);
    CHECK(run_hemi(quick({"check", scene, "--max-row-error", "0.9"})).status == 0);
}

TEST_CASE("check: a scene with a small gap is called nearly closed", "[cli]") {
    const Directory directory;
    // The floor ends early: through the gap only what is high up on the back wall's side sees out.
    Json scene = cube(10, "auto");
    scene["surfaces"][0]["polygon"] = Json::parse("[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]");
    scene["surfaces"][4]["polygon"] = Json::parse("[[0,1,0.0005],[1,1,0.0005],[1,1,1],[0,1,1]]");
    const std::string path = directory.write("slit.json", scene);
    const Outcome run = run_hemi(quick({"check", path}));
    INFO(run.out);
    CHECK(run.status == 0);
    CHECK(run.out_has("nearly closed (from the rows)"));
    CHECK(run.out_has("if the scene is meant to be closed, there are gaps"));
    CHECK(run.err_has("nearly closed"));
    CHECK(run_hemi(quick({"check", path, "--enclosure", "open"})).err.empty());
    const Json json = run_hemi(quick({"check", path, "--json"})).json();
    CHECK(json["enclosure"] == "nearly closed");
    CHECK(json["leaks"]["count"] == json["leaking"]);
}

TEST_CASE("check: what sticks out of a closed room is not judged", "[cli]") {
    const Directory directory;
    Json room = cube(2);
    room["enclosure"] = "auto";
    for (const char* polygon : {"[[0.3,0.3,0.2],[0.5,0.3,0.2],[0.5,0.5,0.2],[0.3,0.5,0.2]]",
                                "[[0.3,0.3,-0.1],[0.5,0.3,-0.1],[0.5,0.3,0.2],[0.3,0.3,0.2]]",
                                "[[0.5,0.3,-0.1],[0.5,0.5,-0.1],[0.5,0.5,0.2],[0.5,0.3,0.2]]",
                                "[[0.5,0.5,-0.1],[0.3,0.5,-0.1],[0.3,0.5,0.2],[0.5,0.5,0.2]]",
                                "[[0.3,0.5,-0.1],[0.3,0.3,-0.1],[0.3,0.3,0.2],[0.3,0.5,0.2]]",
                                "[[0.3,0.3,-0.1],[0.3,0.5,-0.1],[0.5,0.5,-0.1],[0.5,0.3,-0.1]]"}) {
        room["surfaces"].push_back(
            {{"name", "box"}, {"material", "white"}, {"polygon", Json::parse(polygon)}});
    }
    const std::string scene = directory.write("box.json", room);
    const Outcome check = run_hemi({"check", scene, "--device", "cpu", "--json"});
    CHECK(check.status == 0);
    CHECK(check.json()["outside"]["count"] == 5); // which see the floor's back
    CHECK(check.json()["blocked"]["count"] == 0);
    CHECK(check.json()["straddled"]["count"] == 0);
    // Nor is a face that is turned in the room taken for one outside.
    std::swap(room["surfaces"][6]["polygon"][1], room["surfaces"][6]["polygon"][3]);
    const Outcome turned =
        run_hemi({"check", directory.write("turned.json", room), "--device", "cpu", "--json"});
    CHECK(turned.status == 5);
}

TEST_CASE("check: covered patches are told from turned surfaces", "[cli]") {
    const Directory directory;
    Json scene = cube(8);
    add_box(scene, "white");
    const std::string box = directory.write("box.json", scene);
    // One texel beside a silhouette may meet the back behind it.
    const Outcome covered = run_hemi(quick({"check", box, "--no-imprint", "--max-row-error", "1e-3"}));
    INFO(covered.out);
    CHECK(covered.status == 0); // covered patches are no error
    CHECK(covered.out_has("under or inside other geometry"));
    const Json json = run_hemi(quick({"check", box, "--no-imprint", "--json"})).json();
    CHECK(json["covered"]["count"] > 0);
    CHECK(json["turned"].empty());
    CHECK(run_hemi(quick({"factors", box, "--no-imprint"})).err_has("buried"));

    Json turned = cube(4);
    Json& polygon = turned["surfaces"][1]["polygon"];
    polygon = Json({polygon[3], polygon[2], polygon[1], polygon[0]});
    const Outcome run = run_hemi(quick({"check", directory.write("turned.json", turned)}));
    CHECK(run.status == 5);
    CHECK(run.out_has("left: 1 surface, 16 patches"));
    const Json report = run_hemi(quick({"check", directory.path("turned.json"), "--json"})).json();
    REQUIRE(report["turned"].size() == 1);
    CHECK(report["turned"][0]["group"] == "left");
    CHECK(report["blocked"]["count"] == 80);
    CHECK(report["unseen"]["count"] == 16);
}
