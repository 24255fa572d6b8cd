#include "hemi/display/vertex_colours.hpp"

#include "support/scenes.hpp"

#include "display/display_fixtures.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>

using namespace hemi;
using hemi::test::SceneBuilder;

namespace {

std::vector<double> patch_values(const PatchMesh& mesh, const std::function<double(const Vec3&)>& field) {
    std::vector<double> values;
    for (const Vec3& centre : mesh.centres()) {
        values.push_back(field(centre));
    }
    return values;
}

double corner(const std::vector<float>& values, std::uint32_t patch, std::uint32_t k) {
    return static_cast<double>(values[patch * 4 + k]);
}

/// Value at the corner of `patch` nearest to `point`.
double corner_at(const PatchMesh& mesh, const std::vector<float>& values, std::uint32_t patch,
                 const Vec3& point) {
    const PatchCorners corners = mesh.corners(patch);
    std::uint32_t best = 0;
    for (std::uint32_t k = 1; k < corners.count; ++k) {
        if (glm::length(corners.points[k] - point) < glm::length(corners.points[best] - point)) {
            best = k;
        }
    }
    REQUIRE(glm::length(corners.points[best] - point) < 1e-9);
    return corner(values, patch, best);
}

} // namespace

TEST_CASE("CornerValues: constant radiosity is constant at every corner, to the bit", "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 3.0, 2.0, {7, 5});
    builder.floor("floor", 3.0, 0.0, 4.0, 2.0, {3, 4});
    builder.add("floor", {{0, 2, 0}, {4, 2, 0}, {1, 5, 0}}, {4, 4});
    const PatchMesh mesh = builder.mesh();
    const std::vector<float> values = corner_values(mesh, 1, std::vector<double>(mesh.size(), 0.7), {});
    REQUIRE(values.size() == std::size_t{mesh.size()} * 4);
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        for (std::uint32_t k = 0; k < mesh.corners(patch).count; ++k) {
            REQUIRE(values[patch * 4 + k] == 0.7F);
        }
    }
}

TEST_CASE("CornerValues: a linear ramp is reproduced inside a surface", "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 1.0, 1.0, {8, 8});
    const PatchMesh mesh = builder.mesh();
    const auto ramp = [](const Vec3& p) { return 2.0 + 3.0 * p.x - p.y; };
    const std::vector<float> values = corner_values(mesh, 1, patch_values(mesh, ramp), {});
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        const PatchCorners corners = mesh.corners(patch);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const Vec3& p = corners.points[k];
            if (p.x > 0.01 && p.x < 0.99 && p.y > 0.01 && p.y < 0.99) {
                CHECK(corner(values, patch, k) == Approx(ramp(p)).epsilon(1e-6));
            }
        }
    }
}

TEST_CASE("CornerValues: channels are kept apart", "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 2.0, 1.0, {2, 1});
    const PatchMesh mesh = builder.mesh();
    const std::vector<double> two{1.0, 10.0, 3.0, 30.0};
    const std::vector<float> values = corner_values(mesh, 2, two, {});
    CHECK(values[0 * 2] == 1.0F);
    CHECK(values[0 * 2 + 1] == 10.0F);
    CHECK(values[1 * 2] == 2.0F);
    CHECK(values[1 * 2 + 1] == 20.0F);
}

TEST_CASE("CornerValues: larger patches weigh more", "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 3.0, 1.0);
    builder.floor("floor", 3.0, 0.0, 4.0, 1.0);
    const PatchMesh mesh = builder.mesh();
    const std::vector<float> values = corner_values(mesh, 1, std::vector<double>{1.0, 5.0}, {});
    CHECK(corner_at(mesh, values, 0, {3, 0, 0}) == Approx((3.0 * 1.0 + 1.0 * 5.0) / 4.0));
}

TEST_CASE("CornerValues: smoothing ends at a crease, another material and another group", "[display]") {
    const double degrees = std::numbers::pi / 180.0;
    const auto folded = [&](double angle, std::uint32_t material, const std::string& group) {
        SceneBuilder builder;
        builder.floor("sheet", 0.0, 0.0, 1.0, 1.0);
        const double c = std::cos(angle * degrees);
        const double s = std::sin(angle * degrees);
        builder.add(group, {{1, 0, 0}, {1 + c, 0, s}, {1 + c, 1, s}, {1, 1, 0}}, {1, 1}, material);
        const PatchMesh mesh = builder.mesh();
        const std::vector<float> values = corner_values(mesh, 1, std::vector<double>{1.0, 3.0}, {});
        return corner_at(mesh, values, 0, {1, 0, 0});
    };
    CHECK(folded(0.0, 0, "sheet") == Approx(2.0));
    CHECK(folded(19.5, 0, "sheet") == Approx(2.0));
    CHECK(folded(20.5, 0, "sheet") == 1.0);
    CHECK(folded(90.0, 0, "sheet") == 1.0);
    CHECK(folded(0.0, 1, "sheet") == 1.0);
    CHECK(folded(0.0, 0, "other sheet") == 1.0);
}

TEST_CASE("CornerValues: light on one side of what stands on a floor does not run to the other",
          "[display]") {
    // A sheet from y = 0 to 2, in pieces of its own, on a floor that is lit beyond it.
    const bool two_sheets = GENERATE(false, true);
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 2.0, 3.0, {2, 3});
    builder.add("sheet", {{1, 0, 0}, {1, 2, 0}, {1, 2, 1}, {1, 0, 1}}, {5, 2}).two_sided = !two_sheets;
    if (two_sheets) {
        builder.add("back", {{1, 2, 0}, {1, 0, 0}, {1, 0, 1}, {1, 2, 1}}, {3, 1});
    }
    const PatchMesh mesh = builder.mesh();
    const auto values =
        corner_values(mesh, 1, patch_values(mesh, [](const Vec3& p) { return p.x > 1.0 ? 8.0 : 2.0; }), {});
    for (const double y : {0.0, 1.0}) {
        CHECK(corner_at(mesh, values, 0, {1, y, 0}) == 2.0);
        CHECK(corner_at(mesh, values, 1, {1, y, 0}) == 8.0);
    }
    CHECK(corner_at(mesh, values, 2, {1, 2, 0}) == 5.0); // light goes round its end
    CHECK(corner_at(mesh, values, 5, {1, 2, 0}) == 5.0);
    CHECK(corner_at(mesh, values, 4, {1, 3, 0}) == 5.0);
}

TEST_CASE("CornerValues: what hangs below a floor does not divide it", "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 2.0, 2.0, {2, 2});
    builder.add("sheet", {{1, 0, 0}, {1, 2, 0}, {1, 2, -1}, {1, 0, -1}}).two_sided = true;
    const PatchMesh mesh = builder.mesh();
    const auto values =
        corner_values(mesh, 1, patch_values(mesh, [](const Vec3& p) { return p.x > 1.0 ? 8.0 : 2.0; }), {});
    CHECK(corner_at(mesh, values, 0, {1, 1, 0}) == 5.0);
}

TEST_CASE("CornerValues: a vertex on the edge of a larger patch shows what that shows there", "[display]") {
    SceneBuilder builder; // a patch of 2 x 2 beside two of 1 x 1, of a surface each, as cut faces have them
    builder.floor("floor", 0.0, 0.0, 2.0, 2.0);
    builder.floor("floor", 2.0, 0.0, 3.0, 1.0);
    builder.floor("floor", 2.0, 1.0, 3.0, 2.0);
    const PatchMesh mesh = builder.mesh();
    const auto values = corner_values(mesh, 1, std::vector<double>{1.0, 3.0, 9.0}, {});
    const double low = corner_at(mesh, values, 0, {2, 0, 0});
    const double high = corner_at(mesh, values, 0, {2, 2, 0});
    CHECK(low == Approx((4.0 * 1.0 + 3.0) / 5.0));
    CHECK(high == Approx((4.0 * 1.0 + 9.0) / 5.0));
    CHECK(corner_at(mesh, values, 1, {2, 1, 0}) == Approx(0.5 * (low + high)));
    CHECK(corner_at(mesh, values, 2, {2, 1, 0}) == Approx(0.5 * (low + high)));
}

TEST_CASE("CornerValues: the two sides of a sheet do not mix", "[display]") {
    SceneBuilder builder;
    builder.floor("sheet", 0.0, 0.0, 1.0, 1.0, {2, 2}).two_sided = true;
    const PatchMesh mesh = builder.mesh();
    std::vector<double> sides(8, 1.0);
    std::fill(sides.begin() + 4, sides.end(), 9.0);
    const std::vector<float> values = corner_values(mesh, 1, sides, {});
    CHECK(*std::max_element(values.begin(), values.begin() + 16) == 1.0F);
    CHECK(*std::min_element(values.begin() + 16, values.end()) == 9.0F);
}

TEST_CASE("CornerValues: a patch that is touched in the middle of its edge joins in: no step along it",
          "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 2.0, 1.0);         // one long patch
    builder.floor("floor", 0.0, 1.0, 2.0, 2.0, {2, 1}); // two that meet at (1, 1), in the middle of its edge
    const PatchMesh mesh = builder.mesh();
    const std::vector<float> values = corner_values(mesh, 1, std::vector<double>{8.0, 1.0, 3.0}, {});
    // Halfway between what the long patch shows at its corners.
    const double expected = 0.5 * ((2.0 * 8.0 + 1.0) / 3.0 + (2.0 * 8.0 + 3.0) / 3.0);
    CHECK(corner_at(mesh, values, 0, {0, 1, 0}) == Approx((2.0 * 8.0 + 1.0) / 3.0));
    CHECK(corner_at(mesh, values, 1, {1, 1, 0}) == Approx(expected));
    CHECK(corner_at(mesh, values, 2, {1, 1, 0}) == Approx(expected));
    // Where nothing is touched, nothing changes.
    CHECK(corner_at(mesh, values, 1, {0, 2, 0}) == 1.0);
    CHECK(corner_at(mesh, values, 0, {0, 0, 0}) == 8.0);
}

TEST_CASE("CornerValues: T-junctions are found on slanted edges far from the origin", "[display]") {
    SceneBuilder builder;
    const Vec3 origin(1e5, -2e5, 3e4);
    const Vec3 u(2.0, 1.0, 0.5);
    const Vec3 v(-0.3, 0.9, 0.4);
    builder.add("g", {origin, origin + u, origin + u + v, origin + v});
    builder.add("g", {origin + v, origin + u + v, origin + u + 2.0 * v, origin + 2.0 * v}, {3, 1});
    const PatchMesh mesh = builder.mesh();
    const std::vector<float> values = corner_values(mesh, 1, std::vector<double>{6.0, 0.0, 0.0, 0.0}, {});
    // Areas 3 : 1 at the ends of the large patch's edge, on which the small ones meet in two points.
    CHECK(corner(values, 1, 1) == Approx(6.0 * 3.0 / 4.0).epsilon(1e-6));
    CHECK(corner(values, 2, 1) == Approx(6.0 * 3.0 / 4.0).epsilon(1e-6));
}

TEST_CASE("CornerValues: covered patches never enter", "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 8.0, 8.0, {8, 8});
    const PatchMesh mesh = builder.mesh();
    std::vector<double> radiosity(mesh.size(), 5.0);
    std::vector<double> blocked(mesh.size(), 0.0);
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        const Vec3& centre = mesh.centres()[patch];
        if (centre.x > 2.0 && centre.x < 7.0 && centre.y > 2.0 && centre.y < 7.0) {
            radiosity[patch] = 0.0;
            blocked[patch] = 1.0;
        }
    }
    // 5 x 5 patches under a block: no black rim, and none of them black inside either.
    const std::vector<float> values = corner_values(mesh, 1, radiosity, blocked);
    CHECK(*std::min_element(values.begin(), values.end()) == 5.0F);

    SECTION("what is half in view counts in full") {
        blocked.assign(mesh.size(), 0.5);
        const std::vector<float> open = corner_values(mesh, 1, radiosity, blocked);
        CHECK(*std::min_element(open.begin(), open.end()) == 0.0F);
    }
    SECTION("flooding does not cross a crease") {
        SceneBuilder two;
        two.floor("floor", 0.0, 0.0, 1.0, 1.0);
        two.add("floor", {{1, 0, 0}, {1, 0, 1}, {1, 1, 1}, {1, 1, 0}});
        const PatchMesh folded = two.mesh();
        const std::vector<float> own =
            corner_values(folded, 1, std::vector<double>{5.0, 2.0}, std::vector<double>{0.0, 1.0});
        CHECK(corner_at(folded, own, 1, {1, 0, 0}) == 2.0); // covered altogether: it keeps its own
    }
}

TEST_CASE("CornerValues: flooding carries values outwards ring by ring", "[display]") {
    SceneBuilder builder;
    builder.floor("strip", 0.0, 0.0, 6.0, 1.0, {6, 1});
    const PatchMesh mesh = builder.mesh();
    const std::vector<double> radiosity{1.0, 0.0, 0.0, 0.0, 0.0, 3.0};
    const std::vector<double> blocked{0.0, 1.0, 1.0, 1.0, 1.0, 0.0};
    const std::vector<float> values = corner_values(mesh, 1, radiosity, blocked);
    CHECK(corner_at(mesh, values, 1, {1, 0, 0}) == 1.0);
    CHECK(corner_at(mesh, values, 1, {2, 0, 0}) == 1.0);
    CHECK(corner_at(mesh, values, 2, {3, 0, 0}) == 2.0); // both ends arrive at once
    CHECK(corner_at(mesh, values, 4, {4, 0, 0}) == 3.0);
}

TEST_CASE("CornerValues: the same input gives the same bits", "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 1.0, 1.0, {13, 11});
    builder.floor("floor", 0.0, 1.0, 1.0, 2.0, {5, 7});
    const PatchMesh mesh = builder.mesh();
    const auto field = [](const Vec3& p) { return std::sin(5.0 * p.x) + std::cos(3.0 * p.y) + 2.0; };
    const std::vector<double> radiosity = patch_values(mesh, field);
    CHECK(corner_values(mesh, 1, radiosity, {}) == corner_values(mesh, 1, radiosity, {}));
}

TEST_CASE("CornerValues: scale and place of the scene do not matter", "[display]") {
    const auto values_at = [](double scale, const Vec3& shift) {
        SceneBuilder builder;
        const auto at = [&](double x, double y) { return shift + scale * Vec3(x, y, 0.0); };
        builder.add("g", {at(0, 0), at(1, 0), at(1, 1), at(0, 1)}, {4, 3});
        builder.add("g", {at(1, 0), at(2, 0), at(2, 1), at(1, 1)}, {2, 5});
        const PatchMesh mesh = builder.mesh();
        std::vector<double> radiosity;
        for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
            radiosity.push_back(1.0 + patch % 7);
        }
        return corner_values(mesh, 1, radiosity, {});
    };
    const std::vector<float> reference = values_at(1.0, Vec3(0.0));
    for (const auto& other :
         {values_at(1e-6, Vec3(0.0)), values_at(1e6, Vec3(0.0)), values_at(1.0, Vec3(1e5))}) {
        REQUIRE(other.size() == reference.size());
        for (std::size_t i = 0; i < other.size(); ++i) {
            REQUIRE(other[i] == Approx(reference[i]).epsilon(1e-6));
        }
    }
}

TEST_CASE("CornerValues: sizes that do not match are refused", "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 1.0, 1.0, {2, 2});
    const PatchMesh mesh = builder.mesh();
    CHECK_THROWS_AS(corner_values(mesh, 1, std::vector<double>(3, 1.0), {}), InvalidArgument);
    CHECK_THROWS_AS(corner_values(mesh, 0, std::vector<double>{}, {}), InvalidArgument);
    CHECK_THROWS_AS(corner_values(mesh, 1, std::vector<double>(4, 1.0), std::vector<double>(3, 0.0)),
                    InvalidArgument);
}

TEST_CASE("CornerValues: a hundred thousand loose triangles take seconds at most", "[display]") {
    SceneBuilder builder;
    const auto at = [](int x, int y) { return Vec3(x, y, 3.0 * std::sin(0.1 * x) * std::cos(0.13 * y)); };
    for (int y = 0; y < 224; ++y) {
        for (int x = 0; x < 224; ++x) {
            builder.add("hill", {at(x, y), at(x + 1, y), at(x + 1, y + 1)});
            builder.add("hill", {at(x, y), at(x + 1, y + 1), at(x, y + 1)});
        }
    }
    const PatchMesh mesh = builder.mesh();
    REQUIRE(mesh.size() > 100000);
    const auto begin = std::chrono::steady_clock::now();
    const std::vector<float> values = corner_values(mesh, 1, std::vector<double>(mesh.size(), 1.0), {});
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    CHECK(values[0] == 1.0F);
    CHECK(seconds.count() < 10.0); // 0.2 s on an idle core; sanitizers and a busy machine need room
}

TEST_CASE("corner values: between patches of different sizes there is no step", "[display]") {
    Scene scene = test::empty_scene();
    test::add_polygon(scene, "floor", {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {4, 4});
    const PatchMesh coarse(scene);
    const PatchMesh once = coarse.split(std::vector<std::uint32_t>{5, 6}, Cut::in_four).mesh;
    std::vector<std::uint32_t> again;
    for (std::uint32_t i = 0; i < once.size(); ++i) {
        if (once.areas()[i] < 0.3 && once.centres()[i].x < 1.5) {
            again.push_back(i); // two of the four parts of one
        }
    }
    const PatchMesh mesh = once.split(again, Cut::in_four).mesh;
    std::vector<double> values;
    for (const Vec3& centre : mesh.centres()) {
        values.push_back(std::sin(3.0 * centre.x) * std::cos(2.0 * centre.y));
    }
    const std::vector<float> corners = corner_values(mesh, 1, values, {});
    // What a patch shows at a point of its rim, between the ends of an edge.
    std::uint32_t on_edges = 0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchCorners larger = mesh.corners(i);
        for (std::uint32_t e = 0; e < 4; ++e) {
            const Vec3 from = larger.points[e];
            const Vec3 edge = larger.points[(e + 1) % 4] - from;
            for (std::uint32_t j = 0; j < mesh.size(); ++j) {
                for (std::uint32_t k = 0; k < 4; ++k) {
                    const Vec3 way = mesh.corners(j).points[k] - from;
                    const double t = glm::dot(way, edge) / glm::dot(edge, edge);
                    if (glm::length(way - t * edge) > 1e-9 || t < 1e-9 || t > 1.0 - 1e-9) {
                        continue;
                    }
                    ++on_edges;
                    const auto at = [&](std::uint32_t patch, std::uint32_t corner) {
                        return static_cast<double>(corners[std::size_t{patch} * 4 + corner]);
                    };
                    REQUIRE(at(j, k) == Approx((1.0 - t) * at(i, e) + t * at(i, (e + 1) % 4)).margin(1e-6));
                }
            }
        }
    }
    CHECK(on_edges > 20);
}
