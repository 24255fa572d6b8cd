#include "hemi/pipeline/quantities.hpp"

#include "support/scenes.hpp"

#include "hemi/core/error.hpp"

#include "hemi/scene/light_unit.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <string>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

/// Two squares of which the second shines, in three channels, and what is known of them.
struct Known {
    Scene scene = empty_scene();
    Solution solution;

    Known() {
        scene.channels = {"red", "green", "blue"};
        scene.materials = {{"wall", {0.5, 0.25, 0.125}, {0.0, 0.0, 0.0}},
                           {"lamp", {0.0, 0.0, 0.0}, {9.0, 9.0, 9.0}}};
        add_polygon(scene, "wall", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {2, 1});
        add_polygon(scene, "lamp", {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}});
        scene.surfaces.back().material = 1;
        solution.channels = 3;
        solution.exitance = {0, 0, 0, 0, 0, 0, 9, 9, 9};
        solution.radiosity = {1, 2, 3, 4, 5, 6, 9, 9, 9};
        solution.irradiance = {2, 8, 24, 8, 20, 48, 0, 0, 0};
        solution.row_sum = {0.25, 0.5, 0.0};
        solution.environment_share = {0.75, 0.25, 0.0};
        solution.back_face_share = {0.0, 0.125, 0.0};
    }
    [[nodiscard]] FalseColours shown(Quantity quantity, const std::string& channel = "mean") const {
        return patch_quantity(quantity, scene, PatchMesh(scene), solution, channel);
    }
};

} // namespace

TEST_CASE("quantities: values of patches, of one channel or all", "[pipeline]") {
    Known known;
    CHECK(known.shown(Quantity::radiosity, "green").values == std::vector<double>{2, 5, 9});
    CHECK(known.shown(Quantity::radiosity, "sum").values == std::vector<double>{6, 15, 27});
    CHECK(known.shown(Quantity::irradiance).values[1] == Approx(76.0 / 3.0));
    CHECK(known.shown(Quantity::irradiance, "luminance").values[0] ==
          Approx(0.2126 * 2 + 0.7152 * 8 + 0.0722 * 24));
    CHECK(known.shown(Quantity::exitance, "blue").values == std::vector<double>{0, 0, 9});
    CHECK(known.shown(Quantity::reflectance, "red").values == std::vector<double>{0.5, 0.5, 0});
    CHECK(known.shown(Quantity::emissivity, "red").values == std::vector<double>{0.5, 0.5, 1});
    CHECK(known.shown(Quantity::area).values == std::vector<double>{0.5, 0.5, 1.0});
    CHECK(known.shown(Quantity::area).unit == "m²");
    known.scene.unit = 0.5; // metres
    CHECK(known.shown(Quantity::area).values == std::vector<double>{0.125, 0.125, 0.25});
    // What arrives runs on across materials, and iso-lines with it; what leaves does not.
    CHECK(known.shown(Quantity::irradiance).across_materials);
    CHECK_FALSE(known.shown(Quantity::radiosity).across_materials);
    // The lamp's row was not computed.
    for (const Quantity share : {Quantity::environment, Quantity::blocked, Quantity::row_error}) {
        const std::vector<double> values = known.shown(share).values;
        CHECK(values[0] == (share == Quantity::environment ? 0.75 : 0.0));
        CHECK(values[1] == (share == Quantity::row_error     ? -0.125
                            : share == Quantity::environment ? 0.25
                                                             : 0.125));
        CHECK(std::isnan(values[2]));
        CHECK(needs_all_rows(share));
    }
}

TEST_CASE("quantities: the scale of radiosities is that of what lamps light", "[pipeline]") {
    Known known;
    CHECK(known.shown(Quantity::radiosity, "red").range == std::array{1.0, 4.0});
    CHECK_FALSE(known.shown(Quantity::irradiance).range);
    known.solution.irradiance.assign(9, 2.0); // as in a furnace, where a solver leaves some noise
    known.solution.irradiance[3] = 2.0001;
    REQUIRE(known.shown(Quantity::irradiance, "red").range);
    CHECK(known.shown(Quantity::irradiance, "red").range->front() == Approx(1.98));
    CHECK(known.shown(Quantity::irradiance, "red").range->back() == Approx(1.01 * 2.0001));
    known.solution.radiosity[3] = 10.0; // what is lit is brighter than the lamp
    CHECK_FALSE(known.shown(Quantity::radiosity, "red").range);
    known.solution.back_face_share[1] = 1.0; // buried: it has no value
    CHECK(std::isnan(known.shown(Quantity::radiosity, "red").values[1]));
}

TEST_CASE("quantities: temperatures and net fluxes are of heat", "[pipeline]") {
    Known known;
    CHECK_THROWS_WITH(known.shown(Quantity::temperature), Catch::Contains("hemi heat"));
    CHECK_THROWS_WITH(known.shown(Quantity::net_flux), Catch::Contains("flux: `hemi heat"));
    known.solution.temperature = {300.0, std::nan(""), 450.0};
    known.solution.net_flux = {-40.0, 0.0, 25.0};
    FalseColours shown = known.shown(Quantity::temperature, "red");
    CHECK(shown.title == "Temperature"); // of no channel
    CHECK(shown.unit == "K");
    CHECK(shown.values[2] == 450.0);
    CHECK(std::isnan(shown.values[1]));
    show_in_celsius(shown);
    CHECK(shown.unit == "°C");
    CHECK(shown.values[0] == Approx(26.85));
    shown = known.shown(Quantity::net_flux);
    show_in_celsius(shown);
    CHECK(shown.unit == "W/m²");
    CHECK(shown.values == known.solution.net_flux);
    for (const auto& [quantity, word] : Names<Quantity>::table) {
        CHECK(is_of_heat(quantity) == (word == "temperature" || word == "flux"));
        CHECK(std::string(title_of(quantity)) != "");
    }
}

TEST_CASE("quantities: what is not there is refused by name", "[pipeline]") {
    Known known;
    CHECK_THROWS_WITH(known.shown(Quantity::radiosity, "gren"),
                      Catch::Contains("'gren'") && Catch::Contains("green"));
    CHECK_THROWS_WITH(known.shown(Quantity::error), Catch::Contains("not estimated"));
    CHECK_THROWS_WITH(known.shown(Quantity::error_patch_size), Catch::Contains("not estimated"));
    known.solution.irradiance.clear();
    CHECK_THROWS_WITH(known.shown(Quantity::irradiance), Catch::Contains("--result"));
    known.scene.channels = {"a", "b", "c"};
    CHECK_THROWS_WITH(known.shown(Quantity::radiosity, "luminance"), Catch::Contains("red, green and blue"));
    known.solution.radiosity.pop_back();
    CHECK_THROWS_AS(known.shown(Quantity::radiosity, "a"), InvalidArgument);
}

TEST_CASE("quantities: channels count by their names in fluxes and luminance", "[pipeline]") {
    Scene scene;
    scene.channels = {"blue", "ir", "red", "green"};
    CHECK(luminance_weights(scene.channels) == std::vector<double>{0.0722, 0.0, 0.2126, 0.7152});
    CHECK(flux_weights(scene) == std::vector<double>(4, 1.0));
    scene.photometric = true;
    CHECK(flux_weights(scene) == luminance_weights(scene.channels));
    scene.channels = {"grey"};
    CHECK(luminance_weights(scene.channels).empty());
    CHECK(flux_weights(scene) == std::vector<double>{1.0});
}
