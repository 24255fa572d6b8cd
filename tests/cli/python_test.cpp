#include "cli/program.hpp"
#include "support/command.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

using namespace hemi::cli_test;
using hemi::test::run_command;

TEST_CASE("Python: the module reads what hemi writes, and the example draws a row", "[cli]") {
    const Directory directory;
    Json room = cube(4);
    if (GENERATE(false, true)) { // a sheet that cuts patches of the floor in two
        room["surfaces"].push_back(
            {{"name", "sheet"},
             {"material", "white"},
             {"two_sided", true},
             {"polygon", Json::parse("[[0.4,0.1,0],[0.4,0.6,0],[0.4,0.6,0.5],[0.4,0.1,0.5]]")}});
    }
    const std::string scene = directory.write("cube.json", room);
    const std::string hff = directory.path("a.hff");
    REQUIRE(
        run_hemi(quick({"factors", scene, "-o", hff, "--patches", directory.path("patches.csv")})).status ==
        0);
    for (const std::string name : {"a.npz", "a.csv", "a.mtx"}) {
        REQUIRE(run_hemi({"convert", hff, directory.path(name)}).status == 0);
    }
    directory.write("groups.json", run_hemi({"factors", hff, "--by-group", "--json"}).out);
    const auto module = run_command({"/usr/bin/python3", HEMI_TEST_DATA "/io/check_python_module.py",
                                     directory.path(""), HEMI_SOURCE_DIR "/tools/python"});
    INFO(module.err);
    CHECK(module.status == 0);
    CHECK(module.out == "all equal\n");

    const std::string plot_row = HEMI_SOURCE_DIR "/tools/python/plot_row.py";
    const auto example = run_command({"/usr/bin/python3", plot_row, hff, directory.path("patches.csv"),
                                      "--row", "5", "-o", directory.path("row.png")});
    INFO(example.err);
    CHECK(example.status == 0);
    CHECK(directory.read("row.png").substr(1, 3) == "PNG");
}
