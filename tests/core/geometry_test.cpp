#include "hemi/core/geometry.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace hemi;

namespace {

const std::vector<Vec3> unit_square{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};

std::vector<Vec3> moved(std::vector<Vec3> polygon, const Vec3& by) {
    for (Vec3& point : polygon) {
        point += by;
    }
    return polygon;
}

std::vector<Vec3> scaled(std::vector<Vec3> polygon, double factor) {
    for (Vec3& point : polygon) {
        point *= factor;
    }
    return polygon;
}

bool near(const Vec3& a, const Vec3& b, double margin) {
    return glm::length(a - b) <= margin;
}

/// Distance to the nearest of many points spread over a convex quadrilateral: never too small.
double sampled_distance(const Vec3& point, const std::vector<Vec3>& polygon) {
    constexpr int steps = 400;
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= steps; ++i) {
        for (int j = 0; j <= steps; ++j) {
            const double u = static_cast<double>(i) / steps;
            const double v = static_cast<double>(j) / steps;
            const Vec3 low = (1 - u) * polygon[0] + u * polygon[1];
            const Vec3 high = (1 - u) * polygon[3] + u * polygon[2];
            nearest = std::min(nearest, glm::length(point - ((1 - v) * low + v * high)));
        }
    }
    return nearest;
}

} // namespace

TEST_CASE("Bounds: empty until a point is added", "[core]") {
    Bounds bounds;
    CHECK(bounds.empty());
    CHECK(bounds.diagonal() == 0.0);
    bounds.add(Vec3(1, -2, 3));
    CHECK_FALSE(bounds.empty());
    CHECK(bounds.diagonal() == 0.0);
    CHECK(bounds.centre() == Vec3(1, -2, 3));
    bounds.add(Vec3(3, 4, 0));
    CHECK(bounds.lower == Vec3(1, -2, 0));
    CHECK(bounds.upper == Vec3(3, 4, 3));
    CHECK(bounds.diagonal() == Approx(7.0).epsilon(1e-15));
    CHECK(bounds.centre() == Vec3(2, 1, 1.5));
}

TEST_CASE("area_vector: area times the normal about which the corners run counter-clockwise", "[core]") {
    CHECK(area_vector(unit_square) == Vec3(0, 0, 1));
    CHECK(area_vector(std::vector<Vec3>(unit_square.rbegin(), unit_square.rend())) == Vec3(0, 0, -1));
    const std::array triangle{Vec3(0, 0, 0), Vec3(0, 2, 0), Vec3(0, 0, 3)};
    CHECK(area_vector(triangle) == Vec3(3, 0, 0));
    // A concave polygon and one whose outline is not planar are covered by the same formula.
    const std::array arrow{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0, 2, 0)};
    CHECK(area_vector(arrow) == Vec3(0, 0, 1));
}

TEST_CASE("area_vector: nothing with fewer than three corners has an area", "[core]") {
    CHECK(area_vector({}) == Vec3(0.0));
    CHECK(area_vector(std::span(unit_square).first(1)) == Vec3(0.0));
    CHECK(area_vector(std::span(unit_square).first(2)) == Vec3(0.0));
}

TEST_CASE("area_vector: distance from the origin costs no digits", "[core]") {
    // These corners are exact in binary at that distance.
    CHECK(area_vector(moved(unit_square, Vec3(1048576, -524288, 65536))) == Vec3(0, 0, 1));
}

TEST_CASE("area_vector: goes with the square of the scale", "[core]") {
    for (const double factor : {1e-6, 1e-3, 1e6, 1e30}) {
        INFO("factor " << factor);
        CHECK(area_vector(scaled(unit_square, factor)).z == Approx(factor * factor).epsilon(1e-14).margin(0));
    }
}

TEST_CASE("area_centroid: of the area and not of the corners", "[core]") {
    CHECK(near(area_centroid(unit_square), Vec3(0.5, 0.5, 0), 1e-15));
    const std::array triangle{Vec3(0, 0, 1), Vec3(3, 0, 1), Vec3(0, 6, 1)};
    CHECK(near(area_centroid(triangle), Vec3(1, 2, 1), 1e-15));
    // Trapezium with parallel sides 2 and 1, height 1: (2 + 2 · 1) / (3 · (2 + 1)) above the longer side.
    const std::array trapezium{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1.5, 1, 0), Vec3(0.5, 1, 0)};
    CHECK(near(area_centroid(trapezium), Vec3(1, 4.0 / 9.0, 0), 1e-15));
    // A fifth corner in the middle of an edge moves the mean of the corners but not the centroid.
    const std::array five{Vec3(0, 0, 0), Vec3(0.5, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
    CHECK(near(area_centroid(five), Vec3(0.5, 0.5, 0), 1e-15));
}

TEST_CASE("area_centroid: moves and scales with the polygon and does not turn with its orientation",
          "[core]") {
    const std::vector<Vec3> quad{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1.5, 1, 0.5), Vec3(0.5, 1, 0.5)};
    const Vec3 centroid = area_centroid(quad);
    CHECK(near(area_centroid(std::vector<Vec3>(quad.rbegin(), quad.rend())), centroid, 1e-15));
    CHECK(near(area_centroid(moved(quad, Vec3(1e5, -1e5, 1e5))), centroid + Vec3(1e5, -1e5, 1e5), 1e-10));
    for (const double factor : {1e-6, 1e6}) {
        CHECK(near(area_centroid(scaled(quad, factor)), factor * centroid, 1e-15 * factor));
    }
}

TEST_CASE("area_centroid: of a polygon without area is one of its corners", "[core]") {
    const std::vector<Vec3> point(4, Vec3(1, 2, 3));
    CHECK(area_centroid(point) == Vec3(1, 2, 3));
}

TEST_CASE("distance_to_polygon: above it the height and beside it the distance to the outline", "[core]") {
    CHECK(distance_to_polygon(Vec3(0.3, 0.7, 2), unit_square) == Approx(2.0));
    CHECK(distance_to_polygon(Vec3(0.3, 0.7, -2), unit_square) == Approx(2.0));
    CHECK(distance_to_polygon(Vec3(0.3, 0.7, 0), unit_square) == 0.0);
    CHECK(distance_to_polygon(Vec3(0.5, 0, 0), unit_square) == 0.0);
    CHECK(distance_to_polygon(Vec3(1, 1, 0), unit_square) == 0.0);
    CHECK(distance_to_polygon(Vec3(0.5, -3, 0), unit_square) == Approx(3.0));
    CHECK(distance_to_polygon(Vec3(0.5, -3, 4), unit_square) == Approx(5.0));
    CHECK(distance_to_polygon(Vec3(4, 5, 0), unit_square) == Approx(5.0));
    CHECK(distance_to_polygon(Vec3(-2, -1, 2), unit_square) == Approx(3.0));
}

TEST_CASE("distance_to_polygon: never more than and close to the nearest of many points of it", "[core]") {
    const std::vector<Vec3> quad{Vec3(0, 0, 0), Vec3(2, 0, 0.4), Vec3(1.5, 1, 0.5), Vec3(0.5, 1, 0.3)};
    std::mt19937 random(5);
    std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
    for (int k = 0; k < 40; ++k) {
        const Vec3 point(coordinate(random), coordinate(random), coordinate(random));
        const double exact = distance_to_polygon(point, quad);
        const double sampled = sampled_distance(point, quad);
        INFO("point " << point.x << " " << point.y << " " << point.z);
        CHECK(exact <= sampled + 1e-12);
        // Samples are at most 0.003 from any point of the polygon.
        CHECK(sampled * sampled <= exact * exact + 2.0 * exact * 0.003 + 0.003 * 0.003 + 1e-12);
    }
}
