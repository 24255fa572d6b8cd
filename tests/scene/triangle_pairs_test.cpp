#include "hemi/scene/triangle_pairs.hpp"

#include "hemi/scene/imprint.hpp"
#include "pipeline/cut_mesh.hpp"
#include "support/in_triangles.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

Scene pair(const std::vector<Vec3>& first, const std::vector<Vec3>& second) {
    Scene scene = empty_scene();
    add_polygon(scene, "a", first);
    add_polygon(scene, "a", second);
    for (Surface& surface : scene.surfaces) {
        surface.patches.reset();
    }
    return scene;
}

std::size_t surfaces_joined(Scene scene, const Subdivision& subdivision = {0.1, {}}) {
    join_triangle_pairs(scene, subdivision);
    return scene.surfaces.size();
}

const Vec3 a(0, 0, 0);
const Vec3 b(1, 0, 0);
const Vec3 c(1, 1, 0);
const Vec3 d(0, 1, 0);

} // namespace

TEST_CASE("join_triangle_pairs: a patch size cuts halves as it cuts the quadrilaterals", "[scene]") {
    for (const Scene& scene : {room_with_blocks(1), tapered_box(1)}) {
        Scene quads = scene;
        for (Surface& surface : quads.surfaces) {
            surface.patches.reset();
        }
        const Scene triangles = in_triangles(scene);
        for (const double size : {0.3, 0.07}) {
            Scene joined = triangles;
            join_triangle_pairs(joined, {size, {}});
            CHECK(PatchMesh(joined, {size, {}}).geometry_hash() ==
                  PatchMesh(quads, {size, {}}).geometry_hash());
            joined = triangles;
            joined.patch_size = size;
            join_triangle_pairs(joined, {});
            CHECK(PatchMesh(joined).geometry_hash() == PatchMesh(quads, {size, {}}).geometry_hash());
            const std::vector<std::uint32_t> faces = face_numbers(joined.surfaces);
            CHECK(faces[1] == 2);
            CHECK(faces.back() == triangles.surfaces.size() - 2);
        }
    }
}

TEST_CASE("join_triangle_pairs: whatever corner the triangles begin with, and where they share an edge",
          "[scene]") {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const std::vector<Vec3> first{a, b, c};
            const std::vector<Vec3> second{a, c, d};
            Scene scene = pair({first[i], first[(i + 1) % 3], first[(i + 2) % 3]},
                               {second[j], second[(j + 1) % 3], second[(j + 2) % 3]});
            join_triangle_pairs(scene, {0.25, {}});
            REQUIRE(scene.surfaces.size() == 1);
            CHECK(scene.surfaces[0].joins);
            CHECK(scene.surfaces[0].vertices[0] == first[i]);
            const PatchMesh mesh(scene, {0.25, {}});
            CHECK(mesh.size() == 16);
            CHECK(mesh.normal(0).z == 1.0);
        }
    }
}

TEST_CASE("cut_mesh: joins pairs of triangles where it is given a size", "[scene]") {
    const Scene triangles = pair({a, b, c}, {a, c, d});
    CHECK(cut_mesh(triangles, {0.25, {}}, false).size() == 16);
    CHECK(cut_mesh(triangles, {0.25, {}}, true).size() == 16);
    CHECK(cut_mesh(triangles, {}, true).size() == 2);
}

TEST_CASE("join_triangle_pairs: what is no quadrilateral, or unlike, or cut otherwise, stays", "[scene]") {
    const Scene square = pair({a, b, c}, {a, c, d});
    REQUIRE(surfaces_joined(square) == 1);
    CHECK(surfaces_joined(pair({a, b, c}, {a, c, {0.0, 1.0, 0.01}})) == 2);          // not plane
    CHECK(surfaces_joined(pair({a, b, c}, {a, {0.6, 0.4, 0.0}, b})) == 2);           // they overlap
    CHECK(surfaces_joined(pair({a, b, c}, {a, c, {1.5, 2.0, 0.0}})) == 2);           // not convex
    CHECK(surfaces_joined(pair({a, b, {0.5, 0.5, 0}}, {a, {0.5, 0.5, 0}, d})) == 2); // a triangle in two
    CHECK(surfaces_joined(pair({a, b, c}, {a, d, c})) == 2);                         // turned round
    CHECK(surfaces_joined(square, {2.0, {}}) == 2); // one patch each: the user's own
    CHECK(surfaces_joined(square, {{}, 64}) == 2);
    CHECK(surfaces_joined(square, {}) == 2);

    Scene other = square;
    other.surfaces[1].two_sided = true;
    CHECK(surfaces_joined(other) == 2);
    other = square;
    other.groups.push_back("b");
    other.surfaces[1].group = 1;
    CHECK(surfaces_joined(other) == 2);
    other = square;
    other.surfaces[1].heat = 0;
    CHECK(surfaces_joined(other) == 2);
    other = square;
    other.surfaces[1].continues = true; // a face that was cut along this diagonal
    CHECK(surfaces_joined(other) == 2);
    other = square;
    other.patch_size = 0.1;
    CHECK(surfaces_joined(other, {}) == 1);
    other.surfaces[0].patches = Grid{2, 2};
    CHECK(surfaces_joined(other, {}) == 2);
    CHECK(surfaces_joined(other) == 1); // an option beats it
}

TEST_CASE("join_triangle_pairs: what is cut where it touches is no pair any more", "[scene]") {
    Scene scene = pair({a, b, c}, {a, c, d});
    add_block(scene, "block", {0.3, 0.3, 0.0}, {0.6, 0.6, 0.5}, 1);
    join_triangle_pairs(scene, {0.5, {}});
    REQUIRE(scene.surfaces.size() == 7);
    const auto cut = imprint(scene, {0.5, {}});
    REQUIRE(cut);
    for (const Surface& surface : cut->scene.surfaces) {
        CHECK_FALSE(surface.joins);
    }
}
