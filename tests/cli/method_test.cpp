#include "cli/program.hpp"
#include "support/accuracy_row.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace hemi::cli_test;

TEST_CASE("factors: every method finds the factors of the cube", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(3));
    for (const auto& [method, limit] :
         {std::pair("direct", 1e-6), std::pair("contour", 1e-6), std::pair("montecarlo", 3e-3)}) {
        const Json found = run_hemi({"factors", scene, "--method", method, "--by-group", "--json"}).json();
        INFO(method);
        const auto factor = [&found](const std::string& from, const std::string& to) {
            const auto index = [&found](const std::string& name) {
                return static_cast<std::size_t>(
                    std::find(found["groups"].begin(), found["groups"].end(), name) -
                    found["groups"].begin());
            };
            return found["factors"][index(from)][index(to)].get<double>();
        };
        CHECK(factor("floor", "ceiling") == Approx(0.19982489569838739).margin(limit));
        CHECK(factor("floor", "left") == Approx(0.20004377607540316).margin(limit));
    }
    const Outcome direct = run_hemi({"factors", scene, "--method", "direct"});
    CHECK(direct.err_has("unoccluded"));
}

TEST_CASE("factors: options that say nothing to a method are refused", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    const Outcome preset = run_hemi({"factors", scene, "--method", "direct", "--preset", "fast"});
    CHECK(preset.status == 2);
    CHECK(preset.err_has("--preset does not apply to --method direct; it belongs to hemicube"));
    CHECK(run_hemi({"factors", scene, "--rays", "16"}).status == 2);
    CHECK(run_hemi({"factors", scene, "--method", "montecarlo", "--rays", "16", "-q"}).status == 0);
    const Outcome many = run_hemi({"factors", scene, "--method", "contour", "--patches-per-face", "1000"});
    CHECK(many.status == 2);
    CHECK(many.err_has("at most 4000"));
}

TEST_CASE("factors: from a point, the factors are Lambert's", "[cli][accuracy]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    const Outcome run = run_hemi({"factors", scene, "--from-point", "0.5,0.5,0,0,0,2", "--json"});
    REQUIRE(run.status == 0);
    const Json found = run.json();
    const hemi::test::AccuracyRow row("other limits", "factors from a point against Lambert's closed form");
    row.check_below("limit", "", std::abs(found["sum"].get<double>() - 1.0), 1e-12);
    // The ceiling at distance 1, a quarter of it: Howell's B-3 (element to rectangle from a corner).
    double ceiling = 0.0;
    for (const Json& entry : found["entries"]) {
        ceiling += entry["group"] == "ceiling" ? entry["factor"].get<double>() : 0.0;
    }
    const double x = 0.5 / std::sqrt(1.25);
    row.check_below("limit", "", std::abs(ceiling - 4.0 / std::numbers::pi * x * std::atan(x)), 1e-12);
    CHECK(run.err_has("--from-point is another name of `hemi points`"));
    CHECK(run_hemi({"factors", scene, "--from-point", "0,0,0"}).err_has("it must be 6"));
    CHECK(run_hemi({"factors", scene, "--from-point", "0,0,0,0,0,0"}).status == 2);
    CHECK(run_hemi({"factors", scene, "--from-point", "0,0,0,0,0,1", "--preset", "fast"}).status == 2);
}
