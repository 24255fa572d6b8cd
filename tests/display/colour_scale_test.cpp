#include "display/colour_scale.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>

using namespace hemi;

TEST_CASE("ColourScale: positions and values are each other's inverse", "[display]") {
    for (const ColourScale& scale : {ColourScale{2.0, 7.0, false}, ColourScale{1e-6, 0.05, true}}) {
        CHECK(scale.position(scale.low) == 0.0);
        CHECK(scale.position(scale.high) == Approx(1.0));
        for (const double place : {0.1, 0.5, 0.9}) {
            CHECK(scale.position(scale.value_at(place)) == Approx(place));
        }
        CHECK(scale.position(100.0) == 1.0);
        CHECK(scale.position(-1.0) == 0.0);
        for (const double mark : scale.marks()) {
            CHECK(mark >= scale.low * (1.0 - 1e-9));
            CHECK(mark <= scale.high * (1.0 + 1e-9));
        }
    }
    CHECK(ColourScale{1e-6, 0.05, true}.marks().size() == 5);
    CHECK(ColourScale{1e-300, 1.0, true}.marks().size() <= 9);
}

TEST_CASE("ColourScale: colours grow brighter all the way", "[display]") {
    double before = -1.0;
    for (int k = 0; k <= 100; ++k) {
        const auto colour = scale_colour(k / 100.0);
        const double light = 0.2126 * static_cast<double>(colour[0]) +
                             0.7152 * static_cast<double>(colour[1]) +
                             0.0722 * static_cast<double>(colour[2]);
        CHECK(light > before);
        before = light;
    }
    CHECK(scale_colour(-1.0) == scale_colour(0.0));
    CHECK(scale_colour(2.0) == scale_colour(1.0));
}

TEST_CASE("ColourScale: scales end on round numbers", "[display]") {
    CHECK(round_up(0.9) == Approx(1.0));
    CHECK(round_up(1.0) == Approx(1.0));
    CHECK(round_up(1.1) == Approx(2.0));
    CHECK(round_up(3e-7) == Approx(5e-7));
    CHECK(round_up(6300.0) == Approx(10000.0));
}

TEST_CASE("item_colour: neighbours differ", "[display]") {
    for (std::uint32_t id = 0; id < 1000; ++id) {
        const auto a = item_colour(id);
        const auto b = item_colour(id + 1);
        CHECK(std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]) > 0.05F);
    }
}

TEST_CASE("ColourScale: maps begin and end where they should, and grow brighter where they say so",
          "[display]") {
    const auto light = [](ColourMap map, double position) {
        const std::array<float, 3> c = scale_colour(position, map);
        return 0.2126F * c[0] + 0.7152F * c[1] + 0.0722F * c[2];
    };
    for (const ColourMap map : {ColourMap::viridis, ColourMap::inferno, ColourMap::grey}) {
        INFO(to_word(map));
        for (int k = 1; k <= 100; ++k) {
            CHECK(light(map, k / 100.0) > light(map, (k - 1) / 100.0));
        }
    }
    CHECK(scale_colour(0.0, ColourMap::grey) == std::array<float, 3>{0.0F, 0.0F, 0.0F});
    CHECK(scale_colour(1.0, ColourMap::grey) == std::array<float, 3>{1.0F, 1.0F, 1.0F});
    const std::array<float, 3> middle =
        scale_colour(0.5, ColourMap::cool_warm); // of both sides of zero: grey
    CHECK(middle[0] == middle[1]);
    CHECK(middle[1] == middle[2]);
    CHECK(scale_colour(0.0, ColourMap::cool_warm)[2] > scale_colour(0.0, ColourMap::cool_warm)[0]);
    CHECK(scale_colour(1.0, ColourMap::cool_warm)[0] > scale_colour(1.0, ColourMap::cool_warm)[2]);
    CHECK(scale_colour(0.0, ColourMap::turbo)[2] > scale_colour(0.0, ColourMap::turbo)[1]);
}
