#include "support/command.hpp"

#include <catch2/catch.hpp>

using hemi::cli_test::Directory;
using hemi::test::CommandOutcome;
using hemi::test::run_command;

namespace {

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
