#include "structure/source_tree.hpp"
#include "support/command.hpp"

#include <catch2/catch.hpp>

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
