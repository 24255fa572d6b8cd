#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

// The window is part of the program, not of the library: it is tested from outside, on a display of its own.

namespace {

/// A folder that is there while a test runs, with a small scene in it.
class Workplace {
public:
    Workplace() {
        std::string pattern = (std::filesystem::temp_directory_path() / "hemi-viewer-XXXXXX").string();
        REQUIRE(mkdtemp(pattern.data()) != nullptr);
        path_ = pattern;
        write("room.json", R"({"hemi": 1, "channels": ["red", "green", "blue"],
  "materials": {"white": {"reflectance": 0.7}, "red": {"reflectance": [0.6, 0.1, 0.1]},
                "lamp": {"reflectance": 0, "exitance": [20, 18, 12]}},
  "surfaces": [
    {"name": "floor", "material": "white", "polygon": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "patches": [6, 6]},
    {"name": "ceiling", "material": "lamp", "polygon": [[0,0,1],[0,1,1],[1,1,1],[1,0,1]], "patches": [6, 6]},
    {"name": "left", "material": "red", "polygon": [[0,0,0],[0,1,0],[0,1,1],[0,0,1]], "patches": [6, 6]},
    {"name": "right", "material": "white", "polygon": [[1,0,0],[1,0,1],[1,1,1],[1,1,0]], "patches": [6, 6]},
    {"name": "back", "material": "white", "polygon": [[0,1,0],[1,1,0],[1,1,1],[0,1,1]], "patches": [6, 6]}],
  "camera": {"eye": [0.5,-2.4,0.5], "target": [0.5,0.5,0.5], "up": [0,0,1], "fov": 30}})");
    }
    ~Workplace() { std::filesystem::remove_all(path_); }
    Workplace(const Workplace&) = delete;
    Workplace& operator=(const Workplace&) = delete;

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(path_ / name) << text;
    }

    [[nodiscard]] std::string read(const std::string& name) const {
        std::ifstream file(path_ / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    [[nodiscard]] bool has(const std::string& name) const { return std::filesystem::exists(path_ / name); }

    /// Exit status of a shell command in this folder; its messages go to errors.txt.
    [[nodiscard]] int run(const std::string& command) const {
        const int status =
            std::system(fmt::format("cd '{}' && {} >out.txt 2>errors.txt", path_.string(), command).c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

    /// `hemi view` with a script on a virtual display.
    [[nodiscard]] int view(const std::string& script, const std::string& options = "--size 300x200") const {
        write("script.txt", script);
        return run(
            fmt::format("xvfb-run -a -s '-screen 0 1280x1024x24' '{}' view room.json --script script.txt "
                        "--device osmesa {}",
                        HEMI_PROGRAM, options));
    }

private:
    std::filesystem::path path_;
};

} // namespace

TEST_CASE("Viewer: a screenshot has the pixels of the headless picture", "[viewer][gl]") {
    const Workplace place;
    REQUIRE(place.run(fmt::format("'{}' solve room.json --device osmesa --size 300x200 -o picture.png",
                                  HEMI_PROGRAM)) == 0);
    const int status = place.view("screenshot first.png\nquit\n");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    REQUIRE(place.has("first.png"));
    CHECK(place.read("first.png") == place.read("picture.png"));
    CHECK(place.read("errors.txt").find("first.png") != std::string::npos);
}

TEST_CASE("Viewer: moves change the picture, and coming back brings it back", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("screenshot start.png\n"
                                  "drag left 150 100 220 60 150 100   # there and back\n"
                                  "screenshot back.png\n"
                                  "drag left 150 100 220 60\n"
                                  "screenshot turned.png\n"
                                  "key R\n"
                                  "screenshot reset.png\n"
                                  "drag middle 150 100 170 120\n"
                                  "screenshot panned.png\n"
                                  "key R\n"
                                  "drag shift+left 150 100 170 120\n"
                                  "screenshot shifted.png\n"
                                  "key R\n"
                                  "scroll 100 100 3\n"
                                  "screenshot zoomed.png\n"
                                  "key R\n"
                                  "drag right 100 100 100 60\n"
                                  "screenshot nearer.png\n");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const std::string start = place.read("start.png");
    REQUIRE_FALSE(start.empty());
    CHECK(place.read("back.png") == start);
    CHECK(place.read("turned.png") != start);
    CHECK(place.read("reset.png") == start);
    CHECK(place.read("panned.png") != start);
    CHECK(place.read("shifted.png") == place.read("panned.png"));
    CHECK(place.read("zoomed.png") != start);
    CHECK(place.read("nearer.png") != start);
}

TEST_CASE("Viewer: keys switch what is shown and back again", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("screenshot start.png\n"
                                  "key S\nscreenshot flat.png\nkey S\n"
                                  "key T\nscreenshot linear.png\nkey t\n"
                                  "key W\nscreenshot outlines.png\nkey W\n"
                                  "key E\nscreenshot brighter.png\nkey shift+E\n"
                                  "screenshot end.png\n"
                                  "key 1\nscreenshot front.png\nkey 3\nscreenshot right.png\n"
                                  "key 7\nscreenshot top.png\nkey F\nscreenshot framed.png\n"
                                  "key X\nkey P\n");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const std::string start = place.read("start.png");
    for (const char* name :
         {"flat.png", "linear.png", "outlines.png", "brighter.png", "front.png", "right.png", "top.png"}) {
        INFO(name);
        CHECK_FALSE(place.read(name).empty());
        CHECK(place.read(name) != start);
    }
    CHECK(place.read("end.png") == start);
    CHECK(place.read("framed.png") == place.read("top.png"));
    CHECK(place.has("room-001.png"));
    CHECK(place.read("room-001.png") == place.read("framed.png"));
}

TEST_CASE("Viewer: survives being resized, down to one pixel", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("screenshot start.png\n"
                                  "resize 1 1\nscreenshot tiny.png\n"
                                  "resize 640 77\nscreenshot wide.png\n"
                                  "resize 300 200\nscreenshot again.png\nscreenshot again.hdr\n");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.read("again.png") == place.read("start.png"));
    CHECK(place.has("again.hdr"));
    // Width and height in a PNG's header.
    const std::string wide = place.read("wide.png");
    REQUIRE(wide.size() > 24);
    CHECK(wide.substr(16, 8) == std::string("\0\0\x02\x80\0\0\0\x4D", 8));
}

TEST_CASE("Viewer: a script ends at quit or at its end", "[viewer][gl]") {
    const Workplace place;
    CHECK(place.view("key Q\nscreenshot never.png\n") == 0);
    CHECK(place.view("key Escape\nscreenshot never.png\n") == 0);
    CHECK(place.view("quit\nscreenshot never.png\n") == 0);
    CHECK(place.view("# nothing to do\n\n") == 0);
    CHECK_FALSE(place.has("never.png"));
}

TEST_CASE("Viewer: a broken script is refused with its file and line", "[viewer]") {
    const Workplace place;
    const auto complaint = [&](const std::string& script) {
        CHECK(place.view(script) == 3);
        return place.read("errors.txt");
    };
    CHECK(complaint("key S\nfly 3\n").find("script.txt:2: command \"fly\"") != std::string::npos);
    CHECK(complaint("drag left 1 2 3\n").find("script.txt:1: y is missing") != std::string::npos);
    CHECK(complaint("drag top 1 2 3 4\n").find("script.txt:1: button \"top\"") != std::string::npos);
    CHECK(complaint("\n\nscroll 1 2 x\n").find("script.txt:3: \"x\" as the amount") != std::string::npos);
    CHECK(complaint("scroll 1 2 nan\n").find("script.txt:1: \"nan\"") != std::string::npos);
    CHECK(complaint("key Return\n").find("script.txt:1: key \"Return\"") != std::string::npos);
    CHECK(complaint("key S now\n").find("script.txt:1: \"now\" is too much") != std::string::npos);
    CHECK(complaint("resize 0 10\n").find("script.txt:1: 0 as the width") != std::string::npos);
    CHECK(complaint("screenshot a.jpg\n").find("script.txt:1: screenshot \"a.jpg\"") != std::string::npos);
    CHECK(place.run(fmt::format("xvfb-run -a '{}' view room.json --script missing.txt", HEMI_PROGRAM)) == 3);
}

TEST_CASE("Viewer: a screenshot that cannot be written names the line", "[viewer][gl]") {
    const Workplace place;
    CHECK(place.view("screenshot no/such/folder/a.png\n") == 1);
    CHECK(place.read("errors.txt").find("script.txt:1: ") != std::string::npos);
}

TEST_CASE("Viewer: without a display the exit status is 4", "[viewer]") {
    const Workplace place;
    CHECK(place.run(fmt::format("env -u DISPLAY -u WAYLAND_DISPLAY '{}' view room.json", HEMI_PROGRAM)) == 4);
    CHECK(place.read("errors.txt").find("display") != std::string::npos);
    CHECK(place.run(fmt::format("env -u WAYLAND_DISPLAY DISPLAY=:9999 '{}' view room.json", HEMI_PROGRAM)) ==
          4);
    CHECK(place.read("errors.txt").find("hemi render") != std::string::npos);
}
