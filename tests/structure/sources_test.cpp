#include "structure/source_tree.hpp"
#include "support/command.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

#include <filesystem>
#include <map>
#include <set>

using namespace hemi::structure_test;
using hemi::test::run_command;

namespace {

/// Headers that some source includes before anything else: their compilation shows that they need no help.
std::set<std::string> included_first() {
    std::set<std::string> first;
    for (const SourceFile& file : source_files({"src", "tests"})) {
        if (file.path.ends_with(".cpp")) {
            const auto includes = includes_of(file.text);
            if (!includes.empty() && includes.front().quoted) {
                first.insert(includes.front().name);
            }
        }
    }
    return first;
}

} // namespace

TEST_CASE("sources: every public header compiles on its own", "[structure]") {
    const auto first = included_first();
    std::size_t proven = 0;
    for (const SourceFile& file : source_files({"include"})) {
        const std::string name = file.path.substr(std::string("include/").size());
        if (first.contains(name)) {
            ++proven;
            continue;
        }
        const std::string headers = HEMI_SOURCE_DIR "/include";
        const auto outcome = run_command({"g++", "-std=c++20", "-fsyntax-only", "-w", "-I", headers, "-x",
                                          "c++", std::string(HEMI_SOURCE_DIR "/") + file.path});
        INFO(file.path << "\n" << outcome.err);
        CHECK(outcome.status == 0);
    }
    CHECK(proven > 5);
}

TEST_CASE("sources: every header is guarded against a second inclusion", "[structure]") {
    for (const SourceFile& file : source_files({"include", "src", "tests"})) {
        if (file.path.ends_with(".hpp")) {
            INFO(file.path);
            CHECK(file.text.starts_with("#pragma once\n"));
        }
    }
}

TEST_CASE("sources: no file is longer than 700 lines", "[structure]") {
    for (const SourceFile& file : source_files({"include", "src", "shaders", "tools"})) {
        INFO(file.path);
        CHECK(lines_of(file.text).size() <= 700);
    }
}

TEST_CASE("sources: nothing is left to be done later", "[structure]") {
    // Written in two parts, so that this file is not its own violation.
    const std::vector<std::string> marks{std::string("TO") + "DO", std::string("FIX") + "ME",
                                         std::string("XX") + "X:"};
    for (const SourceFile& file : source_files({"include", "src", "shaders", "tools", "scenes", "tests"})) {
        if (file.path.starts_with("tests/data/")) {
            continue;
        }
        for (const std::string& mark : marks) {
            INFO(file.path << " has " << mark);
            CHECK(file.text.find(mark) == std::string::npos);
        }
    }
}

TEST_CASE("sources: text ends with one newline and has no tabs or trailing blanks", "[structure]") {
    for (const SourceFile& file : source_files({"include", "src", "shaders"})) {
        INFO(file.path);
        REQUIRE_FALSE(file.text.empty());
        CHECK(file.text.back() == '\n');
        CHECK_FALSE(file.text.ends_with("\n\n"));
        CHECK(file.text.find('\t') == std::string::npos);
        CHECK(file.text.find(" \n") == std::string::npos);
        CHECK(file.text.find('\r') == std::string::npos);
    }
}

TEST_CASE("sources: the library neither prints nor exits", "[structure]") {
    for (const SourceFile& file : source_files({"include", "src"})) {
        if (file.path.starts_with("src/cli/") || file.path.starts_with("src/viewer/") ||
            file.path.starts_with("src/worker/")) { // programs
            continue;
        }
        for (const std::string& line : lines_of(file.text)) {
            const std::string code = line.substr(0, line.find("//"));
            for (const char* word :
                 {"std::cout", "std::cerr", "std::exit", "std::abort", "std::printf", "stderr"}) {
                INFO(file.path << ": " << line);
                CHECK(code.find(word) == std::string::npos);
            }
        }
    }
}

TEST_CASE("sources: every script in tools tells its usage, and refuses words that it does not know",
          "[structure]") {
    std::size_t scripts = 0;
    for (const auto& entry : std::filesystem::directory_iterator(HEMI_SOURCE_DIR "/tools")) {
        if (!entry.is_regular_file() || !read_text(entry).starts_with("#!")) {
            continue;
        }
        ++scripts;
        const std::string name = entry.path().filename().string();
        INFO(name);
        const auto help = run_command({"timeout", "20", entry.path().string(), "--help"});
        CHECK(help.status == 0);
        CHECK(help.err.empty());
        CHECK(help.out.starts_with("usage: "));
        CHECK(help.out.find(name) != std::string::npos);
        if (name == "run" || name == "parts") { // hemi judges their words
            continue;
        }
        const auto refusal = run_command({"timeout", "20", entry.path().string(), "--no-such-word"});
        CHECK(refusal.status == 2);
        CHECK(refusal.out.empty());
        CHECK(refusal.err.find(name + ":") != std::string::npos);
    }
    CHECK(scripts >= 15);
}

TEST_CASE("sources: every control of the window has a tip", "[structure]") {
    // The pieces of src/viewer/widgets.hpp take one each; what is made without them has none.
    const std::vector<std::string> bare{
        "Button(",      "SmallButton(", "Checkbox(",        "RadioButton(",     "SliderFloat", "SliderInt",
        "SliderScalar", "DragFloat",    "DragInt",          "DragScalar",       "BeginCombo(", "Selectable(",
        "SetTooltip(",  "TableHeader(", "TableHeadersRow(", "CollapsingHeader("};
    std::size_t files = 0;
    for (const SourceFile& file : source_files({"src"})) {
        if (!file.path.starts_with("src/viewer/") || file.path.starts_with("src/viewer/widgets.")) {
            continue;
        }
        ++files;
        for (const std::string& control : bare) {
            INFO(file.path << " has ImGui::" << control);
            CHECK(file.text.find("ImGui::" + control) == std::string::npos);
        }
    }
    CHECK(files > 20);
}
