#include "cli/program.hpp"

#include <catch2/catch.hpp>

#include <string>

using namespace hemi::cli_test;
using Catch::Matchers::Contains;

TEST_CASE("solve: far patches are seen in clusters where it is asked for, or where pairs do not fit",
          "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(16));
    const auto solve = [&](Words more) {
        Words words{"solve", scene, "--device", "cpu", "--preset", "fast", "--no-estimate", "--json"};
        words.insert(words.end(), more.begin(), more.end());
        return run_hemi(words);
    };
    const Outcome with_pairs = solve({"--verbose"});
    CHECK_THAT(with_pairs.err, Contains("1/5 visibility") && Contains("2/5 combining pairs"));
    const Json pairs = with_pairs.json();
    CHECK(pairs["clusters"] == false);
    CHECK(pairs["reciprocity"].is_object());
    const auto check_clusters = [&](const Json& run) {
        CHECK(run["clusters"] == true);
        CHECK(run["reciprocity"].is_null());
        CHECK(run["repair"]["name"] == "none");
        CHECK(run["row_sum"]["min"].get<double>() == Approx(1.0).epsilon(1e-5));
        for (std::size_t g = 0; g < run["groups"].size(); ++g) {
            for (std::size_t c = 0; c < run["channels"].size(); ++c) {
                CHECK(run["radiosity"][g][c].get<double>() ==
                      Approx(pairs["radiosity"][g][c].get<double>()).epsilon(0.005));
            }
        }
    };
    const Outcome clusters = solve({"--clusters", "on", "--cluster-error", "0.5%", "--verbose"});
    CHECK_THAT(clusters.err, Contains("1/2 visibility") && !Contains("combining pairs"));
    check_clusters(clusters.json());

    const Outcome little = solve({"--max-memory", "14M", "--verbose"});
    INFO(little.err);
    REQUIRE(little.status == 0);
    CHECK_THAT(little.err, Contains("Far patches are seen in clusters"));
    check_clusters(little.json());
    const Outcome plain = solve({"--max-memory", "26M", "--clusters", "off"});
    CHECK_THAT(plain.err, Contains("Plain hemicube rows are computed instead"));
    CHECK(plain.json()["clusters"] == false);
}

TEST_CASE("solve: what needs single pairs refuses clusters", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(2));
    const auto refusal = [&](Words more) {
        Words words{"solve", scene, "--device", "cpu", "--clusters", "on"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome run = run_hemi(words);
        CHECK(run.status == 2);
        return run.err;
    };
    CHECK_THAT(refusal({"--factors", directory.path("a.hff")}), Contains("--clusters on excludes --factors"));
    CHECK_FALSE(directory.has("a.hff"));
    CHECK_THAT(refusal({"--refine", "500"}), Contains("--clusters on excludes --error-target and --refine"));
    CHECK_THAT(refusal({"--error-target", "5%"}), Contains("--clusters on excludes --error-target"));
    CHECK_THAT(refusal({"--preset", "plain"}), Contains("--clusters on excludes --preset plain"));
    CHECK_THAT(refusal({"--method", "montecarlo"}), Contains("--method excludes --clusters"));
    CHECK_THAT(refusal({"--repair", "closure"}), Contains("--clusters on excludes --repair"));
    CHECK_THAT(refusal({"--solver", "cg"}), Contains("--clusters on excludes --solver cg"));
    CHECK_THAT(refusal({"--shadow-rays", "8"}), Contains("--clusters on excludes --shadow-rays"));
    for (const Words& without :
         {Words{"--clusters", "off"}, Words{"--repair", "closure"}, Words{"--refine", "500"}}) {
        Words words{"solve", scene, "--device", "cpu", "--cluster-error", "1%"};
        words.insert(words.end(), without.begin(), without.end());
        const Outcome run = run_hemi(words);
        CHECK(run.status == 2);
        CHECK_THAT(run.err, Contains("--cluster-error has no effect with --"));
    }
    CHECK_THAT(refusal({"--cluster-error", "0"}), Contains("--cluster-error"));
    CHECK_THAT(refusal({"--mirror", "x=-1"}), Contains("clusters are not made of a scene with symmetry"));
}
