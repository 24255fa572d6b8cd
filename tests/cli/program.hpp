#pragma once

#include "support/places.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <spawn.h>
#include <stdexcept>
#include <string>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

/// Runs the program as a user does, in a directory that goes away afterwards.
namespace hemi::cli_test {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

/// A new directory, removed with all in it at the end.
class Directory {
public:
    Directory();
    ~Directory();
    Directory(const Directory&) = delete;
    Directory& operator=(const Directory&) = delete;

    [[nodiscard]] std::string path(const std::string& name) const { return (path_ / name).string(); }
    /// Writes a file and returns its path.
    std::string write(const std::string& name, const std::string& text) const;
    std::string write(const std::string& name, const char* text) const {
        return write(name, std::string(text));
    }
    std::string write(const std::string& name, const Json& json) const { return write(name, json.dump()); }
    [[nodiscard]] std::string read(const std::string& name) const;
    [[nodiscard]] bool has(const std::string& name) const { return std::filesystem::exists(path_ / name); }
    /// Names of all files, sorted.
    [[nodiscard]] Words names() const;

private:
    std::filesystem::path path_;
};

struct Outcome {
    int status = -1; ///< exit status; 128 + signal if the program was killed
    std::string out;
    std::string err;

    [[nodiscard]] Json json() const { return Json::parse(out); }
    [[nodiscard]] bool out_has(const std::string& text) const { return out.find(text) != std::string::npos; }
    [[nodiscard]] bool err_has(const std::string& text) const { return err.find(text) != std::string::npos; }
};

/// A run of the program that has been started and not yet waited for. It gets a process group of its own.
class Run {
public:
    /// @param environment  "NAME=value", or "NAME" to remove it, over the test's own
    /// @param output  file that takes stdout; empty: one that wait() reads
    explicit Run(const Words& arguments, const Words& environment = {}, const std::string& output = "");
    ~Run();
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

    [[nodiscard]] pid_t pid() const { return pid_; }
    [[nodiscard]] Outcome wait();

private:
    Directory directory_;
    pid_t pid_ = -1;
};

[[nodiscard]] Outcome run_hemi(const Words& arguments, const Words& environment = {});

/// `words`, then the options by which rows come fast and the same everywhere: OSMesa, one worker,
/// resolution 64.
[[nodiscard]] Words quick(Words words);

/// The unit cube seen from inside: groups floor, ceiling, left, right, front, back of n x n patches, material
/// "white" (reflectance 0.5); the ceiling is of material "lamp" (reflectance 0, exitance 1).
[[nodiscard]] Json cube(int n, const std::string& enclosure = "closed");
/// The same with three channels that differ.
[[nodiscard]] Json coloured(int n);
/// A cube without its ceiling.
[[nodiscard]] Json open_cube(int n, const std::string& enclosure);

// Implementation.

inline Directory::Directory() {
    std::string name = (std::filesystem::temp_directory_path() / "hemi-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
        throw std::runtime_error("no temporary directory");
    }
    path_ = name;
}

inline Directory::~Directory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

inline std::string Directory::write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path(name);
}

inline std::string Directory::read(const std::string& name) const {
    std::ifstream file(path_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline Words Directory::names() const {
    Words names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
        names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

inline std::vector<char*> pointers(Words& words) {
    std::vector<char*> all;
    for (std::string& word : words) {
        all.push_back(word.data());
    }
    all.push_back(nullptr);
    return all;
}

inline Words changed_environment(const Words& changes) {
    Words all;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string text(*entry);
        const std::string name = text.substr(0, text.find('='));
        const bool replaced = std::any_of(changes.begin(), changes.end(), [&name](const std::string& change) {
            return change.substr(0, change.find('=')) == name;
        });
        if (!replaced) {
            all.push_back(text);
        }
    }
    std::copy_if(changes.begin(), changes.end(), std::back_inserter(all),
                 [](const std::string& change) { return change.find('=') != std::string::npos; });
    return all;
}

inline Run::Run(const Words& arguments, const Words& environment, const std::string& output) {
    Words words{HEMI_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    Words variables = changed_environment(environment);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO,
                                     output.empty() ? directory_.path("out").c_str() : output.c_str(),
                                     O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, directory_.path("err").c_str(),
                                     O_WRONLY | O_CREAT, 0600);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    const int problem = posix_spawn(&pid_, HEMI_PROGRAM, &actions, &attributes, pointers(words).data(),
                                    pointers(variables).data());
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (problem != 0) {
        throw std::runtime_error("the program cannot be started: " HEMI_PROGRAM);
    }
}

inline Run::~Run() {
    if (pid_ > 0) {
        kill(-pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
}

inline Outcome Run::wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), directory_.read("out"),
            directory_.read("err")};
}

inline Outcome run_hemi(const Words& arguments, const Words& environment) {
    return Run(arguments, environment).wait();
}

inline Words quick(Words words) {
    const bool chosen = std::any_of(words.begin(), words.end(), [](const std::string& word) {
        return word == "--preset" || word == "--method" || word == "--error-target";
    });
    if (!chosen) {
        words.insert(words.end(), {"--preset", "plain", "--resolution", "64"});
    }
    words.insert(words.end(), {"--device", "osmesa", "--jobs", "1"});
    return words;
}

inline Json face(const std::string& name, const std::string& material, const Json& polygon, int n) {
    return {{"name", name}, {"material", material}, {"polygon", polygon}, {"patches", {n, n}}};
}

inline Json cube(int n, const std::string& enclosure) {
    const auto polygon = [](const char* text) { return Json::parse(text); };
    return {
        {"hemi", 1},
        {"channels", {"grey"}},
        {"materials", {{"white", {{"reflectance", 0.5}}}, {"lamp", {{"reflectance", 0}, {"exitance", 1}}}}},
        {"surfaces",
         {face("floor", "white", polygon("[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]"), n),
          face("left", "white", polygon("[[0,0,0],[0,1,0],[0,1,1],[0,0,1]]"), n),
          face("right", "white", polygon("[[1,0,0],[1,0,1],[1,1,1],[1,1,0]]"), n),
          face("front", "white", polygon("[[0,0,0],[0,0,1],[1,0,1],[1,0,0]]"), n),
          face("back", "white", polygon("[[0,1,0],[1,1,0],[1,1,1],[0,1,1]]"), n),
          face("ceiling", "lamp", polygon("[[0,0,1],[0,1,1],[1,1,1],[1,0,1]]"), n)}},
        {"enclosure", enclosure}};
}

inline Json coloured(int n) {
    Json scene = cube(n);
    scene["channels"] = {"red", "green", "blue"};
    scene["materials"]["white"]["reflectance"] = {0.7, 0.5, 0.2};
    return scene;
}

inline Json open_cube(int n, const std::string& enclosure) {
    Json scene = cube(n, enclosure);
    scene["surfaces"].erase(5);
    scene["materials"].erase("lamp");
    scene["materials"]["white"]["exitance"] = 1;
    return scene;
}

} // namespace hemi::cli_test
