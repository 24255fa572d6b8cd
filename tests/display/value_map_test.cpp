#include "hemi/display/value_map.hpp"

#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <utility>

using namespace hemi;

namespace {

/// The middle of a cell, of a map whose cells are 32 pixels wide.
std::array<int, 3> colour_at(const ValueMap& map, std::uint32_t column, std::uint32_t row) {
    const std::size_t at = (std::size_t{row} * 32 + 16) * map.width + column * 32 + 16;
    return {map.rgb[at * 3], map.rgb[at * 3 + 1], map.rgb[at * 3 + 2]};
}

int brightness(const std::array<int, 3>& colour) {
    return colour[0] + colour[1] + colour[2];
}

} // namespace

TEST_CASE("value map: the first row is at the bottom, grids below each other, gaps white", "[display]") {
    const double none = std::numeric_limits<double>::quiet_NaN();
    const std::array<GridValues, 2> grids{GridValues{2, 2, {0, 1, 3}, {0.0, 10.0, none}},
                                          GridValues{1, 1, {0}, {5.0}}};
    const ValueMap map = make_value_map(grids, {0.0, 10.0});
    REQUIRE(map.width == 64);
    REQUIRE(map.height == 32 * 4); // two rows, one between, one row
    const std::array<int, 3> white{255, 255, 255};
    CHECK(colour_at(map, 0, 0) == white); // not in the grid
    CHECK(colour_at(map, 1, 0) == white); // not a number
    CHECK(colour_at(map, 0, 2) == white);
    CHECK(colour_at(map, 1, 3) == white);
    const int dark = brightness(colour_at(map, 0, 1));
    const int middle = brightness(colour_at(map, 0, 3));
    const int bright = brightness(colour_at(map, 1, 1));
    CHECK(dark < middle);
    CHECK(middle < bright);
    // Values beyond the range have the colours of its ends.
    const std::array<GridValues, 1> beyond{GridValues{2, 1, {0, 1}, {-5.0, 50.0}}};
    const ValueMap ends = make_value_map(beyond, {0.0, 10.0});
    CHECK(colour_at(ends, 0, 0) == colour_at(map, 0, 1));
    CHECK(colour_at(ends, 1, 0) == colour_at(map, 1, 1));
}

TEST_CASE("value map: wide grids have small cells, and what does not fit is refused", "[display]") {
    GridValues wide{500, 1, {499}, {1.0}};
    CHECK(make_value_map(std::array{wide}, {0.0, 1.0}).width == 500);
    wide.columns = 100;
    CHECK_THROWS_AS(make_value_map(std::array{wide}, {0.0, 1.0}), InvalidArgument);
    CHECK_THROWS_AS(make_value_map({}, {0.0, 1.0}), InvalidArgument);
    CHECK_THROWS_AS(make_value_map(std::array{GridValues{1, 1, {0}, {1.0}}}, {1.0, 1.0}), InvalidArgument);
    CHECK_THROWS_AS(make_value_map(std::array{GridValues{1, 1, {0}, {}}}, {0.0, 1.0}), InvalidArgument);
}

TEST_CASE("value map: the legend stands below and leaves the map as it is", "[display]") {
    const std::array<GridValues, 1> grids{GridValues{2, 2, {0, 1, 3}, {0.0, 10.0, 20.0}}};
    const ValueMap bare = make_value_map(grids, {0.0, 10.0});
    const ValueMap map = make_value_map(grids, {0.0, 10.0}, "irradiance  [W/m²]");
    REQUIRE(map.width == 320);
    REQUIRE(map.height > bare.height + 40);
    REQUIRE(map.rgb.size() == std::size_t{map.width} * map.height * 3);
    for (std::uint32_t y = 0; y < bare.height; ++y) {
        REQUIRE(std::equal(bare.rgb.begin() + y * bare.width * 3, bare.rgb.begin() + (y + 1) * bare.width * 3,
                           map.rgb.begin() + y * map.width * 3));
    }
    // The colours of the map, and ink, are below it.
    const auto has_below = [&](const std::array<int, 3>& colour) {
        for (std::size_t at = std::size_t{bare.height} * map.width * 3; at < map.rgb.size(); at += 3) {
            if (std::abs(map.rgb[at] - colour[0]) + std::abs(map.rgb[at + 1] - colour[1]) +
                    std::abs(map.rgb[at + 2] - colour[2]) <
                12) {
                return true;
            }
        }
        return false;
    };
    CHECK(has_below(colour_at(bare, 0, 1)));
    CHECK(has_below(colour_at(bare, 1, 1)));
    CHECK(has_below({235, 235, 235}));
    // 20 is beyond: the scale says so, and another title or range is another picture.
    CHECK(make_value_map(grids, {0.0, 20.0}, "irradiance  [W/m²]").rgb != map.rgb);
    CHECK(make_value_map(grids, {0.0, 10.0}, "irradiance  [lx]").rgb != map.rgb);
    // A wide map has a larger legend, a tall one has not.
    GridValues wide{100, 1, {}, {}};
    for (std::uint32_t k = 0; k < 100; ++k) {
        wide.cell.push_back(k);
        wide.values.push_back(k);
    }
    const ValueMap large = make_value_map(std::array{wide}, {0.0, 99.0}, "sky");
    CHECK(large.width == 800);
    CHECK(large.height == 8 + 2 * (map.height - bare.height));
    GridValues tall = wide;
    std::swap(tall.columns, tall.rows);
    CHECK(make_value_map(std::array{tall}, {0.0, 99.0}, "sky").width == 320);
}
