#include "cli/program.hpp"
#include "support/places.hpp"
#include "support/virtual_display.hpp"

#include <catch2/catch.hpp>

using namespace hemi::cli_test;

namespace {

/// Runs the command line under a display of its own.
int run_with_display(const Words& arguments) {
    const Directory directory;
    std::string command =
        hemi::test::virtual_display(directory.path("Xauthority"), "640x480x24") + " '" HEMI_PROGRAM "'";
    for (const std::string& argument : arguments) {
        command += " '" + argument + "'";
    }
    command += " >/dev/null 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

} // namespace

TEST_CASE("view: shows a scene, and a stored solution as render draws it", "[cli][viewer]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(3));
    const std::string result = directory.path("a.hres");
    REQUIRE(run_hemi(quick({"solve", scene, "--result", result})).status == 0);
    const Words look{"--size", "64x48", "--camera", "0.5,0.1,0.5:0.5,1,0.5:70", "--flat"};
    const auto with = [&look](Words words) {
        words.insert(words.end(), look.begin(), look.end());
        return words;
    };
    const auto script = [&directory](const std::string& picture) {
        return directory.write("script", "screenshot " + directory.path(picture) + "\nquit\n");
    };
    CHECK(run_with_display(with(quick({"view", scene, "--script", script("scene.png")}))) == 0);
    CHECK(run_with_display(with({"view", result, "--script", script("result.png")})) == 0);
    CHECK(directory.read("scene.png").substr(1, 3) == "PNG");
    CHECK(directory.read("scene.png") == directory.read("result.png"));
    CHECK(run_with_display({"view", result, "--script", directory.path("missing")}) == 3);
    CHECK(run_hemi({"view", result, "--jobs", "2"}, {"DISPLAY=:none"}).status == 2);
    CHECK(run_hemi({"view", scene, "--budget", "5m"}, {"DISPLAY=:none"}).err_has("--budget needs"));
    CHECK(run_hemi({"view", scene, "--error-target", "1%", "--error-target-of", "factors"}, {"DISPLAY=:none"})
              .status == 2);
}
