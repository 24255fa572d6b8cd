#include "scene/convex_polygon.hpp"

#include <catch2/catch.hpp>

#include <numeric>
#include <vector>

namespace hemi {

namespace {

constexpr double slack = 1e-7;
const Vec3 up(0.0, 0.0, 1.0);

Polygon square() {
    return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
}

double area(const Polygon& polygon) {
    return glm::dot(area_vector(polygon), up); // negative where it is turned over
}

double sum_of_areas(const std::vector<Polygon>& parts) {
    return std::accumulate(parts.begin(), parts.end(), 0.0,
                           [](double sum, const Polygon& part) { return sum + area(part); });
}

} // namespace

TEST_CASE("DividedPolygon: without cuts it is one part, and a cut makes a left and a right one", "[scene]") {
    DividedPolygon divided(square(), up, slack);
    REQUIRE(divided.parts().size() == 1);
    CHECK(divided.parts()[0] == square());
    divided.cut({{0.25, -1.0, 0.0}, {0.25, 2.0, 0.0}}); // upwards: what is left of it has the smaller x
    const std::vector<Polygon> parts = divided.parts();
    REQUIRE(parts.size() == 2);
    CHECK(area(parts[0]) == Approx(0.25));
    CHECK(area(parts[1]) == Approx(0.75));
    CHECK(area_centroid(parts[0]).x == Approx(0.125));
    CHECK(parts[0].size() == 4);
}

TEST_CASE("DividedPolygon: a segment cuts along its whole line those parts alone that it runs through",
          "[scene]") {
    DividedPolygon divided(square(), up, slack);
    divided.cut({{0.5, 0.0, 0.0}, {0.5, 1.0, 0.0}});
    divided.cut({{0.1, 0.5, 0.0}, {0.2, 0.5, 0.0}}); // ends within the left part, and divides it whole
    std::vector<Polygon> parts = divided.parts();
    REQUIRE(parts.size() == 3);
    CHECK(area(parts[0]) == Approx(0.25));
    CHECK(area_centroid(parts[0]).y == Approx(0.75)); // on the left of a way to the right
    CHECK(area(parts[1]) == Approx(0.25));
    CHECK(area(parts[2]) == Approx(0.5));
    divided.cut({{0.4, 0.25, 0.0}, {0.6, 0.25, 0.0}}); // across the first cut
    parts = divided.parts();
    CHECK(parts.size() == 5);
    CHECK(sum_of_areas(parts) == Approx(1.0));
}

TEST_CASE("DividedPolygon: what runs beside it, along its border or along a cut cuts nothing", "[scene]") {
    DividedPolygon divided(square(), up, slack);
    divided.cut({{2.0, 0.0, 0.0}, {2.0, 1.0, 0.0}});
    divided.cut({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}});
    divided.cut({{0.0, 0.5 * slack, 0.0}, {1.0, 0.5 * slack, 0.0}});
    divided.cut({{-1.0, 0.0, 0.0}, {1e-9, 1.0, 0.0}}); // through a corner
    CHECK(divided.parts().size() == 1);
    divided.cut({{0.0, 0.0, 0.0}, {1.0, 1.0, 0.0}});
    divided.cut({{1.0, 1.0, 0.0}, {0.0, 0.0, 0.0}});
    divided.cut({{0.2, 0.2 + 0.5 * slack, 0.0}, {0.7, 0.7, 0.0}});
    const std::vector<Polygon> parts = divided.parts();
    REQUIRE(parts.size() == 2);
    CHECK(parts[0].size() == 3);
    CHECK(sum_of_areas(parts) == Approx(1.0));
}

TEST_CASE("DividedPolygon: a thousand parts are convex, and fill the polygon in the order of the cuts",
          "[scene]") {
    DividedPolygon divided(square(), up, slack);
    constexpr int lines = 31;
    for (int k = 1; k <= lines; ++k) {
        const double at = k / (lines + 1.0);
        divided.cut({{at, 0.0, 0.0}, {at, 1.0, 0.0}});
        divided.cut({{0.0, at, 0.0}, {1.0, at, 0.0}});
    }
    const std::vector<Polygon> parts = divided.parts();
    CHECK(parts.size() == (lines + 1) * (lines + 1));
    CHECK(sum_of_areas(parts) == Approx(1.0));
    for (const Polygon& part : parts) {
        CHECK(area(part) == Approx(1.0 / ((lines + 1) * (lines + 1))));
        CHECK(contains(part, up, area_centroid(part), 0.0));
    }
    CHECK(area_centroid(parts.front()).x < 1.0 / (lines + 1)); // left of all
    CHECK(area_centroid(parts.back()).x > lines / (lines + 1.0));
}

} // namespace hemi
