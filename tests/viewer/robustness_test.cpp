#include "support/places.hpp"
#include "viewer/workplace.hpp"

#include <chrono>
#include <filesystem>
#include <random>
#include <regex>
#include <string_view>
#include <thread>

using namespace hemi::viewer_test;

namespace {

/// How many of the program's processes work in a folder.
std::size_t processes_in(const std::filesystem::path& folder) {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        std::error_code error;
        const bool here = std::filesystem::read_symlink(entry.path() / "cwd", error) == folder;
        count += here && std::filesystem::read_symlink(entry.path() / "exe", error) == HEMI_PROGRAM ? 1 : 0;
    }
    return count;
}

std::string random_script(std::uint32_t seed, int events) {
    std::mt19937 random(seed);
    const auto below = [&random](std::uint32_t end) { return random() % end; };
    constexpr std::string_view keys = "FR1375STEWBLVHCGINOAKDUJ";
    std::string script;
    for (int k = 0; k < events; ++k) {
        const std::string point = fmt::format("{} {}", below(728), below(420));
        switch (below(10)) {
        case 0:
        case 1:
        case 2:
            script += "click " + point + "\n";
            break;
        case 3:
            script += fmt::format("drag {}{} {} {} {}\n", below(4) == 0 ? "shift+" : "",
                                  below(3) == 0 ? "middle" : (below(2) == 0 ? "left" : "right"), point,
                                  below(700), below(400));
            break;
        case 4:
            script += fmt::format("scroll {} {}\n", point, static_cast<int>(below(7)) - 3);
            break;
        case 5:
            script += "move " + point + "\n";
            break;
        case 6:
            script += below(12) == 0 ? fmt::format("resize {} {}\n", 1 + below(800), 1 + below(500))
                                     : fmt::format("fov {}\n", below(200));
            break;
        case 7:
            script += below(2) == 0 ? "key Tab\n" : "key F1\n";
            break;
        default:
            script += fmt::format("key {}{}\n", below(3) == 0 ? "shift+" : "", keys[below(keys.size())]);
        }
    }
    return script;
}

} // namespace

TEST_CASE("Viewer: a thousand random events leave no OpenGL error behind", "[viewer][gl]") {
    const Workplace place;
    // The window stops at the first error that OpenGL reports.
    const int status = place.view(random_script(7, 1000) + "windowshot end.png\n", with_panel);
    INFO(place.read("errors.txt"));
    CHECK(status == 0);
    CHECK(place.has("end.png"));
}

TEST_CASE("Viewer: survives being minimised", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("screenshot before.png\nminimise\nkey S\nkey S\nclick 150 100\n"
                                  "restore\nkey Escape\nscreenshot after.png\n");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.read("before.png") == place.read("after.png"));
}

TEST_CASE("Viewer: closing the window while it solves ends the workers", "[viewer][gl]") {
    const Workplace place;
    const std::string slow = "--size 708x400 --patches-per-face 400 --preset exact --jobs 2";
    REQUIRE(place.view("live\nwindowshot open.png\nquit\n", slow) == 0);
    CHECK(place.read("errors.txt").find("error") == std::string::npos);
    // A worker ends when it notices that nobody listens.
    const std::filesystem::path folder = std::filesystem::canonical(place.path("."));
    std::size_t left = processes_in(folder);
    for (int k = 0; k < 100 && left > 0; ++k) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        left = processes_in(folder);
    }
    CHECK(left == 0);
}

TEST_CASE("Viewer: the page on the window lists mouse and keys as F1 does", "[viewer]") {
    std::ifstream keys(HEMI_SOURCE_DIR "/src/viewer/keys.cpp");
    const std::string source{std::istreambuf_iterator<char>(keys), {}};
    std::ifstream guide(HEMI_SOURCE_DIR "/tools/doxygen/pages/window.md");
    const std::string page{std::istreambuf_iterator<char>(guide), {}};
    const std::regex line(R"re(\{"([^"]+)", "([^"]+)"\})re");
    std::size_t lines = 0;
    for (std::sregex_iterator match(source.begin(), source.end(), line), end; match != end; ++match) {
        ++lines;
        INFO((*match)[1] << ": " << (*match)[2]);
        CHECK(page.find("| " + (*match)[1].str() + " | " + (*match)[2].str() + " |") != std::string::npos);
    }
    CHECK(lines > 20);
}
