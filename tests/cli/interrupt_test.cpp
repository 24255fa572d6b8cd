#include "cli/program.hpp"

#include <catch2/catch.hpp>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>

using namespace hemi::cli_test;
using namespace std::chrono_literals;

namespace {

/// Processes whose environment holds `text`: the program started with it, and its workers.
std::vector<pid_t> processes_with(const std::string& text) {
    std::vector<pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        const std::string name = entry.path().filename().string();
        if (name.find_first_not_of("0123456789") != std::string::npos) {
            continue;
        }
        std::ifstream file(entry.path() / "environ", std::ios::binary);
        const std::string environment{std::istreambuf_iterator<char>(file), {}};
        if (environment.find(text) != std::string::npos) {
            found.push_back(static_cast<pid_t>(std::stol(name)));
        }
    }
    return found;
}

template <class Condition>
bool becomes_true(Condition condition) {
    for (int k = 0; k < 600; ++k) {
        if (condition()) {
            return true;
        }
        std::this_thread::sleep_for(50ms);
    }
    return false;
}

} // namespace

TEST_CASE("Ctrl-C: ends with 130 and leaves no worker, and no file but rows to go on from", "[cli]") {
    const bool whole_group = GENERATE(false, true); // a terminal signals the workers, too
    const int signal = whole_group ? SIGINT : SIGTERM;
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(60));
    const std::string mark = "HEMI_TEST_RUN=" + directory.path("");
    Run run({"factors", scene, "-o", directory.path("a.hff"), "--device", "osmesa", "--jobs", "2",
             "--resolution", "512"},
            {mark});
    REQUIRE(becomes_true([&mark] { return processes_with(mark).size() == 3; }));
    std::this_thread::sleep_for(500ms);
    REQUIRE(kill(whole_group ? -run.pid() : run.pid(), signal) == 0);
    const Outcome outcome = run.wait();
    CHECK(outcome.status == 130);
    CHECK(outcome.err_has("interrupted"));
    CHECK(outcome.out.empty());
    const bool kept = directory.has("a.hff.rows");
    CHECK(directory.names() == (kept ? Words{"a.hff.rows", "cube.json"} : Words{"cube.json"}));
    CHECK(outcome.err_has("--resume") == kept);
    CHECK(becomes_true([&mark] { return processes_with(mark).empty(); }));
}
