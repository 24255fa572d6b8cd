#include "structure/source_tree.hpp"
#include "support/command.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <regex>
#include <set>

using hemi::cli_test::Directory;
using hemi::test::CommandOutcome;
using hemi::test::run_command;
using namespace hemi::structure_test;

namespace {

/// README and the pages that it links to.
std::vector<SourceFile> guides() {
    std::vector<SourceFile> files = source_files({"tools/doxygen/pages"});
    files.push_back({"README.md", read_text(HEMI_SOURCE_DIR "/README.md")});
    return files;
}

/// Lines outside of code.
std::vector<std::string> prose_of(const std::string& text) {
    std::vector<std::string> prose;
    bool code = false;
    for (const std::string& line : lines_of(text)) {
        if (line.starts_with("```")) {
            code = !code;
        } else if (!code) {
            prose.push_back(line);
        }
    }
    return prose;
}

/// Anchors of the headings, made as hosts of repositories make them.
std::set<std::string> anchors_of(const std::string& text) {
    std::set<std::string> anchors;
    for (const std::string& line : prose_of(text)) {
        if (!line.starts_with("#")) {
            continue;
        }
        std::string anchor;
        for (const char c : line.substr(line.find(' ') + 1)) {
            if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_') {
                anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
            } else if (c == ' ') {
                anchor += '-';
            }
        }
        anchors.insert(anchor);
    }
    return anchors;
}

/// Targets of the links and pictures in Markdown.
std::vector<std::string> links_of(const std::string& text) {
    const std::regex link(R"(\]\(([^)]+)\))");
    std::vector<std::string> links;
    for (const std::string& line : prose_of(text)) {
        for (std::sregex_iterator match(line.begin(), line.end(), link), end; match != end; ++match) {
            links.push_back((*match)[1]);
        }
    }
    return links;
}

/// Runs Doxygen in the project's root as tools/docs does, with more settings at the end.
CommandOutcome make_pages(const Directory& directory, const std::string& settings = "") {
    return run_command({"sh", "-c",
                        "cd '" HEMI_SOURCE_DIR "' && { cat tools/doxygen/Doxyfile; echo '" + settings +
                            "'; } | DOCS_DIR='" + directory.path("docs") + "' DOCS_VERSION=1 doxygen -"});
}

} // namespace

TEST_CASE("documentation: every public name has a comment that Doxygen understands", "[structure]") {
    const Directory directory;
    const CommandOutcome outcome = make_pages(directory);
    INFO(outcome.out << outcome.err);
    CHECK(outcome.status == 0);
    CHECK(outcome.err.empty());
    // The example of the main page is there, and so is a header of a module.
    CHECK(directory.read("docs/html/index.html").find("solve_radiosity") != std::string::npos);
    CHECK(directory.read("docs/html/group__matrix.html").find("FormFactorMatrix") != std::string::npos);
}

TEST_CASE("documentation: a public name without a comment is refused", "[structure]") {
    const Directory directory;
    const std::string header = directory.write("slip.hpp", "namespace hemi {\n"
                                                           "/// A thing.\n"
                                                           "struct Thing {\n"
                                                           "    int forgotten = 0;\n"
                                                           "};\n"
                                                           "/// Takes two.\n"
                                                           "/// @param first  the one\n"
                                                           "void take(int first, int second);\n"
                                                           "} // namespace hemi\n");
    const CommandOutcome outcome = make_pages(directory, "INPUT += " + header);
    INFO(outcome.out << outcome.err);
    CHECK(outcome.status != 0);
    CHECK(outcome.err.find("forgotten") != std::string::npos);
    CHECK(outcome.err.find("second") != std::string::npos);
}

TEST_CASE("documentation: pages are built, link to each other and have a list of their sections",
          "[structure]") {
    const Directory directory;
    REQUIRE(make_pages(directory).status == 0);
    std::size_t pages = 0;
    for (const SourceFile& file : source_files({"tools/doxygen/pages"})) {
        INFO(file.path);
        const std::string name = std::filesystem::path(file.path).stem();
        const std::string html = directory.read("docs/html/page-" + name + ".html");
        const auto links = links_of(file.text);
        for (const std::string& anchor : anchors_of(file.text)) {
            if (anchor == *anchors_of(lines_of(file.text).front()).begin()) {
                continue; // the title
            }
            INFO(anchor);
            CHECK(html.find("id=\"" + name + "-" + anchor + "\"") != std::string::npos);
            CHECK(std::find(links.begin(), links.end(), "#" + anchor) != links.end());
        }
        ++pages;
    }
    CHECK(pages >= 10);
}

TEST_CASE("documentation: links of README and pages lead to files and headings that are there",
          "[structure]") {
    std::size_t links = 0;
    for (const SourceFile& file : guides()) {
        const std::filesystem::path folder =
            (std::filesystem::path(HEMI_SOURCE_DIR) / file.path).parent_path();
        for (const std::string& link : links_of(file.text)) {
            INFO(file.path << ": " << link);
            const std::size_t hash = std::min(link.find('#'), link.size());
            const std::string path = link.substr(0, hash);
            REQUIRE((path.empty() || std::filesystem::exists(folder / path)));
            if (hash < link.size()) {
                const std::string text = path.empty() ? file.text : read_text(folder / path);
                CHECK(anchors_of(text).contains(link.substr(hash + 1)));
            }
            ++links;
        }
    }
    CHECK(links > 50);
}

TEST_CASE("documentation: README is short, names the first commands and every page", "[structure]") {
    const std::string readme = read_text(HEMI_SOURCE_DIR "/README.md");
    const auto lines = lines_of(readme);
    CHECK(lines.size() <= 300);
    for (const std::string& line : lines) {
        INFO(line);
        CHECK(line.size() <= 110);
    }
    for (const char* command : {"tools/run", "tools/test", "tools/docs", "tools/figures"}) {
        INFO(command);
        CHECK(readme.find(command) != std::string::npos);
    }
    for (const SourceFile& file : source_files({"tools/doxygen/pages"})) {
        INFO(file.path);
        CHECK(readme.find("](" + file.path + ")") != std::string::npos);
    }
}

TEST_CASE("documentation: every option of every command is on the pages", "[structure]") {
    std::string pages;
    for (const SourceFile& file : source_files({"tools/doxygen/pages"})) {
        pages += file.text;
    }
    const std::regex option(R"(\n  (?:-\w, +)?(--[a-z-]+))");
    std::set<std::string> options;
    for (const char* command : {"solve", "factors", "check", "trade", "heat", "exchange", "points", "render",
                                "view", "bake", "merge", "convert", "info", "devices"}) {
        const CommandOutcome help = run_command({HEMI_PROGRAM, command, "--help"});
        REQUIRE(help.status == 0);
        for (std::sregex_iterator match(help.out.begin(), help.out.end(), option), end; match != end;
             ++match) {
            options.insert((*match)[1]);
        }
    }
    CHECK(options.size() > 40);
    for (const std::string& name : options) {
        INFO(name);
        CHECK(std::regex_search(pages, std::regex(name + "[^a-z-]")));
    }
}
