#include "engine/hemicube/raster_coordinates.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace hemi;

TEST_CASE("RasterCoordinates: magnitudes of 1 and less, by a power of two", "[engine]") {
    DrawList list;
    list.vertices = {Vec3(100.0, -3.0, 7.0), Vec3(106.0, -2.0, 8.0)};
    const RasterCoordinates coordinates(list);
    CHECK(coordinates.scale == 0.25);
    CHECK(coordinates.of(list.vertices[0]) == Vec3(-0.75, -0.125, -0.125));
    CHECK(coordinates.of(list.vertices[1]) == Vec3(0.75, 0.125, 0.125));
}

TEST_CASE("RasterCoordinates: a position is the sum of its two floats, each coordinate to 2^-48",
          "[engine]") {
    DrawList list;
    list.vertices = {Vec3(-1.0), Vec3(1.0)};
    const RasterCoordinates coordinates(list);
    for (int k = 0; k < 100; ++k) {
        const Vec3 position(std::sin(k + 0.1), std::cos(1.7 * k), std::sin(2.3 * k + 1.0));
        const Vec3 raster = coordinates.of(position);
        const SplitPosition split = coordinates.split(position);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double sum = static_cast<double>(split.high[axis]) + static_cast<double>(split.low[axis]);
            CHECK(std::abs(sum - raster[static_cast<int>(axis)]) <= 0x1p-48);
        }
    }
}
