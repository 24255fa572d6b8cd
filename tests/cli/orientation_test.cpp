#include "cli/program.hpp"

#include <catch2/catch.hpp>

using namespace hemi::cli_test;

namespace {

/// A unit cube of six groups; faces of `out` look outwards, the others inwards.
std::string cube_of(const std::string& out) {
    const std::pair<const char*, const char*> faces[] = {{"floor", "1 2 3 4"}, {"roof", "5 8 7 6"},
                                                         {"south", "1 5 6 2"}, {"east", "2 6 7 3"},
                                                         {"north", "3 7 8 4"}, {"west", "4 8 5 1"}};
    std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    for (const auto& [name, corners] : faces) {
        std::string order = corners;
        if (out.find(name) != std::string::npos) {
            std::reverse(order.begin(), order.end());
        }
        text += "g " + std::string(name) + "\nf " + order + "\n";
    }
    return text;
}

const std::string all = "floor roof south east north west";

/// Group factors from the floor to the roof and to a wall, of a cube that looks inwards.
void check_cube(const Outcome& run) {
    REQUIRE(run.status == 0);
    const Json factors = run.json()["factors"];
    CHECK(factors[0][1].get<double>() == Approx(0.199825).margin(2e-4));
    CHECK(factors[0][2].get<double>() == Approx(0.200044).margin(2e-4));
}

} // namespace

TEST_CASE("orientation: a cube inside out is told, and turned", "[cli]") {
    const Directory directory;
    const std::string path = directory.write("cube.obj", cube_of(all));
    for (const char* command : {"factors", "check", "solve"}) {
        INFO(command);
        const Outcome run = run_hemi(quick({command, path}));
        CHECK(run.err_has("no patch sees the front of another: all factors are 0"));
        CHECK(run.err_has("--flip turns all of them"));
    }
    for (const std::vector<std::string>& turned :
         {std::vector<std::string>{"--flip"}, {"--flip-group", "*"}, {"--orient", "in"}}) {
        std::vector<std::string> words{"factors", path, "--by-group", "--json", "--device", "cpu"};
        words.insert(words.end(), turned.begin(), turned.end());
        const Outcome run = run_hemi(words);
        CHECK_FALSE(run.err_has("no patch sees"));
        check_cube(run);
    }
    CHECK(run_hemi({"info", path, "--flip", "--flip-group", "floor"}).status == 2);
    for (const char* option : {"--flip-group", "--one-sided-group", "--two-sided"}) {
        const Outcome wrong = run_hemi({"info", path, option, "flor"});
        CHECK(wrong.status == 2);
        CHECK(wrong.err_has("did you mean \"floor\""));
    }
    CHECK(run_hemi({"info", path, "--orient", "in"}).err_has("cube.obj: 6 of 6 faces turned round"));
    CHECK(run_hemi({"info", path, "--orient", "out"}).err_has("cube.obj: 0 of 6 faces turned round"));
    for (const std::vector<std::string>& turned : {std::vector<std::string>{"--flip"},
                                                   {"--flip-group", "*"},
                                                   {"--orient", "in"},
                                                   {"--flip", "--one-sided-group", "*"}}) {
        std::vector<std::string> words{"factors", path, "--json", "--from-point", "0.5,0.5,0.5,0,0,1"};
        words.insert(words.end(), turned.begin(), turned.end());
        const Outcome run = run_hemi(words);
        REQUIRE(run.status == 0);
        CHECK(run.json()["sum"].get<double>() == Approx(1.0));
    }
    const std::string json =
        directory.write("cube.json", R"({"hemi": 1, "surfaces": [{"mesh": "cube.obj", "flip": true}]})");
    check_cube(run_hemi({"factors", json, "--by-group", "--json", "--device", "cpu"}));
    check_cube(run_hemi({"factors", path, "--by-group", "--json", "--device", "cpu", "--flip-group", "floor",
                         "--flip-group", "roof", "--flip-group", "south", "--flip-group", "east",
                         "--flip-group", "north", "--flip-group", "west"}));
}

TEST_CASE("orientation: watertight meshes with faces the wrong way round are named, and mended", "[cli]") {
    const Directory directory;
    CHECK_FALSE(run_hemi({"info", directory.write("in.obj", cube_of(""))}).err_has("turned against"));
    for (const std::string& out : {std::string("west"), std::string("south east north west"),
                                   std::string("floor roof south east north")}) {
        INFO(out);
        const std::string path = directory.write("mixed.obj", cube_of(out));
        const bool one = out.find(' ') == std::string::npos || out.find("floor") != std::string::npos;
        CHECK(run_hemi(quick({"check", path}))
                  .err_has(one ? "1 face of a watertight body is turned against the others: face 5 of west;"
                               : "2 faces of watertight bodies are turned against the others: face 0 of "
                                 "floor, ...;"));
        check_cube(run_hemi({"factors", path, "--by-group", "--json", "--device", "cpu", "--orient", "in"}));
    }
}

TEST_CASE("orientation: a room of which everything is double-sided becomes one-sided when asked", "[cli]") {
    const Directory directory;
    const std::string path = directory.write("cube.obj", cube_of(""));
    CHECK(run_hemi({"info", path, "--two-sided", "*", "--json"}).json()["patches"] == 12);
    const Outcome both = run_hemi({"info", path, "--two-sided", "*", "--one-sided-group", "floor"});
    CHECK(both.status == 2);
    CHECK(both.err_has("group \"floor\" cannot be made both two-sided and one-sided"));
    CHECK(run_hemi({"info", path, "--two-sided", "west", "--one-sided-group", "floor", "--json"})
              .json()["patches"] == 7);
    Json scene = Json::parse(R"({"hemi": 1, "materials": {"w": {"reflectance": 0.5}}, "surfaces": []})");
    for (const char* name : {"a", "b"}) {
        scene["surfaces"].push_back({{"name", name},
                                     {"material", "w"},
                                     {"two_sided", true},
                                     {"polygon", Json::parse("[[0,0,0],[1,0,0],[1,1,0]]")}});
    }
    const std::string sheets = directory.write("sheets.json", scene);
    CHECK(run_hemi({"info", sheets, "--json"}).json()["patches"] == 4);
    CHECK(run_hemi({"info", sheets, "--one-sided-group", "a", "--json"}).json()["patches"] == 3);
    CHECK(run_hemi({"info", sheets, "--one-sided-group", "*", "--json"}).json()["patches"] == 2);
}
