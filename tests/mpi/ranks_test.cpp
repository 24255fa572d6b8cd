#include "cli/program.hpp"
#include "support/command.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>

using namespace hemi::cli_test;
using hemi::test::CommandOutcome;
using hemi::test::run_command;

// Compiled where the program for MPI is: what starts it is in HEMI_MPIEXEC and HEMI_MPIEXEC_RANKS.

namespace {

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// More ranks than cores, and root, are allowed; threads are not bound, and no rank waits by spinning.
Words started(int ranks) {
    return {"env",
            "OMPI_ALLOW_RUN_AS_ROOT=1",
            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
            "OMPI_MCA_rmaps_base_oversubscribe=1",
            "OMPI_MCA_hwloc_base_binding_policy=none",
            "OMPI_MCA_mpi_yield_when_idle=1",
            "OMPI_MCA_btl_vader_single_copy_mechanism=none",
            HEMI_MPIEXEC,
            HEMI_MPIEXEC_RANKS,
            std::to_string(ranks)};
}

CommandOutcome run_ranks(int ranks, const Words& words) {
    return run_command(with(with(started(ranks), {HEMI_MPI_PROGRAM}), words));
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        ++found;
    }
    return found;
}

const std::string room = HEMI_SOURCE_DIR "/scenes/l-room.json"; // hides parts of itself

} // namespace

TEST_CASE("Ranks: any number of them write the form factors of one process", "[mpi]") {
    const Directory directory;
    const auto compare = [&](const Words& settings, const std::vector<int>& numbers) {
        const Words command = with({"factors", room, "--device", "cpu"}, settings);
        const Outcome one = run_hemi(with(command, {"-o", directory.path("one.hff")}));
        INFO(one.err);
        REQUIRE(one.status == 0);
        for (const int ranks : numbers) {
            const CommandOutcome run = run_ranks(ranks, with(command, {"-o", directory.path("F.hff"), "-v"}));
            INFO(ranks << " ranks\n" << run.err);
            CHECK(run.status == 0);
            CHECK(count(run.out, "row sums") == 1); // of the first rank alone
            CHECK((directory.read("F.hff") == directory.read("one.hff")));
            CHECK(directory.names() == Words{"F.hff", "one.hff"});
            std::filesystem::remove(directory.path("F.hff"));
        }
    };
    compare({"--patches-per-face", "9"}, {1, 2, 3});
    compare({"--patches-per-face", "9", "--preset", "plain", "--no-estimate"}, {2});
}

TEST_CASE("Ranks: any number of them find the solution of one process, by every solver", "[mpi]") {
    const Directory directory;
    const std::string file = directory.path("a.hres");
    const auto compare = [&](const Words& settings, const std::vector<int>& numbers) {
        const Words command = with({"solve", HEMI_SOURCE_DIR "/scenes/cornell-box.json", "--device", "cpu",
                                    "--preset", "fast", "--patches-per-face", "4", "--result", file},
                                   settings);
        const Outcome one = run_hemi(command);
        INFO(one.err);
        REQUIRE((one.status == 0 || one.status == 5));
        const std::string expected = directory.read("a.hres");
        for (const int ranks : numbers) {
            std::filesystem::remove(file);
            const CommandOutcome run = run_ranks(ranks, command);
            INFO(ranks << " ranks\n" << run.err);
            CHECK(run.status == one.status);
            CHECK((directory.read("a.hres") == expected));
        }
    };
    compare({"--gather", "on"}, {2}); // Gauss–Seidel; with what pictures and errors need
    compare({"--solver", "jacobi", "--no-estimate"}, {2, 3});
    compare({"--solver", "cg", "--no-estimate"}, {3});
}

TEST_CASE("Ranks: with far patches in clusters, a solution and its error are those of one process", "[mpi]") {
    const Directory directory;
    // So many patches that a sample of rows is computed first.
    const Words command{"solve",           room, "--device",           "cpu", "--preset", "fast",
                        "--clusters",      "on", "--patches-per-face", "36",  "--json",   "--result",
                        "--cluster-error", "5%"};
    const auto with_result = [&](const std::string& name) {
        Words words = command;
        words.insert(std::find(words.begin(), words.end(), "--result") + 1, directory.path(name));
        return words;
    };
    const auto without_seconds = [](Json run) {
        run.erase("seconds");
        run["repair"].erase("seconds");
        run["solver"].erase("seconds");
        return run;
    };
    const Outcome one = run_hemi(with_result("one.hres"));
    INFO(one.err);
    REQUIRE(one.status == 0);
    const Json expected = without_seconds(one.json());
    REQUIRE(expected["clusters"] == true);
    REQUIRE(expected["patches"].get<int>() > 256);
    REQUIRE(expected["error"]["vertices"]["rms"].get<double>() > 0.0);
    for (const int ranks : {1, 2, 3}) {
        const CommandOutcome run = run_ranks(ranks, with_result("a.hres"));
        INFO(ranks << " ranks\n" << run.err);
        REQUIRE(run.status == 0);
        CHECK(without_seconds(Json::parse(run.out)) == expected);
        CHECK((directory.read("a.hres") == directory.read("one.hres")));
        std::filesystem::remove(directory.path("a.hres"));
    }
}

TEST_CASE("Ranks: vertices of a large scene are gathered as in one process", "[mpi][slow]") {
    const Directory directory;
    // So many patches that vertices see what is far in clusters, too; few of them see anything.
    const std::string scene = directory.write("plate.json", R"({"hemi": 1, "patch_size": 0.1,
        "materials": {"floor": {"reflectance": 0.5}, "lamp": {"reflectance": 0, "exitance": 10}}, "surfaces": [
        {"material": "floor", "polygon": [[0,0,0],[18.2,0,0],[18.2,18.2,0],[0,18.2,0]]},
        {"material": "lamp", "polygon": [[8,8,0.5],[8,8.2,0.5],[8.2,8.2,0.5],[8.2,8,0.5]]}]})");
    const auto command = [&](const std::string& name) {
        return Words{"solve",         scene,      "--device",          "cpu",
                     "--preset",      "fast",     "--clusters",        "on",
                     "--gather",      "on",       "--scratch",         directory.path("."),
                     "--no-estimate", "--result", directory.path(name)};
    };
    const Outcome one = run_hemi(command("one.hres"));
    INFO(one.err);
    REQUIRE(one.status == 0);
    for (const int ranks : {2, 3}) {
        const CommandOutcome run = run_ranks(ranks, command("a.hres"));
        INFO(ranks << " ranks\n" << run.err);
        REQUIRE(run.status == 0);
        CHECK((directory.read("a.hres") == directory.read("one.hres")));
    }
}

TEST_CASE("Ranks: more of them than there are patches", "[mpi]") {
    const Directory directory;
    const std::string scene = directory.write(
        "one.json", R"({"hemi": 1, "materials": {"m": {"reflectance": 0.5, "exitance": 1}}, "surfaces": [
        {"material": "m", "polygon": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]]}]})");
    const CommandOutcome run =
        run_ranks(2, {"solve", scene, "--device", "cpu", "--solver", "jacobi", "--json"});
    INFO(run.err);
    REQUIRE(run.status == 0);
    CHECK(has(run.out, "\"radiosity\":[[1.0]]"));
}

TEST_CASE("Ranks: rows of some patches alone, and heat, are those of one process", "[mpi]") {
    const Directory directory;
    const Words command = GENERATE(as<Words>(), Words{"solve", room, "--patches-per-face", "4", "--factors"},
                                   Words{"heat", HEMI_SOURCE_DIR "/scenes/furnace-hot.json", "--factors"},
                                   Words{"heat", HEMI_SOURCE_DIR "/scenes/furnace-hot.json", "--clusters",
                                         "on", "--cluster-error", "2%", "--factors"});
    const Words settings{"--device", "cpu", "--json"};
    const Outcome one = run_hemi(with(with(command, {directory.path("one.hff")}), settings));
    INFO(one.err);
    REQUIRE(one.status == 0);
    const CommandOutcome run = run_ranks(3, with(with(command, {directory.path("F.hff")}), settings));
    INFO(run.err);
    CHECK(run.status == 0);
    CHECK((directory.read("F.hff") == directory.read("one.hff")));
    Json expected = one.json();
    Json found = Json::parse(run.out);
    for (Json* const json : {&expected, &found}) {
        json->erase("seconds");
        (*json)["repair"].erase("seconds");
    }
    CHECK(found == expected);
}

TEST_CASE("Ranks: what only one process can do is refused, once", "[mpi]") {
    const Directory directory;
    struct Case {
        Words words;
        const char* message;
    };
    for (const Case& refused : {Case{{"check", room}, "only factors, solve and heat are shared out"},
                                Case{{"solve", room, "--refine", "100"}, "--refine by 2 ranks"}}) {
        const CommandOutcome run = run_ranks(2, refused.words);
        INFO(run.err);
        CHECK(run.status == 2);
        CHECK(count(run.err, "hemi: error:") == 1);
        CHECK(has(run.err, refused.message));
    }
    const CommandOutcome missing = run_ranks(2, {"solve", directory.path("no.json")});
    CHECK(missing.status == 3);
    CHECK(count(missing.err, "no.json") == 1);
}

TEST_CASE("Ranks: one that dies ends all, and what all had finished is taken up again", "[mpi]") {
    const Directory directory;
    const Words rows = GENERATE(Words{"--preset", "plain"}, Words{"--preset", "fast", "--clusters", "on"});
    const Words settings = with(rows, {"--device", "cpu", "--patches-per-face", "100", "--eye-points", "16",
                                       "--resolution", "64", "--no-estimate"});
    const Words command = with({"factors", room, "-o", directory.path("F.hff")}, settings);
    // The second rank is killed when it has kept rows.
    const std::string script =
        "number=\"$1\"; shift; file=\"$1\"; shift\n"
        "export number file\n"
        "\"$@\" & all=$!\n"
        "for k in $(seq 3000); do [ -s \"$file.2of2.rows\" ] && break; sleep 0.01; done\n"
        "kill -KILL \"$(cat \"$number.1\")\"\n"
        "wait $all";
    const std::string start = "echo $$ >\"$number.$OMPI_COMM_WORLD_RANK\"; exec \"$@\"";
    const CommandOutcome killed = run_command(
        with(with({"sh", "-c", script, "sh", directory.path("number"), directory.path("F.hff")}, started(2)),
             with({"sh", "-c", start, "sh", HEMI_MPI_PROGRAM}, command)));
    INFO(killed.err);
    CHECK(killed.status != 0);
    REQUIRE(directory.has("F.hff.2of2.rows"));
    REQUIRE(directory.has("F.hff.1of2.rows"));
    for (const char* name : {"number.0", "number.1"}) {
        std::filesystem::remove(directory.path(name));
    }
    CHECK(!directory.has("F.hff"));
    const CommandOutcome resumed = run_ranks(2, with(command, {"--resume"}));
    INFO(resumed.err);
    CHECK(resumed.status == 0);
    CHECK(has(resumed.err, "taken from the checkpoint"));
    const std::string found = directory.read("F.hff");
    CHECK(directory.names() == Words{"F.hff"});
    REQUIRE(run_hemi(command).status == 0);
    CHECK((directory.read("F.hff") == found));
}
