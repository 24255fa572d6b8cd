#include "cli/program.hpp"

#include <catch2/catch.hpp>

#include <string>

using namespace hemi::cli_test;
using Catch::Matchers::Contains;

namespace {

Outcome solve(const Directory& directory, const std::string& table, Words more = {}) {
    Words words{"solve",           directory.write("cube.json", coloured(2)),
                "--device",        "cpu",
                "--preset",        "fast",
                "--no-estimate",   "--json",
                "--exitance-from", directory.write("lamps.csv", table)};
    words.insert(words.end(), more.begin(), more.end());
    return run_hemi(words);
}

} // namespace

TEST_CASE("solve: exitances of single faces come from a table", "[cli]") {
    const Directory directory;
    // Faces of the cube are groups, in their order; the last one is the lamp.
    const Json run =
        solve(directory, "index,exitance_red,name,exitance_blue\n1,3,left,\n\n5,0,lamp,0.25\n").json();
    const Json before = solve(directory, "index,exitance\n").json();
    for (std::size_t g = 0; g < 6; ++g) {
        const Json expected = g == 1   ? Json{3.0, before["exitance"][g][1], before["exitance"][g][2]}
                              : g == 5 ? Json{0.0, before["exitance"][g][1], 0.25}
                                       : before["exitance"][g];
        CHECK(run["exitance"][g] == expected);
    }
    const Json all = solve(directory, "index,exitance\n0,7\n").json();
    CHECK(all["exitance"][0] == Json{7.0, 7.0, 7.0});
}

TEST_CASE("solve: the table of one run lights another one", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(1));
    const Words common{"solve", scene, "--device", "cpu", "--no-estimate", "--json"};
    const auto run = [&](Words more) {
        more.insert(more.begin(), common.begin(), common.end());
        const Outcome outcome = run_hemi(more);
        INFO(outcome.err);
        REQUIRE(outcome.status == 0);
        return outcome.json();
    };
    const Json first = run({"--radiosity", directory.path("r.csv")});
    const Json second = run({"--exitance-from", directory.path("r.csv")});
    CHECK(second["radiosity"] == first["radiosity"]);
}

TEST_CASE("solve: a table of exitances that does not fit is refused", "[cli]") {
    const Directory directory;
    const auto refusal = [&](const std::string& table) {
        const Outcome run = solve(directory, table);
        CHECK(run.status == 3);
        return run.err;
    };
    CHECK_THAT(refusal("exitance\n1\n"), Contains("lamps.csv: no column \"index\""));
    CHECK_THAT(refusal("index,light\n0,1\n"),
               Contains("no column \"exitance\", nor exitance_red, exitance_green"));
    CHECK_THAT(refusal("index,exitance,exitance_red\n0,1,1\n"), Contains("leave one kind out"));
    CHECK_THAT(refusal("index,exitance\n6,1\n"),
               Contains("lamps.csv:2") && Contains("index '6'; must be the number of a face, 0 to 5"));
    CHECK_THAT(refusal("index,exitance\n0.5,1\n"), Contains("index '0.5'"));
    CHECK_THAT(refusal("index,exitance\n0,1\n0,2\n"),
               Contains("lamps.csv:3") && Contains("face 0 a second time; it is on line 2"));
    CHECK_THAT(refusal("index,exitance\n0,-1\n"),
               Contains("exitance '-1'; must be a finite number that is not negative"));
    CHECK_THAT(refusal("index,exitance\n0,bright\n"), Contains("exitance 'bright'"));
}
