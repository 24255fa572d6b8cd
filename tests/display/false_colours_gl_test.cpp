#include "hemi/display/false_colours.hpp"

#include "display/display_fixtures.hpp"
#include "display/legend.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

using namespace hemi;

namespace {

using Pixel = std::array<int, 3>;

Pixel pixel(const Picture& picture, std::uint32_t x, std::uint32_t y) {
    const std::size_t at = (std::size_t{y} * picture.width + x) * 3;
    return {picture.srgb[at], picture.srgb[at + 1], picture.srgb[at + 2]};
}

/// What a position of the scale looks like, within rounding.
bool is_scale(const Pixel& pixel, double position) {
    const std::array<float, 3> linear = scale_colour(position);
    for (std::size_t c = 0; c < 3; ++c) {
        const float value = linear[c];
        const float srgb =
            value <= 0.0031308F ? 12.92F * value : 1.055F * std::pow(value, 1.0F / 2.4F) - 0.055F;
        if (std::abs(static_cast<float>(pixel[c]) - 255.0F * srgb) > 1.5F) {
            return false;
        }
    }
    return true;
}

constexpr Pixel legend_ground{22, 24, 26};

} // namespace

TEST_CASE("Legend: marks are round, in range, few, and told from each other", "[display]") {
    CHECK(round_marks(293.15, 1273.15, 5) == std::vector<double>{400.0, 600.0, 800.0, 1000.0, 1200.0});
    CHECK(round_marks(-45000.0, 52000.0, 5) ==
          std::vector<double>{-40000.0, -20000.0, 0.0, 20000.0, 40000.0});
    CHECK(round_marks(0.0, 1.0, 2) == std::vector<double>{0.0, 1.0});
    CHECK(round_marks(3.1, 3.9, 1) == std::vector<double>{3.5});
    const std::vector<double> fine = round_marks(20.15, 20.85, 4);
    REQUIRE(fine.size() == 4);
    CHECK(mark_text(fine[0], fine) == "20.2");
    CHECK(mark_text(500.0, {500.0, 1000.0}) == "500");
    CHECK(mark_text(-20000.0, {-20000.0, 0.0}) == "-20000");
    CHECK(mark_text(2e9, {0.0, 2e9}) == "2e+09");
    CHECK(level_text(50.0, {0.0, 50.0, 100.0}) == "50");
    CHECK(level_text(0.41125, {0.0, 0.41125, 0.8225}) == "0.41");
    CHECK(level_text(293.25, {293.15, 293.25, 293.35}) == "293.25");
    CHECK(level_text(100.0, {0.01, 0.1, 1.0, 10.0, 100.0}) == "100");
    CHECK(level_text(2e9, {0.0, 2e9}) == "2e+09");
}

TEST_CASE("False colours: the lowest and the highest value have the ends of the scale", "[display][gl]") {
    test::SceneBuilder builder;
    builder.floor("floor", -1.0, -1.0, 1.0, 1.0, {4, 1});
    const PatchMesh mesh = builder.mesh();
    // Sees from -1 to 1: 80 pixels a patch.
    const Camera camera{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(0.25) * 180.0 / std::numbers::pi};
    PictureSettings settings;
    settings.width = 320;
    settings.height = 320;
    settings.samples = 1;
    settings.exposure = 7.0; // must not count
    FalseColours shown{{300.0, 350.0, 400.0, std::numeric_limits<double>::quiet_NaN()}, "Temperature", "K"};
    REQUIRE(mesh.centres()[0].x < mesh.centres()[3].x);
    const Picture picture = draw_false_colours(mesh, shown, camera, settings, "osmesa");
    CHECK(is_scale(pixel(picture, 40, 100), 0.0));
    CHECK(is_scale(pixel(picture, 120, 100), 0.5));
    CHECK(is_scale(pixel(picture, 200, 100), 1.0));
    const Pixel grey = pixel(picture, 280, 100);
    CHECK((grey[0] == grey[1] && grey[1] == grey[2]));
    CHECK(pixel(picture, 7, 312) == legend_ground);
    // The scale in the legend has its own ends and writing in it.
    bool low = false;
    bool high = false;
    bool ink = false;
    for (std::uint32_t y = 250; y < 320; ++y) {
        for (std::uint32_t column = 6; column < 226; ++column) {
            const Pixel here = pixel(picture, column, y);
            low = low || is_scale(here, 0.0);
            high = high || is_scale(here, 1.0);
            ink = ink || here == Pixel{235, 235, 235};
        }
    }
    CHECK((low && high && ink));
    // A range of one's own, on a logarithmic scale, with other colours and without the legend.
    FalseColours own{{1.0, 10.0, 100.0, 1000.0}, "Light", "lx"};
    own.range = {1.0, 100.0};
    own.logarithmic = true;
    own.map = ColourMap::grey;
    own.legend = false;
    const Picture ranged = draw_false_colours(mesh, own, camera, settings, "osmesa");
    CHECK(pixel(ranged, 40, 100) == Pixel{0, 0, 0});
    CHECK(pixel(ranged, 120, 100) == Pixel{128, 128, 128});
    CHECK(pixel(ranged, 200, 100) == Pixel{255, 255, 255});
    CHECK(pixel(ranged, 280, 100) == Pixel{255, 255, 255});
    CHECK(pixel(ranged, 7, 312) != legend_ground);
    own.range = {0.0, 100.0};
    CHECK_THROWS_AS(draw_false_colours(mesh, own, camera, settings, "osmesa"), InvalidArgument);
    own.range.reset();
    own.values = {0.0, -1.0, 0.0, 0.0};
    CHECK_THROWS_AS(draw_false_colours(mesh, own, camera, settings, "osmesa"), InvalidArgument);
    // About zero both sides have as many colours.
    own = {{-1.0, 0.0, 4.0, 0.0}, "Flux", ""};
    own.map = ColourMap::cool_warm;
    const Pixel zero = pixel(draw_false_colours(mesh, own, camera, settings, "osmesa"), 120, 100);
    CHECK((zero[0] == zero[1] && zero[1] == zero[2]));
    // One value alone is the middle, and what is small has no legend.
    settings.width = 150;
    shown.values.assign(4, 300.0);
    const Picture small = draw_false_colours(mesh, shown, camera, settings, "osmesa");
    CHECK(is_scale(pixel(small, 75, 160), 0.5));
    CHECK(pixel(small, 7, 312) != legend_ground);
    shown.values.pop_back();
    CHECK_THROWS_AS(draw_false_colours(mesh, shown, camera, settings, "osmesa"), InvalidArgument);
    shown.values.push_back(std::numeric_limits<double>::infinity());
    CHECK_THROWS_AS(draw_false_colours(mesh, shown, camera, settings, "osmesa"), InvalidArgument);
}

TEST_CASE("False colours: bands have one colour each, the ends' first and last", "[display][gl]") {
    test::SceneBuilder builder;
    builder.floor("floor", -1.0, -1.0, 1.0, 1.0, {8, 1});
    FalseColours shown{{0.0, 0.9, 1.1, 1.9, 2.1, 2.9, 3.1, 4.0}, "T", "K"};
    shown.bands = 4;
    PictureSettings settings;
    settings.width = 240;
    settings.height = 200;
    settings.samples = 1;
    const double fov = 2.0 * std::atan(0.25) * 180.0 / std::numbers::pi;
    const Camera camera{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, fov};
    const Picture picture = draw_false_colours(builder.mesh(), shown, camera, settings, "osmesa");
    // The floor is 200 pixels wide: 25 a patch, from 20 on.
    for (std::uint32_t patch = 0; patch < 8; ++patch) {
        CHECK(is_scale(pixel(picture, 20 + 25 * patch + 12, 60), (patch / 2) / 3.0));
    }
    shown.bands = 1;
    CHECK_THROWS_AS(draw_false_colours(builder.mesh(), shown, camera, settings, "osmesa"), InvalidArgument);
    shown.bands = 33;
    CHECK_THROWS_AS(draw_false_colours(builder.mesh(), shown, camera, settings, "osmesa"), InvalidArgument);
    CHECK(ColourScale{0.0, 4.0, false, ColourMap::viridis, 4}.marks() ==
          std::vector<double>{0.0, 1.0, 2.0, 3.0, 4.0});
}

TEST_CASE("False colours: iso-lines lie where the interpolated value is round, or a band ends",
          "[display][gl]") {
    test::SceneBuilder builder;
    builder.floor("floor", -1.0, -1.0, 1.0, 1.0, {10, 2});
    FalseColours shown{{}, "T", "K"};
    for (int k = 0; k < 20; ++k) {
        shown.values.push_back(k % 10 + 0.5); // the value at x is 5 (x + 1)
    }
    shown.range = {0.0, 10.0};
    shown.bands = 2;
    shown.legend = false;
    shown.iso_lines = true;
    PictureSettings settings;
    settings.width = 200;
    settings.height = 200;
    const double fov = 2.0 * std::atan(0.25) * 180.0 / std::numbers::pi;
    const Camera camera{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, fov};
    const auto dark_columns = [&] {
        const Picture picture = draw_false_colours(builder.mesh(), shown, camera, settings, "osmesa");
        FalseColours without = shown;
        without.iso_lines = false;
        const Picture bare = draw_false_colours(builder.mesh(), without, camera, settings, "osmesa");
        std::vector<std::uint32_t> columns;
        for (std::uint32_t x = 0; x < 200; ++x) {
            if (pixel(picture, x, 70) != pixel(bare, x, 70)) {
                columns.push_back(x);
            }
        }
        return columns;
    };
    const std::vector<std::uint32_t> middle = dark_columns();
    REQUIRE_FALSE(middle.empty());
    CHECK(middle.size() <= 4);
    CHECK(middle.front() >= 97);
    CHECK(middle.back() <= 102);
    shown.bands = 0; // lines at 1, 2 … 9: every 20 pixels
    const std::vector<std::uint32_t> all = dark_columns();
    for (const std::uint32_t x : all) {
        CHECK(std::abs(std::remainder(x + 0.5, 20.0)) <= 3.0);
    }
    CHECK(all.size() >= 9);
    CHECK(ColourScale{0.0, 10.0, false, ColourMap::viridis, 0, true}.levels().size() == 9);
    // Of two surfaces in one plane they run on where the values do; else every surface ends by itself.
    test::SceneBuilder halves;
    halves.floor("left", -1.0, -1.0, 0.0, 1.0, {5, 2});
    halves.floor("right", 0.0, -1.0, 1.0, 1.0, {5, 2});
    FalseColours apart = shown;
    apart.bands = 2;
    apart.values.clear();
    for (int k = 0; k < 20; ++k) {
        apart.values.push_back(k % 5 + 0.5 + (k < 10 ? 0.0 : 5.0));
    }
    const auto line_at_middle = [&](bool across) {
        apart.across_materials = across;
        apart.iso_lines = true;
        const Picture with = draw_false_colours(halves.mesh(), apart, camera, settings, "osmesa");
        apart.iso_lines = false;
        const Picture bare = draw_false_colours(halves.mesh(), apart, camera, settings, "osmesa");
        std::size_t columns = 0;
        for (std::uint32_t x = 90; x < 110; ++x) {
            columns += pixel(with, x, 70) != pixel(bare, x, 70) ? 1 : 0;
        }
        return columns;
    };
    CHECK(line_at_middle(false) == 0);
    CHECK(line_at_middle(true) > 0);
    shown.values[4] = std::numeric_limits<double>::quiet_NaN(); // lends nothing, has no line
    CHECK_NOTHROW(dark_columns());
}
