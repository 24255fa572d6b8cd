#include "cli/program.hpp"

#include <catch2/catch.hpp>

#include <chrono>
#include <random>
#include <thread>
#include <utility>

using namespace hemi::cli_test;
using Clock = std::chrono::steady_clock;

namespace {

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// A command that writes form factors to a file, and how it is told which.
Words command_for(const std::string& command, const std::string& scene, const std::string& file) {
    return with({command, scene, command == "solve" ? "--factors" : "-o", file},
                {"--device", "osmesa", "--jobs", "2", "-v"});
}

/// Rows that a run said it took from an earlier one.
std::size_t reused(const Outcome& run) {
    const std::size_t end = run.err.find(" rows taken from the checkpoint ");
    if (end == std::string::npos) {
        return 0;
    }
    std::string digits = run.err.substr(0, run.err.rfind(" of ", end));
    digits = digits.substr(digits.find_last_of(' ') + 1);
    std::erase(digits, ',');
    return std::stoul(digits);
}

/// Kills the run, with its workers, after a random part of `whole`. Whether it was still running.
bool kill_at_random(const Words& words, std::chrono::duration<double> whole, std::mt19937& random) {
    Run run(words);
    std::this_thread::sleep_for(whole * std::uniform_real_distribution(0.2, 1.1)(random));
    kill(-run.pid(), SIGKILL);
    return run.wait().status == 128 + SIGKILL;
}

/// Ends a run that writes a.hff by Ctrl-C as soon as it has kept rows of so many bytes.
void interrupt(const Words& words, const Directory& directory, std::uintmax_t bytes = 1) {
    const std::filesystem::path rows = directory.path("a.hff.rows");
    std::filesystem::remove(rows); // of another run
    Run run(words);
    const auto kept = [&] {
        std::error_code none_yet;
        const std::uintmax_t size = std::filesystem::file_size(rows, none_yet);
        return none_yet ? 0 : size;
    };
    for (int k = 0; k < 2000 && kept() < bytes; ++k) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    kill(run.pid(), SIGINT);
    const Outcome outcome = run.wait();
    INFO(outcome.err);
    REQUIRE(outcome.status == 130);
    CHECK(outcome.err_has("a.hff.rows; the same command with --resume goes on from there"));
    REQUIRE(directory.has("a.hff.rows"));
}

} // namespace

TEST_CASE("Kill -9: no half file under the final name, and what is resumed equals an undisturbed run",
          "[cli][slow]") {
    const auto [command, kind] =
        GENERATE(std::pair<std::string, Words>{"factors", {}}, std::pair<std::string, Words>{"solve", {}},
                 std::pair<std::string, Words>{"solve", {"--clusters", "on"}});
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(12));
    const auto start = Clock::now();
    REQUIRE(run_hemi(with(command_for(command, scene, directory.path("whole.hff")), kind)).status == 0);
    const std::chrono::duration<double> seconds = Clock::now() - start;
    const std::string whole = directory.read("whole.hff");
    const Words plain = with(command_for(command, scene, directory.path("a.hff")), kind);
    const Words resumed = with(plain, {"--resume"});

    std::mt19937 random(7);
    int killed = 0;
    for (int round = 0; round < 8; ++round) {
        INFO(command << ", round " << round);
        killed += kill_at_random(round % 3 == 0 ? plain : resumed, seconds, random) ? 1 : 0;
        if (directory.has("a.hff")) {
            REQUIRE(directory.read("a.hff") == whole);
            std::filesystem::remove(directory.path("a.hff"));
        }
        if (round % 2 == 1) {
            const bool kept = directory.has("a.hff.rows");
            const Outcome run = run_hemi(resumed);
            INFO(run.err);
            REQUIRE(run.status == 0);
            REQUIRE((directory.read("a.hff") == whole));
            CHECK(directory.names() == Words{"a.hff", "cube.json", "whole.hff"});
            CHECK((reused(run) > 0) <= kept);
            std::filesystem::remove(directory.path("a.hff"));
        }
    }
    CHECK(killed > 0);
}

TEST_CASE("Resume: finished rows are not computed again, and others are", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(16));
    const Words plain = command_for("factors", scene, directory.path("a.hff"));
    REQUIRE(run_hemi(command_for("factors", scene, directory.path("whole.hff"))).status == 0);
    interrupt(plain, directory, std::uintmax_t{2} * 64 * 1280 * 9); // two blocks of rows, 9 bytes an entry
    const std::string journal = directory.read("a.hff.rows");
    directory.write("a.hff.rows", journal.substr(0, journal.size() - 100)); // the last block is torn

    SECTION("other settings are refused") {
        const Outcome run = run_hemi(with(plain, {"--resume", "--seed", "5"}));
        CHECK(run.status == 3);
        CHECK(run.err_has("a.hff.rows: this checkpoint holds rows of another run: seed 0, here 5"));
        CHECK(directory.has("a.hff.rows"));
    }
    SECTION("the same settings go on") {
        const Outcome run = run_hemi(with(plain, {"--resume"}));
        INFO(run.err);
        REQUIRE(run.status == 0);
        CHECK(reused(run) > 0);
        CHECK(reused(run) % 64 == 0);
        CHECK(reused(run) < 1536);
        CHECK((directory.read("a.hff") == directory.read("whole.hff")));
    }
    SECTION("without --resume all begins anew, and what was left goes") {
        const Outcome run = run_hemi(plain);
        CHECK(run.status == 0);
        CHECK(reused(run) == 0);
    }
    SECTION("a file that is something else is left alone") {
        directory.write("a.hff.rows", "mine");
        CHECK(run_hemi(with(plain, {"--resume"})).status == 1);
        CHECK(run_hemi(plain).status == 0);
        CHECK(directory.read("a.hff.rows") == "mine");
    }
}

TEST_CASE("Resume: rows of clusters go on as others do, and are not confused with them", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(12));
    const auto command = [&](const std::string& file, const Words& more) {
        return with({"solve", scene, "--device", "cpu", "--preset", "fast", "--eye-points", "9", "--jobs",
                     "1", "--no-estimate", "--factors", directory.path(file)},
                    more);
    };
    const Words on{"--clusters", "on"};
    const auto refusal = [&](const Words& more) {
        const Outcome run = run_hemi(command("a.hff", with(more, {"--resume"})));
        CHECK(run.status == 3);
        CHECK(directory.has("a.hff.rows"));
        return run.err;
    };
    using Catch::Matchers::Contains;
    REQUIRE(run_hemi(command("whole.hff", on)).status == 0);
    interrupt(command("a.hff", {}), directory); // rows of pairs, since these fit
    CHECK_THAT(refusal({"--max-memory", "8M"}), Contains("rows of visibility, here clusters"));
    interrupt(command("a.hff", on), directory);
    CHECK_THAT(refusal({}), Contains("rows of clusters, here visibility"));
    CHECK_THAT(refusal(with(on, {"--cluster-error", "1%"})), Contains("cluster error 0.001, here 0.01"));
    const Outcome run = run_hemi(command("a.hff", with(on, {"--resume", "--scratch", directory.path(".")})));
    INFO(run.err);
    REQUIRE(run.status == 0);
    CHECK(run.err_has(" of 864 rows taken from the checkpoint"));
    CHECK((directory.read("a.hff") == directory.read("whole.hff")));
    CHECK(directory.names() == Words{"a.hff", "cube.json", "whole.hff"});
}

TEST_CASE("Resume: a refinement that was killed goes on to what an undisturbed one comes to", "[cli][slow]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(4));
    const auto refine = [&](const std::string& file) {
        return Words{"solve",    scene,  "--device",  "cpu", "--jobs", "2",
                     "--refine", "1000", "--factors", file,  "-q",     "--resume"};
    };
    const auto start = Clock::now();
    REQUIRE(run_hemi(refine(directory.path("whole.hff"))).status == 0);
    const std::chrono::duration<double> seconds = Clock::now() - start;
    std::mt19937 random(11);
    int killed = 0;
    for (int round = 0; round < 6; ++round) {
        killed += kill_at_random(refine(directory.path("a.hff")), seconds, random) ? 1 : 0;
        if (round % 2 == 1) {
            const Outcome run = run_hemi(refine(directory.path("a.hff")));
            INFO(run.err);
            REQUIRE(run.status == 0);
            CHECK((directory.read("a.hff") == directory.read("whole.hff")));
            CHECK(directory.names() == Words{"a.hff", "cube.json", "whole.hff"});
            std::filesystem::remove(directory.path("a.hff"));
        }
    }
    CHECK(killed > 0);
}

TEST_CASE("Resume: asks for the file that it goes on with", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    CHECK(run_hemi({"factors", scene, "--resume"}).status == 2);
    CHECK(run_hemi({"factors", scene, "--resume", "-o", "-"}).status == 2);
    CHECK(run_hemi({"solve", scene, "--resume"}).status == 2);
    CHECK(run_hemi({"solve", scene, "--resume", "--factors", directory.path("a.hff"), "--error-target", "0.1",
                    "--error-target-of", "factors"})
              .status == 2);
}
