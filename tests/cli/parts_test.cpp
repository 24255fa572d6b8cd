#include "cli/program.hpp"
#include "support/command.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

using namespace hemi::cli_test;
using hemi::test::run_command;

namespace {

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// Computes a part of a scene, which must succeed.
void make_part(const Directory& directory, const std::string& scene, const std::string& rows,
               const std::string& file, const Words& settings, const Words& environment = {}) {
    const Outcome run =
        run_hemi(with({"factors", scene, "--rows", rows, "-o", directory.path(file)}, settings), environment);
    INFO(run.err);
    REQUIRE(run.status == 0);
}

/// Merges `a.hff` and `b.hff`.
Outcome merge(const Directory& directory) {
    return run_hemi(
        {"merge", directory.path("a.hff"), directory.path("b.hff"), "-o", directory.path("F.hff")});
}

} // namespace

TEST_CASE("Parts: merged they are to the byte what one run writes, in every preset", "[cli]") {
    const Words settings = GENERATE(
        as<Words>(), Words{"--preset", "plain"}, Words{"--preset", "fast"}, Words{"--preset", "default"},
        Words{"--preset", "exact", "--eye-points", "4"}, Words{"--no-estimate", "--enclosure", "open"},
        Words{"--method", "montecarlo", "--rays", "256", "--no-estimate"},
        Words{"--preset", "fast", "--device", "osmesa"});
    const Directory directory;
    const std::string scene = HEMI_SOURCE_DIR "/scenes/l-room.json"; // hides parts of itself
    const bool has_device = settings.front() == "--method" || settings.back() == "osmesa";
    const Words coarse =
        with({"--patches-per-face", "4"}, has_device ? settings : with({"--device", "cpu"}, settings));
    const Outcome one = run_hemi(with({"factors", scene, "-o", directory.path("one.hff")}, coarse));
    INFO(one.err);
    REQUIRE((one.status == 0 || one.status == 5));
    make_part(directory, scene, "1/2", "b.hff", coarse);
    make_part(directory, scene, "2/2", "a.hff", coarse);
    const Outcome run = merge(directory);
    INFO(run.err);
    CHECK(run.status == one.status);
    CHECK((directory.read("F.hff") == directory.read("one.hff")));
    CHECK(directory.names() == Words{"F.hff", "a.hff", "b.hff", "one.hff"});
}

TEST_CASE("Parts: faces that are cut where they touch, and another instruction set, change nothing",
          "[cli]") {
    const Directory directory;
    const std::string scene = HEMI_SOURCE_DIR "/scenes/cornell-box.json";
    const Words settings{"--device", "cpu", "--preset", "fast", "--patches-per-face", "9"};
    const Words simd{"HEMI_SIMD=scalar"};
    const Outcome one = run_hemi(with({"factors", scene, "-o", directory.path("one.hff")}, settings), simd);
    make_part(directory, scene, "1/2", "a.hff", settings, simd);
    INFO(one.err);
    REQUIRE(directory.has("one.hff"));
    make_part(directory, scene, "2/2", "b.hff", settings);
    const Json stored = run_hemi({"info", directory.path("one.hff"), "--json"}).json();
    REQUIRE(stored["parts"] > stored["patches"]);
    CHECK(merge(directory).status == one.status);
    CHECK((directory.read("F.hff") == directory.read("one.hff")));
}

TEST_CASE("Parts: nothing but a merge takes one, and a merge takes only all of one run", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2)); // 24 patches
    const Words settings{"--device", "cpu", "--preset", "plain", "--no-estimate"};
    make_part(directory, scene, "0:10", "a.hff", settings);
    const auto refused = [&](const std::string& message) {
        const Outcome run = merge(directory);
        CHECK(run.status == 3);
        INFO(run.err);
        CHECK(run.err_has(message));
        CHECK(!directory.has("F.hff"));
    };
    SECTION("elsewhere") {
        for (const Words& words :
             {Words{"info", directory.path("a.hff")},
              Words{"convert", directory.path("a.hff"), directory.path("a.npz")},
              Words{"check", directory.path("a.hff")},
              Words{"solve", scene, "--device", "cpu", "--factors", directory.path("a.hff")}}) {
            const Outcome run = run_hemi(words);
            CHECK(run.status == 3);
            CHECK(
                run.err_has("a.hff: a part with rows 0 to 9 of 24; `hemi merge` makes form factors of all"));
        }
    }
    SECTION("gaps") {
        make_part(directory, scene, "12:23", "b.hff", settings);
        refused("rows 10 to 11, row 23 of 24 are in no part");
    }
    SECTION("overlaps") {
        make_part(directory, scene, "8:24", "b.hff", settings);
        refused("b.hff: both have rows 8 to 9");
    }
    SECTION("other settings") {
        make_part(directory, scene, "10:24", "b.hff", with(settings, {"--seed", "7"}));
        refused("b.hff: a part of another run than " + directory.path("a.hff") + ": seed 7, there 0");
    }
    SECTION("other renderers") {
        make_part(directory, scene, "10:24", "b.hff",
                  {"--device", "osmesa", "--preset", "plain", "--no-estimate"});
        refused("there hemi CPU rasteriser");
    }
    SECTION("other scenes") {
        const std::string other = directory.write("other.json", cube(3));
        make_part(directory, other, "10:24", "b.hff", settings);
        refused(": geometry ");
    }
    SECTION("no parts") {
        REQUIRE(run_hemi({"factors", scene, "--device", "cpu", "-o", directory.path("b.hff")}).status == 0);
        refused("b.hff: does not hold a part of form factors");
    }
    SECTION("damage") {
        make_part(directory, scene, "10:24", "b.hff", settings);
        std::string bytes = directory.read("b.hff");
        directory.write("b.hff", bytes.substr(0, bytes.size() - 100));
        refused("b.hff: ");
    }
}

TEST_CASE("Parts: what --rows says must be rows of the scene, and what it excludes is refused", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    const std::string part = directory.path("a.hff");
    const auto refused = [&](const Words& words, const std::string& message) {
        const Outcome run = run_hemi(with({"factors", scene, "--device", "cpu"}, words));
        INFO(run.err);
        CHECK(run.status == 2);
        CHECK(run.err_has(message));
    };
    refused({"--rows", "0:25", "-o", part}, "--rows 0:25: the scene has 24 rows, counted from 0");
    refused({"--rows", "1/25", "-o", part}, "--rows 1/25: the scene has only 24 rows");
    refused({"--rows", "7", "-o", part}, "--rows 7: must be A:B");
    refused({"--rows", "7:7", "-o", part}, "--rows 7:7: 7 must be below 7");
    refused({"--rows", "3/2", "-o", part}, "--rows 3/2: 3 must be at most 2");
    refused({"--rows", "0/2", "-o", part}, "--rows 0");
    refused({"--rows", "0:7"}, "-o");
    refused({"--rows", "0:7", "-o", directory.path("a.npz")}, ".hff");
    refused({"--rows", "0:7", "-o", part, "--repair", "none"}, "--repair");
    refused({"--rows", "0:7", "-o", part, "--by-group"}, "--by-group");
    CHECK(run_hemi({"merge", part, "-o", part}).status == 2);
    CHECK(run_hemi({"merge", directory.path("none.hff"), "-o", part}).status == 3);
    CHECK(!directory.has("a.hff"));
}

TEST_CASE("Parts: an interrupted one goes on from its checkpoint, and no other does", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(16));
    const Words command{"factors", scene, "--device", "osmesa", "--jobs", "2", "-o", directory.path("a.hff")};
    {
        Run run(with(command, {"--rows", "1/2"}));
        for (int k = 0; k < 2000 && !directory.has("a.hff.rows"); ++k) {
            usleep(5000);
        }
        kill(run.pid(), SIGINT);
        REQUIRE(run.wait().status == 130);
    }
    REQUIRE(directory.has("a.hff.rows"));
    const Outcome other = run_hemi(with(command, {"--rows", "2/2", "--resume"}));
    CHECK(other.status == 3);
    CHECK(other.err_has("this checkpoint holds rows of another run: rows 0:768, here 768:1536"));
    const Outcome whole = run_hemi(with(command, {"--resume"}));
    CHECK(whole.status == 3);
    CHECK(whole.err_has("this checkpoint holds rows of another run: rows 0:768, here nothing"));
    const Outcome resumed = run_hemi(with(command, {"--rows", "1/2", "--resume"}));
    INFO(resumed.err);
    CHECK(resumed.status == 0);
    CHECK(resumed.err_has("of 768 rows taken from the checkpoint"));
    CHECK(directory.names() == Words{"a.hff", "cube.json"});
}

TEST_CASE("Parts: JSON says which rows there are, and what came of the merge", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2)); // 24 patches
    const auto part = [&](const std::string& rows, const std::string& file) {
        return run_hemi({"factors", scene, "--device", "cpu", "--json", "--rows", rows, "-o",
                         directory.path(file)})
            .json();
    };
    const Json first = part("0:10", "a.hff");
    CHECK(first["schema"] == "hemi/factors-part/1");
    CHECK(first["rows"] == Json({0, 10}));
    CHECK(first["size"] == 24);
    CHECK(part("10:24", "b.hff")["rows"] == Json({10, 24}));
    const Outcome run = run_hemi(
        {"merge", "--json", directory.path("b.hff"), directory.path("a.hff"), "-o", directory.path("F.hff")});
    INFO(run.err);
    const Json merged = run.json();
    CHECK(merged["schema"] == "hemi/merge/1");
    CHECK(merged["merged"] == 2);
    CHECK(merged["patches"] == 24);
    CHECK(merged["row_sum"]["mean"].get<double>() == Approx(1.0).margin(1e-4));

    const Outcome refused = run_hemi({"merge", "--max-memory", "1", directory.path("a.hff"),
                                      directory.path("b.hff"), "-o", directory.path("G.hff")});
    CHECK(refused.status == 1);
    CHECK(refused.err_has("the pairs of 24 patches and the largest part would need"));
    CHECK(!directory.has("G.hff"));
}

TEST_CASE("Parts: the script that shares rows out among processes compares them with one run", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    const std::string program = HEMI_SOURCE_DIR "/tools/parts";
    const auto run =
        run_command({"env", "HEMI_PROGRAM=" HEMI_PROGRAM, program, "-n", "3", scene, "--device", "cpu"});
    INFO(run.out);
    CHECK(run.status == 0);
    CHECK(run.out.find("3 parts merged") != std::string::npos);
    CHECK(run.out.find("equal to those of one process") != std::string::npos);
    CHECK(run_command({"env", "HEMI_PROGRAM=" HEMI_PROGRAM, program, "-n", "3", scene, "--device", "nowhere"})
              .status != 0);
}
