#include "engine/rays/shadow_rays.hpp"

#include "support/scenes.hpp"

#include <catch2/catch.hpp>

using namespace hemi;
using namespace hemi::test;

namespace {

/// Two facing unit squares at distance 1, patches 0 and 1, and half way between them a sheet over x in
/// [from, to].
Scene squares_and_sheet(double from, double to) {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    add_polygon(scene, "ceiling", {{0, 1, 1}, {1, 1, 1}, {1, 0, 1}, {0, 0, 1}});
    add_polygon(scene, "sheet", {{from, -1, 0.5}, {to, -1, 0.5}, {to, 2, 0.5}, {from, 2, 0.5}});
    return scene;
}

double visibility(const Scene& scene, std::uint32_t rays) {
    const PatchMesh mesh(scene);
    return ShadowRays(mesh).visibility(0, 1, rays).visibility;
}

} // namespace

TEST_CASE("ShadowRays: 1 where nothing hides, 0 where a sheet hides all", "[engine]") {
    CHECK(visibility(squares_and_sheet(5.0, 6.0), 16) == 1.0);
    CHECK(visibility(squares_and_sheet(-1.0, 2.0), 16) == 0.0);
}

TEST_CASE("ShadowRays: a sheet over half of the gap hides half, by symmetry", "[engine]") {
    CHECK(visibility(squares_and_sheet(-1.0, 0.5), 16) == Approx(0.5).margin(0.13));
    CHECK(visibility(squares_and_sheet(-1.0, 0.5), 4096) == Approx(0.5).margin(0.005));
    CHECK(visibility(squares_and_sheet(0.5, 2.0), 4096) == Approx(0.5).margin(0.005));
}

TEST_CASE("ShadowRays: a pair has one visibility, whichever patch comes first", "[engine]") {
    const PatchMesh mesh(room_with_blocks(4));
    const ShadowRays rays(mesh);
    std::uint32_t partly = 0;
    for (std::uint32_t i = 0; i < mesh.size(); i += 3) {
        for (std::uint32_t j = 1; j < mesh.size(); j += 5) {
            const auto one = rays.visibility(i, j, 8);
            const auto other = rays.visibility(j, i, 8);
            REQUIRE(one.visibility == other.visibility);
            REQUIRE(one.rays == other.rays);
            REQUIRE(one.rays <= 8.0 + 1e-12);
            partly += one.visibility > 0.0 && one.visibility < 1.0 ? 1 : 0;
        }
    }
    CHECK(partly > 100);
}

TEST_CASE("ShadowRays: rays between patches that touch are worth fewer than their number", "[engine]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0), 8);
    const PatchMesh mesh(scene);
    const ShadowRays rays(mesh);
    std::uint32_t corner = 0; // of the floor, at the origin
    std::uint32_t beside = 0; // of the wall x0, at the origin
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (glm::distance(mesh.centres()[i], Vec3(1.0 / 16.0, 1.0 / 16.0, 0.0)) < 1e-9) {
            corner = i;
        }
        if (glm::distance(mesh.centres()[i], Vec3(0.0, 1.0 / 16.0, 1.0 / 16.0)) < 1e-9) {
            beside = i;
        }
    }
    REQUIRE(corner != beside);
    const auto near = rays.visibility(corner, beside, 64);
    CHECK(near.visibility == 1.0);
    CHECK(near.rays < 32.0);
    const PatchMesh apart(squares_and_sheet(5.0, 6.0));
    CHECK(ShadowRays(apart).visibility(0, 1, 64).rays > 32.0);
}
