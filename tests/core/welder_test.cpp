#include "core/welder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

using namespace hemi;

TEST_CASE("Welder: points within the tolerance get one index and the first one's position", "[core]") {
    Welder welder(0.01);
    CHECK(welder.add(Vec3(1, 2, 3)) == 0);
    CHECK(welder.add(Vec3(1.009, 2, 3)) == 0);
    CHECK(welder.add(Vec3(1, 1.991, 3)) == 0);
    CHECK(welder.add(Vec3(1.011, 2, 3)) == 1);
    CHECK(welder.add(Vec3(1, 2, 4)) == 2);
    REQUIRE(welder.points().size() == 3);
    CHECK(welder.points()[0] == Vec3(1, 2, 3));
    CHECK(welder.points()[1] == Vec3(1.011, 2, 3));
}

TEST_CASE("Welder: the tolerance is a distance and not one of each coordinate", "[core]") {
    Welder welder(1.0);
    CHECK(welder.add(Vec3(0.0)) == 0);
    CHECK(welder.add(Vec3(0.8, 0.8, 0.8)) == 1);
    CHECK(welder.add(Vec3(-0.57, -0.57, -0.57)) == 0);
}

TEST_CASE("Welder: finds neighbours across every cell boundary and below zero", "[core]") {
    // Cells are 16 tolerances wide; pairs that straddle their faces, edges and corners on both sides of zero.
    for (const double boundary : {-32.0, -16.0, 0.0, 16.0, 32.0}) {
        for (const Vec3& step :
             {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 0), Vec3(1, -1, 1), Vec3(-1, 1, 1)}) {
            Welder welder(1.0);
            const Vec3 half = 0.49 * glm::normalize(step);
            CHECK(welder.add(Vec3(boundary) - half) == 0);
            CHECK(welder.add(Vec3(boundary) + half) == 0);
            CHECK(welder.add(Vec3(boundary) + 2.1 * half) == 1);
        }
    }
}

TEST_CASE("Welder: of jittered copies of grid points as many positions remain as there are grid points",
          "[core]") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> jitter(-0.28, 0.28); // any two copies within the tolerance of 1
    std::vector<Vec3> points;
    std::vector<int> origin;
    for (int x = -4; x < 4; ++x) {
        for (int y = -4; y < 4; ++y) {
            for (int z = -4; z < 4; ++z) {
                for (int copy = 0; copy < 6; ++copy) {
                    points.push_back(3.7 * Vec3(x, y, z) +
                                     Vec3(jitter(random), jitter(random), jitter(random)));
                    origin.push_back((x * 8 + y) * 8 + z);
                }
            }
        }
    }
    std::vector<std::size_t> order(points.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        order[i] = i;
    }
    std::shuffle(order.begin(), order.end(), random);
    for (const double scale : {1e-6, 1.0, 1e6}) {
        Welder welder(scale);
        std::set<std::pair<int, std::uint32_t>> pairs;
        for (const std::size_t i : order) {
            pairs.emplace(origin[i], welder.add(scale * points[i]));
        }
        CHECK(welder.points().size() == 512);
        CHECK(pairs.size() == 512);
    }
}

TEST_CASE("Welder: far from the origin close points are told apart as well as they can be", "[core]") {
    Welder welder(1e-6);
    const Vec3 far(1e5, -1e5, 1e5);
    CHECK(welder.add(far) == 0);
    CHECK(welder.add(far + Vec3(5e-7, 0, 0)) == 0);
    CHECK(welder.add(far + Vec3(0, 0, 2e-6)) == 1);
}

TEST_CASE("Welder: adding its own positions again changes nothing", "[core]") {
    Welder welder(1e-3);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> coordinate(-0.05, 0.05); // crowded: many are near several others
    for (int k = 0; k < 2000; ++k) {
        welder.add(Vec3(coordinate(random), coordinate(random), coordinate(random)));
    }
    const std::vector<Vec3> points = welder.points();
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        REQUIRE(welder.add(points[i]) == i);
    }
    CHECK(welder.points().size() == points.size());
}
