#pragma once

#include "support/places.hpp"
#include "support/virtual_display.hpp"

#include "hemi/io/factor_file.hpp"

#include <catch2/catch.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

// The window is part of the program, not of the library: it is tested from outside, on a display of its own.

namespace hemi::viewer_test {

/// Options for windows that are quick on software OpenGL: one without room for the side panel, and one with
/// it beside a picture of about that size.
inline const std::string small = "--size 300x200 --preset plain --resolution 32";
inline const std::string with_panel = "--size 708x400 --preset plain --resolution 32";

/// Puts `to` where `from` stands first, which must stand there.
inline void replace(std::string& text, const std::string& from, const std::string& to) {
    REQUIRE(text.find(from) != std::string::npos);
    text.replace(text.find(from), from.size(), to);
}

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

    [[nodiscard]] std::filesystem::path path(const std::string& name) const { return path_ / name; }
    [[nodiscard]] nlohmann::json json(const std::string& name) const {
        return nlohmann::json::parse(read(name));
    }

    /// Exit status of a shell command in this folder; its messages go to errors.txt.
    [[nodiscard]] int run(const std::string& command) const {
        const int status =
            std::system(fmt::format("cd '{}' && {} >out.txt 2>errors.txt", path_.string(), command).c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

    /// `hemi view` with a script on a virtual display.
    [[nodiscard]] int view(const std::string& script, const std::string& options = "--size 300x200") const {
        write("script.txt", script);
        return run(view_command("room.json", "--device osmesa " + options));
    }

    /// The command line for that.
    [[nodiscard]] static std::string view_command(const std::string& file, const std::string& options) {
        return fmt::format("{} '{}' view {} --script script.txt {}", test::virtual_display("Xauthority"),
                           HEMI_PROGRAM, file, options);
    }

    /// Form factors of room.json, as the program computes them with these options.
    [[nodiscard]] FormFactorMatrix factors(const std::string& options) const {
        REQUIRE(run(fmt::format("'{}' factors room.json --device osmesa {} -o room.hff", HEMI_PROGRAM,
                                options)) == 0);
        return io::read_hff(path("room.hff")).matrix;
    }

private:
    std::filesystem::path path_;
};

} // namespace hemi::viewer_test
