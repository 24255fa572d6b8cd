#include "cli/program.hpp"
#include "support/command.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

#include <regex>
#include <sstream>

using namespace hemi::cli_test;
using hemi::test::run_command;

// What is installed beside the program: manual pages, and completion for bash.

namespace {

Words lines_of(const std::string& text) {
    Words lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line);
    }
    return lines;
}

/// First groups of all matches, sorted, each once.
Words matches(const std::string& text, const char* pattern) {
    const std::regex expression(pattern);
    Words found;
    for (std::sregex_iterator match(text.begin(), text.end(), expression), end; match != end; ++match) {
        found.push_back((*match)[1]);
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

Words commands() {
    const std::string help = run_hemi({"--help"}).out;
    const std::size_t begin = help.find("\nCommands:\n");
    REQUIRE(begin != std::string::npos);
    return matches(help.substr(begin, help.find("\n\n", begin) - begin), "\n  ([a-z]+)");
}

/// Long options that the help of a command lists.
Words options(const std::string& command) {
    return matches(run_hemi({command, "--help"}).out, "\n  (?:-[a-z], )?(--[a-z-]+)");
}

Words sorted(Words words) {
    std::sort(words.begin(), words.end());
    return words;
}

/// What bash offers in `directory` with the cursor at the end of the last word.
Words complete(const Directory& directory, const Words& words) {
    std::string line =
        "cd '" + directory.path(".") + "' && source '" HEMI_PAGES "/hemi.bash' && COMP_WORDS=(";
    for (const std::string& word : words) {
        line += "'" + word + "' ";
    }
    line += ") COMP_CWORD=" + std::to_string(words.size() - 1) +
            " && _hemi && ((${#COMPREPLY[@]} == 0)) || printf '%s\\n' \"${COMPREPLY[@]}\"";
    const auto outcome = run_command({"bash", "--norc", "-c", line});
    INFO(line << "\n" << outcome.err);
    CHECK(outcome.err.empty());
    return sorted(lines_of(outcome.out));
}

} // namespace

TEST_CASE("Manual: every command has a page with all of its options, and groff likes it", "[cli]") {
    Words names{"hemi"};
    for (const std::string& command : commands()) {
        names.push_back("hemi-" + command);
    }
    CHECK(names.size() >= 11);
    std::size_t pages = 0;
    for (const auto& entry : std::filesystem::directory_iterator(HEMI_PAGES "/man1")) {
        CHECK(std::find(names.begin(), names.end(), entry.path().stem()) != names.end());
        ++pages;
    }
    CHECK(pages == names.size());
    for (const std::string& name : names) {
        const auto page =
            run_command({"groff", "-man", "-Tascii", "-P-cbou", "-ww", HEMI_PAGES "/man1/" + name + ".1"});
        INFO(name << "\n" << page.err);
        CHECK(page.status == 0);
        CHECK(page.err.empty());
        for (const char* section : {"NAME", "SYNOPSIS", "OPTIONS", "EXIT STATUS", "EXAMPLES", "SEE ALSO"}) {
            CHECK(page.out.find("\n" + std::string(section) + "\n") != std::string::npos);
        }
        if (name != "hemi") {
            for (const std::string& option : options(name.substr(5))) {
                INFO(option);
                CHECK(page.out.find(option) != std::string::npos);
            }
        }
    }
}

TEST_CASE("Completion: commands, and the options of each, are what its help lists", "[cli]") {
    const Directory directory;
    Words first = commands();
    first.insert(first.end(), {"help", "--help", "--version"});
    CHECK(complete(directory, {"hemi", ""}) == sorted(first));
    CHECK(complete(directory, {"hemi", "co"}) == Words{"convert"});
    CHECK(complete(directory, {"hemi", "help", "de"}) == Words{"devices"});
    for (const std::string& command : commands()) {
        INFO(command);
        CHECK(complete(directory, {"hemi", command, "-"}) == options(command));
    }
    CHECK(complete(directory, {"hemi", "solve", "a.json", "--res"}) ==
          Words{"--resolution", "--result", "--resume"});
    CHECK(complete(directory, {"hemi", "slove", ""}).empty());
}

TEST_CASE("Completion: values of an option are offered, and all are accepted", "[cli]") {
    const Directory directory;
    const std::string scene = directory.path("missing.json");
    for (const auto& [option, count] :
         {std::pair("--device", 4u), std::pair("--preset", 4u), std::pair("--method", 5u),
          std::pair("--solver", 4u), std::pair("--repair", 3u), std::pair("--enclosure", 3u),
          std::pair("--color", 3u), std::pair("--tone-mapping", 2u)}) {
        const Words values = complete(directory, {"hemi", "solve", scene, option, ""});
        INFO(option);
        CHECK(values.size() == count);
        // As bash splits --option=value.
        CHECK(complete(directory, {"hemi", "solve", scene, option, "="}) == values);
        CHECK(complete(directory, {"hemi", "solve", scene, option, "=", values.front().substr(0, 2)}) ==
              complete(directory, {"hemi", "solve", scene, option, values.front().substr(0, 2)}));
        for (const std::string& value : values) {
            INFO(value);
            CHECK(run_hemi({"solve", scene, "-o", directory.path("a.png"), option, value}).status == 3);
        }
    }
    CHECK(complete(directory, {"hemi", "solve", scene, "--solver", "g"}) == Words{"gauss-seidel"});
    CHECK(complete(directory, {"hemi", "solve", scene, "--resolution", ""}).empty());
}

TEST_CASE("Completion: files are offered by the extensions that do, and folders", "[cli]") {
    const Directory directory;
    for (const char* name : {"room.json", "room.txt", "ROOM.OBJ", "my room.glb", "room.hff", "room.hres",
                             "room.csv", "room.png", "room.npz"}) {
        (void)directory.write(name, "");
    }
    std::filesystem::create_directory(directory.path("rooms"));
    (void)directory.write("rooms/a.stl", "");
    CHECK(complete(directory, {"hemi", "solve", ""}) ==
          Words{"ROOM.OBJ", "my room.glb", "room.json", "rooms"});
    CHECK(complete(directory, {"hemi", "solve", "rooms/"}) == Words{"rooms/a.stl"});
    CHECK(complete(directory, {"hemi", "solve", "--color", "never", "room"}) == Words{"room.json", "rooms"});
    CHECK(complete(directory, {"hemi", "solve", "room.json", "--factors", ""}) == Words{"room.hff", "rooms"});
    CHECK(complete(directory, {"hemi", "solve", "room.json", "-o", "room."}) == Words{"room.png"});
    CHECK(complete(directory, {"hemi", "render", ""}) == Words{"room.hres", "rooms"});
    CHECK(complete(directory, {"hemi", "convert", "room."}) ==
          Words{"room.csv", "room.hff", "room.hres", "room.npz", "room.txt"});
    CHECK(complete(directory, {"hemi", "convert", "room.hres", "room."}) ==
          Words{"room.csv", "room.hff", "room.npz", "room.txt"});
    CHECK(complete(directory, {"hemi", "view", "room.json", "--script", "room.t"}) == Words{"room.txt"});
    // Nothing is missing: options are next.
    CHECK(complete(directory, {"hemi", "convert", "a.hff", "b.mtx", ""}) == options("convert"));
}

TEST_CASE("Completion: the script is for bash, and what is installed is what the program prints", "[cli]") {
    const Outcome script = run_hemi({"completion", "bash"});
    CHECK(script.status == 0);
    CHECK(run_command({"cat", HEMI_PAGES "/hemi.bash"}).out == script.out);
    for (const Words& words : {Words{"completion"}, Words{"completion", "fish"}}) {
        const Outcome refused = run_hemi(words);
        CHECK(refused.status == 2);
        CHECK(refused.err_has("`hemi completion bash`"));
    }
}
