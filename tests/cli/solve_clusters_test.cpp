#include "cli/program.hpp"

#include <catch2/catch.hpp>

#include <cstdint>
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

TEST_CASE("solve: rows in a file take no memory, and give the same", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(16));
    const auto solve = [&](Words more) {
        Words words{"solve",        scene,  "--device",    "cpu",
                    "--preset",     "fast", "--radiosity", directory.path("b.csv"),
                    "--no-estimate"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome run = run_hemi(words);
        INFO(run.err);
        CHECK(run.status == 0);
        return std::pair(run.err, directory.read("b.csv"));
    };
    for (const std::string clusters : {"on", "off"}) {
        const Words memory{"--clusters", clusters};
        const Words file{"--clusters", clusters, "--scratch", directory.path(".")};
        CHECK(solve(memory).second == solve(file).second);
    }
    // The pairs fit as soon as only the rows do not.
    CHECK_THAT(solve({"--max-memory", "26M"}).first, Contains("Far patches are seen in clusters"));
    CHECK_THAT(solve({"--max-memory", "26M", "--scratch", directory.path(".")}).first,
               !Contains("Far patches are seen in clusters"));
    const Outcome missing = run_hemi({"solve", scene, "--scratch", directory.path("missing")});
    CHECK(missing.status == 3);
    CHECK_THAT(missing.err, Contains("missing: no file of rows can be made there: No such file"));
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

TEST_CASE("form factors with clusters: kept in a file, used again, written to other files", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(8));
    const std::string file = directory.path("a.hff");
    const auto run = [&](Words words) {
        words.insert(words.end(), {"--json", "--quiet"});
        return run_hemi(words);
    };
    const Words on{"--device", "cpu", "--preset", "fast", "--clusters", "on", "--cluster-error", "2%"};
    const auto with = [](Words words, const Words& more) {
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    const auto solve = [&](const Words& more, const std::string& radiosity) {
        return run(with({"solve", scene, "--radiosity", directory.path(radiosity)}, more));
    };
    REQUIRE(solve(on, "without.csv").status == 0);
    const Outcome written = solve(with(on, {"--factors", file}), "written.csv");
    INFO(written.err);
    REQUIRE(written.json()["clusters"] == true);
    const Outcome reused = solve({"--device", "cpu", "--clusters", "on", "--factors", file}, "reused.csv");
    INFO(reused.err);
    REQUIRE(reused.json()["clusters"] == true);
    CHECK(directory.read("written.csv") == directory.read("without.csv"));
    CHECK(directory.read("reused.csv") == directory.read("without.csv"));
    CHECK(reused.json()["error_estimate"] == written.json()["error_estimate"]);

    const auto refusal = [&](const Words& words) {
        const Outcome outcome = run_hemi(words);
        INFO(outcome.err);
        CHECK((outcome.status == 2 || outcome.status == 3));
        return outcome.err;
    };
    CHECK_THAT(refusal({"solve", scene, "--factors", file, "--clusters", "off"}),
               Contains("--clusters off conflicts with --factors"));
    CHECK_THAT(refusal({"solve", scene, "--factors", file, "--cluster-error", "1%"}),
               Contains("--cluster-error makes rows"));
    CHECK_THAT(refusal({"solve", scene, "--factors", file, "--refine", "2000"}),
               Contains("a.hff: far patches stand in clusters"));
    CHECK_THAT(refusal({"check", file}), Contains("a.hff: far patches stand in clusters"));

    const Outcome made = run(with({"factors", scene, "-o", directory.path("b.hff")}, on));
    INFO(made.err);
    const Json summary = made.json();
    CHECK(summary["clusters"] == true);
    CHECK(directory.read("b.hff") == directory.read("a.hff"));
    const Json info = run({"info", file}).json();
    CHECK(info["clusters"] == true);
    CHECK(info["entries"] == summary["entries"]);

    const Outcome converted = run_hemi({"convert", file, directory.path("a.npz")});
    CHECK_THAT(converted.err, Contains("factors to clusters are shared out among their patches"));
    const Json single = run({"info", directory.path("a.npz")}).json();
    CHECK_FALSE(single.contains("clusters"));
    CHECK(single["entries"].get<std::uint64_t>() > info["entries"].get<std::uint64_t>());
    CHECK(single["row_sum"]["min"].get<double>() == Approx(1.0).epsilon(1e-5));
    REQUIRE(run_hemi({"convert", file, directory.path("copy.hff")}).status == 0);
    CHECK(directory.read("copy.hff") == directory.read("a.hff"));

    const Json clusters = run({"factors", file, "--by-group"}).json();
    const Json pairs =
        run({"factors", scene, "--device", "cpu", "--preset", "fast", "--clusters", "off", "--by-group"})
            .json();
    REQUIRE(clusters["factors"].size() == pairs["factors"].size());
    for (std::size_t g = 0; g < pairs["factors"].size(); ++g) {
        for (std::size_t h = 0; h < pairs["factors"].size(); ++h) {
            CHECK(clusters["factors"][g][h].get<double>() ==
                  Approx(pairs["factors"][g][h].get<double>()).margin(0.005));
        }
    }
    double sum = 0.0;
    const Json row = run({"factors", file, "--row", "7"}).json();
    for (const Json& entry : row["entries"]) {
        CHECK(entry["patch"].get<std::uint32_t>() < info["patches"].get<std::uint32_t>());
        sum += entry["factor"].get<double>();
    }
    CHECK(sum == Approx(1.0).epsilon(1e-5));
    CHECK_THAT(refusal(with({"factors", scene, "--rows", "0:64", "-o", directory.path("p.hff")}, on)),
               Contains("--clusters on excludes --rows"));
    CHECK_THAT(refusal(with({"factors", scene, "--error-target", "1%"}, {"--clusters", "on"})),
               Contains("--clusters on excludes --error-target"));
}

TEST_CASE("points and bake: far patches are seen in clusters as solve sees them", "[cli]") {
    const Directory directory;
    Json cube = coloured(16);
    cube["materials"]["lamp"]["reflectance"] = 0.1; // or bake, which wants light alone, leaves its rows out
    const std::string scene = directory.write("cube.json", cube);
    const auto run = [&](Words words, const Words& more) {
        words.insert(words.end(), {"--device", "cpu", "--preset", "fast"});
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = run_hemi(words);
        INFO(outcome.err);
        REQUIRE(outcome.status == 0);
        return outcome;
    };
    const Words on{"--clusters", "on", "--cluster-error", "2%"};
    const std::string rows = directory.path("a.hff");
    const std::string result = directory.path("a.hres");
    run({"solve", scene, "--no-estimate", "--factors", rows, "--result", result}, on);
    const auto points = [&](const std::string& input, const Words& more) {
        run({"points", input, "--grid", "floor", "0.25", "0.5", "-o", directory.path("points.csv")}, more);
        return directory.read("points.csv");
    };
    const std::string of_result = points(result, {});
    CHECK(points(scene, on) == of_result);
    CHECK(points(scene, {"--factors", rows}) == of_result);
    CHECK(points(scene, {"--clusters", "off"}) != of_result);

    const auto bake = [&](const std::string& input, const Words& more) {
        Words words{"bake", input, "--flat", "-o", directory.path("a.ply")};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = run_hemi(words);
        INFO(outcome.err);
        REQUIRE(outcome.status == 0);
        return directory.read("a.ply");
    };
    const Words fast{"--device", "cpu", "--preset", "fast", "--clusters"};
    const auto with = [&fast](const Words& more) {
        Words words = fast;
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    const std::string baked = bake(result, {});
    CHECK(bake(scene, with({"on", "--cluster-error", "2%"})) == baked);
    CHECK(bake(scene, with({"off"})) != baked);

    for (const Words& words : {Words{"points", scene, "--grid", "floor", "0.25", "0.5"},
                               Words{"bake", scene, "-o", rows + ".ply"}}) {
        const Outcome little = run(words, {"--max-memory", "14M"});
        CHECK_THAT(little.err, Contains("Far patches are seen in clusters"));
        Words refused = words;
        refused.insert(refused.end(), {"--clusters", "on", "--solver", "cg"});
        const Outcome refusal = run_hemi(refused);
        CHECK(refusal.status == 2);
        CHECK_THAT(refusal.err, Contains("--clusters on excludes --solver cg"));
    }
    const Outcome trade = run_hemi({"trade", scene, "--clusters", "on"});
    CHECK(trade.status == 2);
    CHECK_THAT(trade.err, Contains("--clusters does not apply to `hemi trade`"));
}
