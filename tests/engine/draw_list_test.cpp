#include "engine/hemicube/draw_list.hpp"
#include "engine/hemicube/outline.hpp"
#include "hemi/core/error.hpp"
#include "support/scenes.hpp"

#include "hemi/engine/engine.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

using namespace hemi;
using namespace hemi::test;

namespace {

double area(const Outline& outline, const std::array<std::uint32_t, 3>& t) {
    const OutlinePoint& a = outline[t[0]];
    const OutlinePoint& b = outline[t[1]];
    const OutlinePoint& c = outline[t[2]];
    return 0.5 * ((b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u));
}

/// A wall of n x n unit quadrilaterals or triangle pairs, vertices moved in its plane by up to `noise`.
Scene wall(int n, bool triangles, double noise) {
    Scene scene = empty_scene();
    const auto at = [&](int i, int j) {
        const double wiggle = noise * std::sin(12.9898 * i + 78.233 * j);
        return Vec3(i + wiggle, j - wiggle, 0.0);
    };
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            if (triangles) {
                add_polygon(scene, "wall", {at(i, j), at(i + 1, j), at(i, j + 1)});
                add_polygon(scene, "wall", {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
            } else {
                add_polygon(scene, "wall", {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
            }
        }
    }
    return scene;
}

std::size_t polygons(const Scene& scene) {
    const PatchMesh mesh(scene);
    const std::size_t drawn = make_draw_list(mesh, true).polygons.size();
    CHECK(count_draw_polygons(mesh, true) == drawn);
    return drawn;
}

} // namespace

TEST_CASE("triangulate: every corner of an outline is in a triangle of positive area", "[engine]") {
    const Outline square{{0, 0, 0}, {1, 1, 0}, {2, 1, 1}, {3, 0, 1}};
    const Outline one_edge{{0, 0, 0}, {4, 0.25, 0}, {5, 0.5, 0}, {6, 0.75, 0}, {1, 1, 0}, {2, 0.5, 1}};
    const Outline all_edges{{0, 0, 0}, {4, 0.5, 0}, {1, 1, 0}, {5, 1, 0.3}, {6, 1, 0.6},
                            {2, 1, 1}, {7, 0.5, 1}, {3, 0, 1}, {8, 0, 0.5}};
    for (const Outline& outline : {square, one_edge, all_edges}) {
        const auto triangles = triangulate(outline);
        CHECK(triangles.size() == outline.size() - 2);
        double sum = 0.0;
        std::set<std::uint32_t> used;
        for (const auto& triangle : triangles) {
            CHECK(area(outline, triangle) > 0.0);
            sum += area(outline, triangle);
            used.insert(triangle.begin(), triangle.end());
        }
        CHECK(used.size() == outline.size());
        CHECK(sum == Approx(outline.size() == 6 ? 0.5 : 1.0));
    }
}

TEST_CASE("insert_touching_vertices: a vertex on an edge is inserted, near misses are not", "[engine]") {
    const std::vector<Vec3> positions{{0, 0, 0},    {4, 0, 0},    {4, 3, 0},        {0, 3, 0}, {1, 0, 0},
                                      {2, 1e-9, 0}, {3, 1e-3, 0}, {4 + 1e-3, 0, 0}, {2, -1, 0}};
    std::vector<Outline> outlines{{{0, 0, 0}, {1, 4, 0}, {2, 4, 3}, {3, 0, 3}},
                                  {{4, 0, 0}, {8, 0, 1}, {5, 1, 0}},
                                  {{6, 0, 0}, {8, 0, 1}, {7, 1, 0}}};
    insert_touching_vertices(outlines, positions, TouchingTolerance(5.0, 1e-12));
    REQUIRE(outlines[0].size() == 6);
    CHECK(outlines[0][1].vertex == 4);
    CHECK(outlines[0][1].u == Approx(1.0));
    CHECK(outlines[0][2].vertex == 5);
}

TEST_CASE("insert_touching_vertices: finds what a look at every vertex finds, crowded or spread",
          "[engine]") {
    std::mt19937 random(7);
    const auto whole = [&random](int below) {
        return static_cast<double>(random() % static_cast<unsigned>(below));
    };
    std::vector<Vec3> positions;
    for (int k = 0; k < 1500; ++k) { // many on lines with others: in a small corner, and far out
        const double scale = k % 3 == 0 ? 100.0 : 1.0;
        positions.emplace_back(scale * whole(8), scale * whole(8), scale * whole(4));
    }
    std::sort(positions.begin(), positions.end(), [](const Vec3& a, const Vec3& b) {
        return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
    });
    positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
    std::vector<Outline> outlines;
    for (int k = 0; k < 2000; ++k) {
        const auto any = [&] { return static_cast<std::uint32_t>(random() % positions.size()); };
        outlines.push_back({{any(), 0, 0}, {any(), 1, 0}, {any(), 0, 1}});
    }
    std::vector<bool> used(positions.size(), false);
    for (const Outline& outline : outlines) {
        for (const OutlinePoint& corner : outline) {
            used[corner.vertex] = true;
        }
    }
    std::vector<std::vector<std::uint32_t>> expected;
    for (const Outline& outline : outlines) {
        auto& order = expected.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3& a = positions[outline[c].vertex];
            const Vec3 along = positions[outline[(c + 1) % 3].vertex] - a;
            order.push_back(outline[c].vertex);
            std::vector<std::pair<double, std::uint32_t>> on;
            for (std::uint32_t v = 0; v < positions.size(); ++v) {
                const Vec3 offset = positions[v] - a;
                const double t = glm::dot(offset, along) / glm::dot(along, along);
                if (used[v] && glm::length(glm::cross(offset, along)) == 0.0 && t > 0.0 && t < 1.0) {
                    on.emplace_back(t, v);
                }
            }
            std::sort(on.begin(), on.end());
            for (const auto& [t, v] : on) {
                order.push_back(v);
            }
        }
    }
    insert_touching_vertices(outlines, positions, TouchingTolerance(1300.0, 1e-12));
    std::size_t inserted = 0;
    for (std::size_t k = 0; k < outlines.size(); ++k) {
        std::vector<std::uint32_t> found;
        for (const OutlinePoint& point : outlines[k]) {
            found.push_back(point.vertex);
        }
        REQUIRE(found == expected[k]);
        inserted += found.size() - 3;
    }
    CHECK(inserted > 500);
}

TEST_CASE("insert_touching_vertices: detail far smaller than the scene is left alone", "[engine]") {
    // Two slats 3 cm apart in a scene of a million metres.
    const std::vector<Vec3> positions{{0, 0, 0},      {2, 0, 0},      {2, 1, 0},
                                      {0.5, 0.03, 0}, {1.5, 0.03, 0}, {1, 0.03, 1}};
    std::vector<Outline> outlines{{{0, 0, 0}, {1, 1, 0}, {2, 1, 1}}, {{3, 0, 0}, {4, 1, 0}, {5, 1, 1}}};
    insert_touching_vertices(outlines, positions, TouchingTolerance(1e6, 1e-6));
    CHECK(outlines[0].size() == 3);
    CHECK(outlines[1].size() == 3);
}

TEST_CASE("make_draw_list: lattices merge into one polygon, every face keeps its id", "[engine]") {
    for (const bool triangles : {false, true}) {
        const PatchMesh mesh(wall(6, triangles, 0.0));
        const DrawList list = make_draw_list(mesh, true);
        REQUIRE(list.polygons.size() == 1);
        std::vector<std::uint32_t> items(list.item_of_id.begin() + 2, list.item_of_id.end());
        std::sort(items.begin(), items.end());
        REQUIRE(items.size() == mesh.size());
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            CHECK(items[i] == item_first_patch + i);
        }
        CHECK(make_draw_list(mesh, false).polygons.size() == mesh.size());
    }
}

TEST_CASE("make_draw_list: what rounding to seven digits moves still merges, a bent wall does not",
          "[engine]") {
    CHECK(polygons(wall(6, false, 1e-7)) == 1);
    CHECK(polygons(wall(6, false, 1e-3)) == 36);
}

TEST_CASE("make_draw_list: sides, subdivisions and holes are respected", "[engine]") {
    Scene two_sided = wall(4, false, 0.0);
    two_sided.surfaces[5].two_sided = true;
    CHECK(polygons(two_sided) > 1);

    Scene finer = wall(4, false, 0.0);
    finer.surfaces[5].patches = Grid{2, 2};
    CHECK(polygons(finer) > 1);

    Scene turned = wall(4, false, 0.0);
    std::reverse(turned.surfaces[5].vertices.begin(), turned.surfaces[5].vertices.end());
    CHECK(polygons(turned) > 1);

    Scene window = wall(4, false, 0.0);
    window.surfaces.erase(window.surfaces.begin() + 5);
    CHECK(polygons(window) <= 5);
}

TEST_CASE("make_draw_list: more than 65535 patches along an edge are refused, merged or not", "[engine]") {
    Scene scene = wall(1, false, 0.0);
    scene.surfaces[0].patches = Grid{65536, 1};
    CHECK_THROWS_AS(make_draw_list(PatchMesh(scene), true), InvalidArgument);
    Scene two = wall(2, false, 0.0);
    for (Surface& surface : two.surfaces) {
        surface.patches = Grid{65536, 1};
    }
    CHECK_THROWS_AS(make_draw_list(PatchMesh(two), true), InvalidArgument);
}
