#include "cli/heat_scenes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <string>

using namespace hemi::cli_test;
using Catch::Matchers::Contains;

namespace {

/// Of which some are as good as found in clusters: far patches, sides without a flux.
Json far_box() {
    return box(1.0, 1.2, 1.5, 20);
}

/// Past which little heat finds its way.
void add_shield(Json& box) {
    box["surfaces"].push_back(
        face("shield", "side", {{0.1, 0.1, 0.7}, {0.9, 0.1, 0.7}, {0.9, 1.1, 0.7}, {0.1, 1.1, 0.7}}, 16));
    box["surfaces"].back()["two_sided"] = true;
    box["groups"]["shield"] = {{"heat_flux", 0}};
}

Outcome run_with(Words words, const Words& more) {
    words.insert(words.end(), {"--device", "cpu", "--preset", "fast", "--json", "--quiet"});
    words.insert(words.end(), more.begin(), more.end());
    return run_hemi(words);
}

const Words in_clusters{"--clusters", "on", "--cluster-error", "0.5%"};

/// Checks fluxes and temperatures against those of pairs, relative to the largest of all.
void check_near(const Json& clusters, const Json& pairs, double tolerance) {
    REQUIRE(clusters["clusters"] == true);
    REQUIRE(pairs["clusters"] == false);
    CHECK(pairs["asymmetry"].is_null());
    CHECK(clusters["asymmetry"].get<double>() > 0.0);
    CHECK(clusters["asymmetry"].get<double>() < 0.1);
    for (const char* const key : {"net_flux", "irradiation", "temperature"}) {
        double largest = 0.0;
        for (const Json& value : pairs[key]) {
            largest = std::max(largest, std::abs(value.get<double>()));
        }
        for (std::size_t g = 0; g < pairs["groups"].size(); ++g) {
            INFO(key << " of " << pairs["groups"][g]);
            CHECK(clusters[key][g].get<double>() ==
                  Approx(pairs[key][g].get<double>()).epsilon(0).margin(tolerance * largest));
        }
    }
    CHECK(clusters["balance"]["relative"].get<double>() < 1e-9);
}

} // namespace

TEST_CASE("hemi heat: far patches in clusters exchange what pairs do, and heat balances",
          "[cli][heat][clusters][slow]") {
    const Directory directory;
    Json scene = far_box();
    Words clustered = in_clusters;
    SECTION("adiabatic sides") {}
    SECTION("an open side, to an environment") {
        Json left;
        for (const Json& surface : scene["surfaces"]) {
            if (surface["name"] != "left") {
                left.push_back(surface);
            }
        }
        scene["surfaces"] = left;
        scene["groups"].erase("left");
        scene["environment"] = {{"temperature", 250}};
        scene["enclosure"] = "open";
    }
    SECTION("two bands") {
        scene["bands"] = {3.0};
        scene["materials"]["side"]["emissivity"] = {0.3, 0.8};
    }
    SECTION("an isothermal side") {
        scene["groups"]["back"] = {{"power", -200}, {"isothermal", true}};
    }
    SECTION("something in the way") {
        add_shield(scene);
        // Clusters of the sides of which only some patches are hidden give heat on past the shield.
        clustered.back() = "0.01%";
    }
    const std::string file = directory.write("box.json", scene);
    const Outcome clusters = run_with({"heat", file, "--no-estimate"}, clustered);
    INFO(clusters.err);
    REQUIRE(clusters.status == 0);
    check_near(clusters.json(), run_with({"heat", file, "--no-estimate"}, {"--clusters", "off"}).json(),
               0.01);
}

TEST_CASE("hemi heat: what clusters carry past a shield is in the error that is told",
          "[cli][heat][clusters][slow]") {
    const Directory directory;
    Json scene = far_box();
    add_shield(scene);
    const std::string file = directory.write("box.json", scene);
    const Json pairs = run_with({"heat", file, "--no-estimate"}, {"--clusters", "off"}).json();
    const Json clusters = run_with({"heat", file}, in_clusters).json();
    for (const std::size_t g : {0U, 1U}) {
        INFO(pairs["groups"][g]);
        const double difference =
            std::abs(clusters["net_flux"][g].get<double>() - pairs["net_flux"][g].get<double>());
        CHECK(difference > 0.02 * std::abs(pairs["net_flux"][g].get<double>()));
        CHECK(difference < 6.0 * clusters["error"]["parts"]["factors"][g].get<double>());
    }
}

TEST_CASE("hemi heat: one temperature everywhere makes no flux, with clusters, too",
          "[cli][heat][clusters]") {
    const Directory directory;
    Json scene = far_box();
    for (Json& group : scene["groups"]) {
        group = {{"temperature", 400}};
    }
    const Outcome run = run_with({"heat", directory.write("box.json", scene), "--no-estimate"}, in_clusters);
    INFO(run.err);
    const Json json = run.json();
    REQUIRE(json["clusters"] == true);
    for (const Json& flux : json["net_flux"]) {
        CHECK(std::abs(flux.get<double>()) < 1e-9 * sigma * std::pow(400.0, 4));
    }
}

TEST_CASE("hemi points: where all is of one temperature, it is the radiant one by clusters, too",
          "[cli][heat][clusters]") {
    const Directory directory;
    Json scene = far_box();
    for (auto& [name, group] : scene["groups"].items()) {
        group = {{"temperature", 300}};
    }
    Words words{"points", directory.write("box.json", scene), "--grid", "bottom", "0.25", "0.6", "--spheres"};
    const Outcome run = run_with(words, in_clusters);
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json json = run.json();
    REQUIRE(!json["mean_radiant_temperature"].empty());
    for (const Json& temperature : json["mean_radiant_temperature"]) {
        CHECK(temperature.get<double>() == Approx(300.0).epsilon(1e-5));
    }
}

TEST_CASE("hemi points: the radiant temperature by clusters is that by pairs",
          "[cli][heat][clusters][slow]") {
    const Directory directory;
    const std::string scene = directory.write("box.json", far_box());
    Words words{"points", scene, "--grid", "bottom", "0.25", "0.6", "--spheres"};
    const auto temperatures = [&](const Words& clusters) {
        const Outcome run = run_with(words, clusters);
        INFO(run.err);
        REQUIRE(run.status == 0);
        return run.json()["mean_radiant_temperature"];
    };
    const Json pairs = temperatures({"--clusters", "off"});
    const Json clusters = temperatures(in_clusters);
    REQUIRE(!pairs.empty());
    REQUIRE(clusters.size() == pairs.size());
    CHECK(clusters != pairs); // other rows
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        CHECK(pairs[k].get<double>() > 400.0); // of surfaces from 300 K to 550 K
        CHECK(pairs[k].get<double>() < 540.0);
        CHECK(clusters[k].get<double>() == Approx(pairs[k].get<double>()).epsilon(0).margin(0.1));
    }
}

TEST_CASE(
    "hemi heat: rows with clusters from a file, or where the memory is too small for pairs, and what is "
    "known of their error",
    "[cli][heat][clusters]") {
    const Directory directory;
    const std::string scene = directory.write("box.json", far_box());
    const std::string rows = directory.path("box.hff");
    const std::string fluxes = directory.path("a.csv");
    const Outcome written = run_with({"heat", scene, "--factors", rows, "--fluxes", fluxes}, in_clusters);
    INFO(written.err);
    const Json json = written.json();
    for (const Json& error : json["error"]["parts"]["factors"]) {
        CHECK(error.is_number());
    }
    CHECK(json["error"]["parts"]["factors"][0].get<double>() > 0.0);
    for (const Json& error : json["error"]["net_flux"]) {
        CHECK(error.is_null()); // the part of the patches' size is not estimated with clusters
    }
    const Words scratch{"--clusters", "on", "--cluster-error", "0.5%", "--scratch", directory.path(".")};
    CHECK(run_with({"heat", scene}, scratch).json()["net_flux"] == json["net_flux"]);
    const Outcome read =
        run_with({"heat", scene, "--factors", rows, "--fluxes", directory.path("b.csv")}, {});
    CHECK(read.json()["net_flux"] == json["net_flux"]);
    CHECK(directory.read("b.csv") == directory.read("a.csv"));

    const Outcome text = run_hemi({"heat", scene, "--factors", rows, "--device", "cpu", "--preset", "fast"});
    CHECK_THAT(text.out + text.err, Contains("exchange made symmetric"));

    const Outcome little = run_with({"heat", scene, "--no-estimate"}, {"--max-memory", "20M"});
    INFO(little.err);
    CHECK(little.json()["clusters"] == true);
    const Outcome refused = run_with({"heat", scene, "--repair", "closure"}, in_clusters);
    CHECK(refused.status == 2);
    CHECK_THAT(refused.err, Contains("--clusters on excludes --repair"));
}

TEST_CASE("hemi exchange: conductances by clusters are symmetric, balance, and are near those of pairs",
          "[cli][heat][clusters][slow]") {
    const Directory directory;
    const std::string scene = directory.write("box.json", far_box());
    const Outcome run = run_with({"exchange", scene}, in_clusters);
    INFO(run.err);
    const Json clusters = run.json();
    const Json pairs = run_with({"exchange", scene}, {"--clusters", "off"}).json();
    REQUIRE(clusters["clusters"] == true);
    CHECK(clusters["asymmetry"].get<double>() > 0.0);
    CHECK(pairs["asymmetry"].is_null());
    for (std::size_t g = 0; g < clusters["groups"].size(); ++g) {
        double sum = clusters["environment"][g].get<double>();
        for (std::size_t h = 0; h < clusters["groups"].size(); ++h) {
            const double conductance = clusters["conductance"][g][h].get<double>();
            CHECK(conductance == clusters["conductance"][h][g].get<double>());
            CHECK(conductance == Approx(pairs["conductance"][g][h].get<double>()).epsilon(0).margin(0.003));
            sum += clusters["script_f"][g][h].get<double>();
        }
        CHECK(sum == Approx(clusters["emissivity"][g].get<double>()).epsilon(1e-9));
    }
}
