#include "structure/source_tree.hpp"
#include "support/command.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

#include <regex>

using namespace hemi::structure_test;
using hemi::test::run_command;

TEST_CASE("shaders: glslangValidator accepts every file", "[structure]") {
    const auto files = source_files({"shaders"});
    REQUIRE(files.size() >= 5);
    for (const SourceFile& file : files) {
        const auto outcome = run_command({"glslangValidator", std::string(HEMI_SOURCE_DIR "/") + file.path});
        INFO(file.path << "\n" << outcome.out << outcome.err);
        CHECK(outcome.status == 0);
        CHECK(file.text.starts_with("#version 450 core\n"));
    }
}

TEST_CASE("shaders: glslangValidator accepts the hemicube's fragments with every definition", "[structure]") {
    for (const std::vector<std::string>& definitions :
         {std::vector<std::string>{"CLIPPED"}, {"CLIPPED", "BILINEAR"}, {"COUNT_COVERED"}}) {
        std::vector<std::string> command{"glslangValidator", "-l"};
        for (const std::string& definition : definitions) {
            command.push_back("-D" + definition);
        }
        command.emplace_back(HEMI_SOURCE_DIR "/shaders/hemicube.frag");
        const auto outcome = run_command(command);
        INFO(definitions.back() << "\n" << outcome.out << outcome.err);
        CHECK(outcome.status == 0);
    }
}

TEST_CASE("shaders: glslangValidator refuses a slip in each file", "[structure]") {
    const hemi::cli_test::Directory directory;
    for (const SourceFile& file : source_files({"shaders"})) {
        std::string text = file.text;
        text.insert(text.rfind('}'), "    undeclared = 1.0;\n");
        const std::string path = directory.write(file.path.substr(file.path.rfind('/') + 1), text);
        const auto outcome = run_command({"glslangValidator", path});
        INFO(file.path);
        CHECK(outcome.status != 0);
        CHECK(outcome.out.find("undeclared") != std::string::npos);
    }
}

TEST_CASE("shaders: every input, output, uniform and block has its location or binding written out",
          "[structure]") {
    // A declaration that begins with its qualifiers; one with a location begins with layout.
    const std::regex unplaced(R"(^(flat |smooth |noperspective |centroid )*(in|out|uniform) )");
    const std::regex placed(
        R"(^layout\((location = \d+(, binding = \d+)?\) (flat )?(in|out|uniform) )"
        R"(|std140, binding = \d+\) uniform |std430, binding = \d+\) (readonly )?buffer ))");
    std::size_t found = 0;
    for (const SourceFile& file : source_files({"shaders"})) {
        for (const std::string& line : lines_of(file.text)) {
            INFO(file.path << ": " << line);
            CHECK_FALSE(std::regex_search(line, unplaced));
            if (line.starts_with("layout")) {
                CHECK(std::regex_search(line, placed));
                ++found;
            }
        }
    }
    CHECK(found > 30);
}
