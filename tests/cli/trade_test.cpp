#include "cli/program.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <regex>
#include <set>
#include <utility>

using namespace hemi::cli_test;

namespace {

Words on_osmesa(Words words) {
    words.insert(words.end(), {"--device", "osmesa", "--jobs", "1"});
    return words;
}

Words on_cpu(Words words) {
    words.insert(words.end(), {"--device", "cpu", "--jobs", "1"});
    return words;
}

} // namespace

TEST_CASE("solve, factors: an estimate of errors is told, stored and shown", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(4));
    const Json plain =
        run_hemi(quick({"factors", scene, "--preset", "plain", "--json", "-o", directory.path("a.hff")}))
            .json()["error_estimate"];
    CHECK(plain["rows_compared"] == 12);
    CHECK(plain["row"]["rms"] > 1e-3);
    CHECK(plain["row"]["rms"] < 0.1);
    CHECK(plain["factor"]["rms"] < plain["row"]["rms"]);
    CHECK(plain["factor"]["max"] > plain["factor"]["rms"]);
    const Json stored = run_hemi({"info", directory.path("a.hff"), "--json"}).json()["error_estimate"];
    CHECK(stored == plain);
    CHECK(run_hemi({"info", directory.path("a.hff")}).out_has("estimated from 12 rows"));

    const Json hybrid =
        run_hemi(quick({"factors", scene, "--preset", "fast", "--json"})).json()["error_estimate"];
    CHECK(hybrid["row"]["rms"] < 1e-6);

    // Rows of a file are judged by the reference that came with them.
    const Outcome solved = run_hemi({"solve", scene, "--factors", directory.path("a.hff"), "--json",
                                     "--result", directory.path("a.hres")});
    REQUIRE(solved.status == 0);
    const Json error = solved.json()["error_estimate"];
    CHECK(error["row"] == plain["row"]);
    CHECK(error["radiosity"]["rms"] > 1e-4);
    CHECK(error["radiosity"]["rms"] < 0.1);
    const Json shown = run_hemi({"info", directory.path("a.hres"), "--json"}).json()["error_estimate"];
    CHECK(shown == error);

    // The whole of it has the patches' size in it, which is the larger part here.
    const Json whole = solved.json()["error"];
    const Json parts = whole["parts"];
    CHECK(parts["factors"] == error["radiosity"]["rms"]);
    CHECK(parts["patch_size"] > parts["factors"]);
    CHECK(whole["vertices"]["rms"].get<double>() ==
          Approx(std::hypot(parts["patch_size"].get<double>(), parts["factors"].get<double>(),
                            parts["solver"].get<double>())));
    CHECK(whole["field"]["rms"] > 0.01);
    CHECK(whole["field"]["p95"] > whole["field"]["rms"]);
    CHECK(whole["patches_sampled"] >= 48);
    REQUIRE(whole["groups"].size() == solved.json()["groups"].size());
    for (const Json& group : whole["groups"]) {
        CHECK(group > 0.0);
        CHECK(group < 0.2);
    }
    CHECK(run_hemi({"info", directory.path("a.hres"), "--json"}).json()["error"] == whole);
    const Outcome told =
        run_hemi({"solve", scene, "--factors", directory.path("a.hff"), "-o", directory.path("a.png"), "-v"});
    CHECK(told.out_has("the reflected light is within"));
    CHECK(told.out_has("cut in four"));
    CHECK(told.out_has("mean irradiance of groups within"));
    CHECK(told.out_has("--patch-size"));
    CHECK_FALSE(told.out_has("is not included"));

    const Outcome without = run_hemi(quick({"solve", scene, "--no-estimate", "--json"}));
    CHECK(without.status == 0);
    CHECK(without.json()["error_estimate"].is_null());
    CHECK(without.json()["error"].is_null());
    CHECK(run_hemi(quick({"check", scene, "--no-estimate"})).status == 2);
}

TEST_CASE("error target: the cheapest settings that do are found, said and stored", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(4));
    const std::string file = directory.path("a.hff");
    const Outcome loose = run_hemi(on_osmesa({"factors", scene, "--error-target", "0.1", "--json"}));
    REQUIRE(loose.status == 0);
    CHECK(loose.json()["chosen_for"] ==
          "preset plain, eye points 1, resolution 64, for an error target of 0.1");
    const Outcome close =
        run_hemi(on_osmesa({"factors", scene, "--error-target", "1e-5", "--json", "-o", file}));
    REQUIRE(close.status == 0);
    CHECK(close.json()["chosen_for"] == "preset fast, for an error target of 1e-05");
    CHECK(close.json()["error_estimate"]["row"]["rms"] <= 1e-5);
    const Json info = run_hemi({"info", file, "--json"}).json();
    CHECK(info["preset"] == "fast");
    CHECK(info["chosen_for"] == close.json()["chosen_for"]);

    const Outcome solved = run_hemi(on_osmesa({"solve", scene, "--error-target", "1e-5", "--error-target-of",
                                               "factors", "--json", "--result", directory.path("a.hres")}));
    REQUIRE(solved.status == 0);
    CHECK(solved.json()["chosen_for"] == "preset fast, for an error target of 1e-05");
    CHECK(solved.json()["error_estimate"]["radiosity"]["rms"] <= 1e-5);
    CHECK(run_hemi({"info", directory.path("a.hres")}).out_has("for an error target of 1e-05"));
    CHECK(run_hemi(on_osmesa({"solve", scene, "--error-target", "1e-5", "--error-target-of", "factors"}))
              .out_has("chosen"));
}

TEST_CASE("error target: what cannot be met is status 5, what contradicts it is usage", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    for (const char* command : {"factors", "solve"}) {
        const auto with_target = [&](Words words) {
            if (std::string(command) == "solve") {
                words.insert(words.end(), {"--error-target-of", "factors"});
            }
            return run_hemi(on_osmesa(words));
        };
        const Outcome missed = with_target({command, scene, "--error-target", "1e-15"});
        CHECK(missed.status == 5);
        CHECK(missed.err_has("an error target of 1e-15 cannot be met: the best settings"));
        CHECK(missed.out.empty());
        const Outcome poor = with_target({command, scene, "--error-target", "1e-4", "--max-memory", "1K"});
        CHECK(poor.status == 5);
        CHECK(poor.err_has("needs more than the 1.0 KiB"));
    }
    for (const Words& more :
         {Words{"--preset", "fast"}, Words{"--eye-points", "4"}, Words{"--shadow-rays", "4"},
          Words{"--resolution", "64"}, Words{"--no-estimate"}}) {
        Words words{"solve", scene, "--error-target", "1e-3", "--error-target-of", "factors"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome refused = run_hemi(words);
        CHECK(refused.status == 2);
        CHECK(refused.err_has(more.front()));
    }
    CHECK(run_hemi({"solve", scene, "--error-target", "0"}).status == 2);
    CHECK(run_hemi({"factors", scene, "--error-target", "1e-3", "--row", "1"}).status == 2);
    CHECK(run_hemi({"check", scene, "--error-target", "1e-3"}).status == 2);
    REQUIRE(run_hemi(quick({"factors", scene, "-o", directory.path("a.hff")})).status == 0);
    CHECK(run_hemi({"solve", scene, "--factors", directory.path("a.hff"), "--error-target", "1e-3",
                    "--error-target-of", "factors"})
              .status == 2);
}

TEST_CASE("trade: table, drawing, JSON and advice", "[cli][slow]") {
    const Directory directory;
    Json box = cube(2);
    box["name"] = "Box <1> & more";
    const std::string scene = directory.write("cube.json", box);
    // More than it takes: all is measured, however slow the machine is.
    const Outcome run = run_hemi(on_cpu({"trade", scene, "--patch-size", "1", "--budget", "30s", "--json",
                                         "-o", directory.path("plot.svg")}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json trade = run.json();
    CHECK(trade["schema"] == "hemi/trade/1");
    CHECK(trade["patches"] == 6);
    CHECK(trade["budget"] == 30.0);
    CHECK(trade["reference"]["rows"] > 0);
    REQUIRE(trade["measurements"].size() > 4);
    INFO(trade["omitted"].dump());
    CHECK(trade["omitted"].empty());
    REQUIRE(trade["best"].is_string());
    CHECK(trade["advice"].get<std::string>().find("(" + trade["best"].get<std::string>() + ")") !=
          std::string::npos);
    CHECK(trade["advice"].get<std::string>().find(" % in ") != std::string::npos);
    double last = 0.0;
    std::size_t on_front = 0;
    double least = 1e300;
    for (const Json& m : trade["measurements"]) {
        CHECK(m["seconds"] >= last);
        last = m["seconds"];
        CHECK((m["rows"] == "all" || m["rows"] == "sample"));
        CHECK(m["rms"] >= 0.0);
        CHECK(m["row"] >= m["rms"]);
        CHECK(m["max"] >= m["rms"]);
        if (m["front"] == true) {
            ++on_front;
            CHECK(m["row"] <= least);
            least = m["row"];
        }
    }
    CHECK(on_front > 0);

    // Whole solutions, on several sizes of patches, by presets and other methods.
    const Json& solutions = trade["solutions"];
    REQUIRE(solutions.size() > 6);
    CHECK(trade["solution_reference"]["points"] > 400);
    double last_seconds = 0.0;
    double least_error = 1e300;
    std::set<std::uint32_t> sizes;
    std::set<std::string> methods;
    bool refined = false;
    for (const Json& solution : solutions) {
        INFO(solution.dump());
        CHECK(solution["seconds"] >= last_seconds);
        last_seconds = solution["seconds"];
        CHECK(solution["memory"] > 0);
        CHECK(solution["vertices"]["rms"] > 0.0);
        CHECK(solution["vertices"]["rms"] < 0.5);
        CHECK(solution["field"]["rms"] >= 0.0);
        CHECK(solution["row"] >= 0.0);
        CHECK(solution["patches"] < trade["solution_reference"]["patches"]);
        const double error = solution["vertices"]["rms"];
        CHECK(solution["front"] == (error < least_error));
        least_error = std::min(error, least_error);
        methods.insert(solution["method"].get<std::string>());
        const std::string options = solution["options"];
        if (solution["error_target"].is_number()) {
            refined = true;
            CHECK(options.find("--patch-size") == std::string::npos);
        } else if (solution["patch_size"].is_number()) {
            sizes.insert(solution["patches"].get<std::uint32_t>());
            CHECK(options.starts_with(solution["patches"] == 24 ? "--patch-size 0.5 --preset "
                                                                : "--patch-size 0.25 --preset "));
        } else {
            CHECK((options.starts_with("--patch-size 1 --preset ") ||
                   options.starts_with("--patch-size 1 --method ")));
        }
    }
    CHECK(refined);
    CHECK(sizes.size() == 2);
    CHECK(methods.size() > 2);
    const std::string plot = directory.read("plot.svg");
    CHECK(plot.starts_with("<svg "));
    CHECK(plot.ends_with("</svg>\n"));
    // Letters are 7.2 wide at most on average; the title is written larger and shortened by itself.
    const std::regex started(
        "<text x=\"([0-9.]+)\"[^>]*text-anchor=\"start\"[^>]*fill=\"#222222\" >([^<]*)<");
    std::size_t legends = 0;
    for (std::sregex_iterator text(plot.begin(), plot.end(), started), end; text != end; ++text) {
        INFO((*text)[2]);
        CHECK(std::stod((*text)[1]) + 7.2 * static_cast<double>((*text)[2].length()) <= 960.0);
        ++legends;
    }
    CHECK(legends > 3);
    CHECK(plot.find("seconds for the whole solution") != std::string::npos);
    CHECK(plot.find("seconds for all rows") != std::string::npos);
    CHECK(plot.find("6 patches: Box &lt;1&gt; &amp; more") != std::string::npos);

    const Outcome text = run_hemi(on_cpu({"trade", scene, "--patch-size", "1", "--budget", "2s"}));
    CHECK(text.status == 0);
    CHECK(text.out_has("radiosity"));
    CHECK(text.out_has("Compared at"));
    CHECK(text.out_has("Recommended: "));
    CHECK(text.out_has("--preset"));
}

TEST_CASE("trade: where there is no light, form factors alone are compared, and that is said", "[cli]") {
    const Directory directory;
    Json dark = cube(1);
    dark["materials"]["lamp"]["exitance"] = 0;
    Json black = cube(1);
    black["materials"]["white"]["reflectance"] = 0;
    // Time enough for some to be measured where a sanitizer or other work slows all down.
    const Outcome text = run_hemi(on_cpu({"trade", directory.write("black.json", black), "--budget", "3s",
                                          "--patches-per-face", "4", "--no-imprint"}));
    CHECK(text.status == 0);
    CHECK(text.out_has("Errors of form factors only: nothing in the scene reflects light."));
    CHECK(text.out_has("Recommended: --patches-per-face 4 --no-imprint --"));
    const Outcome run = run_hemi(on_cpu({"trade", directory.write("dark.json", dark), "--budget", "3s",
                                         "--json", "-o", directory.path("plot.svg")}));
    INFO(run.err);
    const Json trade = run.json();
    CHECK(trade["solutions"].empty());
    CHECK(trade["solution_reference"].is_null());
    CHECK_FALSE(trade["measurements"].empty());
    CHECK(trade["advice"].get<std::string>().find("for a row error of") != std::string::npos);
    const std::string plot = directory.read("plot.svg");
    CHECK(plot.find("seconds for all rows") != std::string::npos);
    CHECK(plot.find("seconds for the whole solution") == std::string::npos);
}

TEST_CASE("trade: what it cannot do is refused", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(1));
    const auto refused = [](const Words& words, const std::string& part) {
        const Outcome outcome = run_hemi(words);
        INFO(outcome.err);
        CHECK(outcome.status == 2);
        CHECK(outcome.err_has(part));
    };
    refused({"trade", scene, "-o", directory.path("a.png")}, "must end in .svg");
    refused({"trade", scene, "--budget", "soon"}, "a time such as 60s");
    refused({"trade", scene, "--budget", "0"}, "a time such as 60s");
    refused({"trade", scene, "--preset", "fast"}, "--preset does not apply to `hemi trade`");
    refused({"trade", scene, "-o", "-", "--json"}, "cannot both go to standard output");
    refused({"trade", directory.write("a.hff", "")}, "needs a scene");
    CHECK(run_hemi({"trade", directory.path("missing.json")}).status == 3);
}
