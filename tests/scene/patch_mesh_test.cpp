#include "hemi/scene/patch_mesh.hpp"

#include "hemi/core/error.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

using namespace hemi;
using namespace hemi::test;
using Catch::Matchers::Contains;

namespace {

bool near(const Vec3& a, const Vec3& b, double margin) {
    return glm::length(a - b) <= margin;
}

/// Rectangle in the plane z = `z`, from the origin.
std::vector<Vec3> rectangle(double width, double height, double z = 0.0) {
    return {Vec3(0, 0, z), Vec3(width, 0, z), Vec3(width, height, z), Vec3(0, height, z)};
}

Scene one_polygon(const std::vector<Vec3>& polygon, std::optional<Grid> patches = {}) {
    Scene scene = empty_scene();
    add_polygon(scene, "a", polygon);
    scene.surfaces[0].patches = patches;
    return scene;
}

const std::vector<Vec3> triangle{Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 6, 0)};

/// Scenes of every kind of surface: rectangles, trapezia, triangles, two-sided sheets.
std::vector<Scene> various_scenes() {
    Scene mixed = empty_scene();
    add_polygon(mixed, "t", triangle, {7, 7});
    add_polygon(mixed, "q", {Vec3(0, 0, 1), Vec3(2, 0, 1.4), Vec3(1.5, 1, 1.5), Vec3(0.5, 1, 1.3)}, {5, 3});
    mixed.surfaces[0].two_sided = true;
    mixed.surfaces[1].two_sided = true;
    // Planar again: the fourth corner of that quadrilateral was chosen by eye.
    auto& v = mixed.surfaces[1].vertices;
    const Vec3 normal = glm::normalize(glm::cross(v[1] - v[0], v[2] - v[0]));
    v[3] -= glm::dot(v[3] - v[0], normal) * normal;
    return {room_with_blocks(6), tapered_box(5),     lattice_room(),         mixed,
            scaled(mixed, 1e-6), scaled(mixed, 1e6), rotated(tapered_box(4))};
}

double polygon_area(const Surface& surface) {
    return glm::length(area_vector(surface.polygon()));
}

bool same_bits(const Vec3& a, const Vec3& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

std::uint64_t hash_of(const Scene& scene, const Subdivision& subdivision = {}) {
    return PatchMesh(scene, subdivision).geometry_hash();
}

} // namespace

TEST_CASE("PatchMesh: surfaces come as listed and patches of a surface row by row with u fastest",
          "[scene]") {
    Scene scene = empty_scene();
    add_polygon(scene, "b", rectangle(3, 2), {3, 2});
    add_polygon(scene, "a", rectangle(1, 4, 5), {1, 4});
    const PatchMesh mesh(scene);
    REQUIRE(mesh.size() == 10);
    CHECK(mesh.first_patch(0) == 0);
    CHECK(mesh.first_patch(1) == 6);
    CHECK(mesh.first_patch(2) == 10);
    CHECK(mesh.groups() == std::vector<std::string>{"b", "a"});
    for (std::uint32_t i = 0; i < 6; ++i) {
        INFO("patch " << i);
        CHECK(mesh.surface_of()[i] == 0);
        CHECK(mesh.group(i) == 0);
        CHECK(near(mesh.centres()[i], Vec3(0.5 + i % 3, 0.5 + i / 3, 0), 1e-15));
        CHECK(mesh.grid_coordinates(i) == std::array<double, 2>{0.5 + i % 3, 0.5 + i / 3});
    }
    for (std::uint32_t i = 0; i < 4; ++i) {
        CHECK(mesh.surface_of()[6 + i] == 1);
        CHECK(mesh.group(6 + i) == 1);
        CHECK(near(mesh.centres()[6 + i], Vec3(0.5, 0.5 + i, 5), 1e-15));
    }
}

TEST_CASE("PatchMesh: a triangle goes strip by strip with upright and inverted triangles in turn",
          "[scene]") {
    const PatchMesh mesh(one_polygon(triangle, Grid{3, 3}));
    REQUIRE(mesh.size() == 9);
    const double a = 1.0 / 3.0;
    const double b = 2.0 / 3.0;
    const std::vector<std::array<double, 2>> expected{{a, a},     {b, b},     {1 + a, a},     {1 + b, b},
                                                      {2 + a, a}, // strip along vertex 0 -> vertex 1
                                                      {a, 1 + a}, {b, 1 + b}, {1 + a, 1 + a}, {a, 2 + a}};
    for (std::uint32_t i = 0; i < 9; ++i) {
        INFO("patch " << i);
        CHECK(mesh.grid_coordinates(i)[0] == Approx(expected[i][0]));
        CHECK(mesh.grid_coordinates(i)[1] == Approx(expected[i][1]));
        // Edge 3 along x and 6 along y in three parts.
        CHECK(near(mesh.centres()[i], Vec3(expected[i][0], 2.0 * expected[i][1], 0), 1e-14));
        CHECK(mesh.areas()[i] == Approx(1.0));
    }
}

TEST_CASE("PatchMesh: the order within a triangle holds for every subdivision up to a thousand", "[scene]") {
    for (const std::uint32_t n : {1u, 2u, 3u, 4u, 5u, 17u, 64u, 255u, 1000u}) {
        const PatchMesh mesh(one_polygon(triangle, Grid{n, n}));
        REQUIRE(mesh.size() == n * n);
        std::uint32_t patch = 0;
        bool right = true;
        for (std::uint32_t strip = 0; strip < n; ++strip) {
            for (std::uint32_t k = 0; k < 2 * (n - strip) - 1; ++k, ++patch) {
                const double third = k % 2 == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
                const auto at = mesh.grid_coordinates(patch);
                right = right && at[0] == k / 2 + third && at[1] == strip + third;
            }
        }
        INFO("n " << n);
        CHECK(right);
    }
}

TEST_CASE("PatchMesh: back patches of a two-sided surface follow its front patches", "[scene]") {
    for (const auto& polygon : {triangle, rectangle(2, 1)}) {
        Scene scene = one_polygon(polygon, Grid{3, 3});
        scene.surfaces[0].two_sided = true;
        add_polygon(scene, "next", rectangle(1, 1, 1));
        const PatchMesh mesh(scene);
        REQUIRE(mesh.size() == 19);
        CHECK(mesh.patches_per_side(0) == 9);
        CHECK(mesh.first_patch(1) == 18);
        CHECK(mesh.group(17) == 0);
        for (std::uint32_t i = 0; i < 9; ++i) {
            const std::uint32_t back = 9 + i;
            CHECK_FALSE(mesh.is_back(i));
            CHECK(mesh.is_back(back));
            CHECK(mesh.normal(back) == -mesh.normal(i));
            CHECK(mesh.areas()[back] == mesh.areas()[i]);
            CHECK(mesh.centres()[back] == mesh.centres()[i]);
            CHECK(mesh.grid_coordinates(back) == mesh.grid_coordinates(i));
            CHECK(area_vector(mesh.corners(back).polygon()) == -area_vector(mesh.corners(i).polygon()));
        }
        CHECK_FALSE(mesh.is_back(18));
    }
}

TEST_CASE("PatchMesh: areas of the patches add up to the polygon's area", "[scene]") {
    for (const Scene& scene : various_scenes()) {
        const PatchMesh mesh(scene);
        for (std::uint32_t s = 0; s < mesh.surfaces().size(); ++s) {
            const auto first = mesh.areas().begin() + mesh.first_patch(s);
            const double sum = std::accumulate(first, first + mesh.patches_per_side(s), 0.0);
            INFO("surface " << s);
            CHECK(sum == Approx(polygon_area(mesh.surfaces()[s])).epsilon(1e-12).margin(0));
        }
    }
}

TEST_CASE("PatchMesh: patches of a parallelogram and of a triangle are of equal area", "[scene]") {
    for (const auto& polygon :
         {triangle, std::vector<Vec3>{Vec3(0, 0, 0), Vec3(2, 0, 1), Vec3(3, 1, 1.5), Vec3(1, 1, 0.5)}}) {
        const PatchMesh mesh(one_polygon(polygon, Grid{6, 6}));
        const double each = polygon_area(mesh.surfaces()[0]) / 36.0;
        for (const double area : mesh.areas()) {
            REQUIRE(area == Approx(each).epsilon(1e-12));
        }
    }
}

TEST_CASE("PatchMesh: corners run counter-clockwise about the normal and hold the centre", "[scene]") {
    for (const Scene& scene : various_scenes()) {
        const PatchMesh mesh(scene);
        bool orientation = true;
        bool inside = true;
        bool consistent = true;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const PatchCorners corners = mesh.corners(i);
            const auto polygon = corners.polygon();
            const Vec3 normal = mesh.normal(i);
            const double size = std::sqrt(mesh.areas()[i]);
            orientation = orientation && std::abs(glm::length(normal) - 1.0) < 1e-14 &&
                          near(area_vector(polygon) / mesh.areas()[i], normal, 1e-6);
            for (std::size_t c = 0; c < polygon.size(); ++c) {
                const Vec3 edge = polygon[(c + 1) % polygon.size()] - polygon[c];
                const Vec3 offset = mesh.centres()[i] - polygon[c];
                inside = inside && glm::dot(glm::cross(edge, offset), normal) > 0.0 &&
                         std::abs(glm::dot(offset, normal)) < 1e-9 * size;
            }
            consistent = consistent && corners.count == mesh.surfaces()[mesh.surface_of()[i]].vertex_count &&
                         near(mesh.centres()[i], area_centroid(polygon), 1e-12 * size);
        }
        CHECK(orientation);
        CHECK(inside);
        CHECK(consistent);
    }
}

TEST_CASE("PatchMesh: neighbours on a quadrilateral share the bits of their corners", "[scene]") {
    for (const std::uint32_t n : {1u, 2u, 7u, 30u}) {
        Scene scene = rotated(tapered_box(n));
        scene.surfaces[1].two_sided = true;
        const PatchMesh mesh(scene);
        bool shared = true;
        for (std::uint32_t s = 0; s < mesh.surfaces().size(); ++s) {
            const Grid grid = mesh.grid(s);
            const auto at = [&](std::uint32_t u, std::uint32_t v) {
                return mesh.corners(mesh.first_patch(s) + v * grid.u + u).points;
            };
            for (std::uint32_t v = 0; v < grid.v; ++v) {
                for (std::uint32_t u = 0; u < grid.u; ++u) {
                    const auto here = at(u, v);
                    if (u + 1 < grid.u) {
                        const auto right = at(u + 1, v);
                        shared = shared && same_bits(here[1], right[0]) && same_bits(here[2], right[3]);
                    }
                    if (v + 1 < grid.v) {
                        const auto above = at(u, v + 1);
                        shared = shared && same_bits(here[3], above[0]) && same_bits(here[2], above[1]);
                    }
                }
            }
            const auto& vertices = mesh.surfaces()[s].vertices;
            shared = shared && same_bits(at(0, 0)[0], vertices[0]) &&
                     same_bits(at(grid.u - 1, 0)[1], vertices[1]) &&
                     same_bits(at(grid.u - 1, grid.v - 1)[2], vertices[2]) &&
                     same_bits(at(0, grid.v - 1)[3], vertices[3]);
        }
        INFO("n " << n);
        CHECK(shared);
    }
}

TEST_CASE("PatchMesh: corners within a triangle are as few as its grid points", "[scene]") {
    for (const std::uint32_t n : {1u, 2u, 9u, 31u}) {
        Scene scene = rotated(one_polygon(triangle, Grid{n, n}));
        const PatchMesh mesh(scene);
        std::vector<std::array<double, 3>> points;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const PatchCorners corners = mesh.corners(i);
            for (const Vec3& point : corners.polygon()) {
                points.push_back({point.x, point.y, point.z});
            }
        }
        std::sort(points.begin(), points.end());
        points.erase(std::unique(points.begin(), points.end()), points.end());
        CHECK(points.size() == (n + 1) * (n + 2) / 2);
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3& vertex = mesh.surfaces()[0].vertices[c];
            CHECK(std::binary_search(points.begin(), points.end(),
                                     std::array<double, 3>{vertex.x, vertex.y, vertex.z}));
        }
    }
}

TEST_CASE("PatchMesh: patches per face are the smallest square that holds them", "[scene]") {
    struct Case {
        std::uint32_t asked;
        std::uint32_t k;
    };
    for (const Case& c : {Case{0, 1}, Case{1, 1}, Case{2, 2}, Case{4, 2}, Case{5, 3}, Case{9, 3}, Case{10, 4},
                          Case{99, 10}, Case{100, 10}, Case{101, 11}, Case{256, 16}, Case{257, 17}}) {
        INFO("asked for " << c.asked);
        CHECK(PatchMesh(one_polygon(rectangle(2, 1)), {.patch_size = {}, .patches_per_face = c.asked})
                  .grid(0) == Grid{c.k, c.k});
        CHECK(PatchMesh(one_polygon(triangle), {.patch_size = {}, .patches_per_face = c.asked}).size() ==
              c.k * c.k);
    }
}

TEST_CASE("PatchMesh: an edge of exactly n patch sizes is cut n ways", "[scene]") {
    for (const double size : {0.1, 0.3, 1.0 / 3.0, 0.7, 1e-7, 12345.678}) {
        for (std::uint32_t n = 1; n <= 1000; n += 37) {
            INFO("size " << size << " n " << n);
            const Scene exact = one_polygon(rectangle(n * size, size));
            CHECK(PatchMesh(exact, {.patch_size = size, .patches_per_face = {}}).grid(0) == Grid{n, 1});
            // The same length, found by adding it up.
            double sum = 0.0;
            for (std::uint32_t k = 0; k < n; ++k) {
                sum += size;
            }
            CHECK(PatchMesh(one_polygon(rectangle(sum, size)), {.patch_size = size, .patches_per_face = {}})
                      .grid(0) == Grid{n, 1});
            const Scene longer = one_polygon(rectangle((n + 1e-3) * size, size));
            CHECK(PatchMesh(longer, {.patch_size = size, .patches_per_face = {}}).grid(0) == Grid{n + 1, 1});
        }
    }
}

TEST_CASE("PatchMesh: no patch edge is longer than the patch size", "[scene]") {
    for (const Scene& original :
         {room_with_blocks(1), tapered_box(1), one_polygon(triangle), lattice_room()}) {
        for (const double size : {0.031, 0.2, 0.5, 100.0}) {
            const PatchMesh mesh(original, {.patch_size = size, .patches_per_face = {}});
            double longest = 0.0;
            for (std::uint32_t i = 0; i < mesh.size(); ++i) {
                const PatchCorners corners = mesh.corners(i);
                const auto polygon = corners.polygon();
                for (std::size_t c = 0; c < polygon.size(); ++c) {
                    longest = std::max(longest, glm::length(polygon[(c + 1) % polygon.size()] - polygon[c]));
                }
            }
            INFO("size " << size);
            CHECK(longest <= size * (1.0 + 1e-8));
        }
    }
}

TEST_CASE("PatchMesh: the patch size counts along the longer of two opposite edges", "[scene]") {
    const std::vector<Vec3> trapezium{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(3, 1, 0), Vec3(1, 1, 0)};
    CHECK(PatchMesh(one_polygon(trapezium), {.patch_size = 1.0, .patches_per_face = {}}).grid(0) ==
          Grid{4, 2});
    CHECK(PatchMesh(one_polygon(triangle), {.patch_size = 1.0, .patches_per_face = {}}).grid(0) ==
          Grid{7, 7}); // edges 3, 6 and √45
}

TEST_CASE("PatchMesh: options beat a surface's own grid and that beats the scene's patch size", "[scene]") {
    Scene scene = one_polygon(rectangle(6, 3));
    CHECK(PatchMesh(scene).grid(0) == Grid{1, 1});
    scene.patch_size = 1.0;
    CHECK(PatchMesh(scene).grid(0) == Grid{6, 3});
    scene.surfaces[0].patches = Grid{5, 4};
    CHECK(PatchMesh(scene).grid(0) == Grid{5, 4});
    CHECK(PatchMesh(scene, {.patch_size = {}, .patches_per_face = 4}).grid(0) == Grid{2, 2});
    CHECK(PatchMesh(scene, {.patch_size = 1.5, .patches_per_face = {}}).grid(0) == Grid{4, 2});
}

TEST_CASE("PatchMesh: refuses patch sizes that are no length and cuts beyond a million", "[scene]") {
    const Scene scene = one_polygon(rectangle(1, 1));
    for (const double size :
         {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        INFO("size " << size);
        CHECK_THROWS_AS(PatchMesh(scene, {.patch_size = size, .patches_per_face = {}}), InvalidArgument);
    }
    CHECK_THROWS_WITH(PatchMesh(scene, {.patch_size = 1e-9, .patches_per_face = {}}),
                      Contains("1e-09") && Contains("at most 1e6"));
    CHECK_THROWS_AS(PatchMesh(scene, {.patch_size = 5e-324, .patches_per_face = {}}), InvalidArgument);
}

TEST_CASE("PatchMesh: refuses as many patches as an index cannot hold before it makes any", "[scene]") {
    const Scene plain = one_polygon(rectangle(1, 1));
    CHECK_THROWS_WITH(PatchMesh(plain, {.patch_size = {}, .patches_per_face = 0xFFFFFFFFu}),
                      Contains("2147483648") && Contains("larger patches"));
    CHECK_THROWS_AS(PatchMesh(plain, {.patch_size = 2e-6, .patches_per_face = {}}), InvalidArgument);
    CHECK_THROWS_AS(PatchMesh(one_polygon(rectangle(1, 1), Grid{65536, 32768})), InvalidArgument);
    CHECK_THROWS_AS(PatchMesh(one_polygon(rectangle(1, 1), Grid{0xFFFFFFFFu, 0xFFFFFFFFu})), InvalidArgument);
    Scene sheet = one_polygon(rectangle(1, 1), Grid{32768, 32768});
    sheet.surfaces[0].two_sided = true;
    CHECK_THROWS_AS(PatchMesh(sheet), InvalidArgument);
}

TEST_CASE("PatchMesh: refuses a scene that is not sound", "[scene]") {
    CHECK_THROWS_AS(PatchMesh(empty_scene()), InputError);
    Scene scene = one_polygon(rectangle(1, 1));
    scene.surfaces[0].vertices[2].z = 1.0;
    CHECK_THROWS_WITH(PatchMesh(scene), Contains("surface 0 (group \"a\")"));
}

TEST_CASE("PatchMesh: tiny and huge and distant scenes are the same but for scale and place", "[scene]") {
    const PatchMesh mesh(tapered_box(4));
    for (const double factor : {1e-6, 1e6}) {
        const PatchMesh other(scaled(tapered_box(4), factor));
        REQUIRE(other.size() == mesh.size());
        bool same = true;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            same = same && near(other.centres()[i], factor * mesh.centres()[i], 1e-14 * factor) &&
                   std::abs(other.areas()[i] / mesh.areas()[i] / (factor * factor) - 1.0) < 1e-12 &&
                   near(other.normal(i), mesh.normal(i), 1e-14);
        }
        INFO("factor " << factor);
        CHECK(same);
        CHECK(other.bounds().diagonal() ==
              Approx(factor * mesh.bounds().diagonal()).epsilon(1e-14).margin(0));
    }
    const Vec3 by(1e5, -1e5, 1e5);
    const PatchMesh far(moved(tapered_box(4), by));
    bool same = true;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        // Coordinates there are rounded to 1.5e-11.
        same = same && near(far.centres()[i], mesh.centres()[i] + by, 1e-10) &&
               std::abs(far.areas()[i] / mesh.areas()[i] - 1.0) < 1e-8 &&
               near(far.normal(i), mesh.normal(i), 1e-9);
    }
    CHECK(same);
}

TEST_CASE("PatchMesh: the geometry hash depends on corners and subdivision and sidedness", "[scene]") {
    const Scene scene = room_with_blocks(4);
    const std::uint64_t hash = hash_of(scene);
    CHECK(hash_of(scene) == hash);
    const auto changed = [&](auto&& change) {
        Scene other = scene;
        change(other);
        return hash_of(other) != hash;
    };
    CHECK(changed(
        [](Scene& s) { s.surfaces[3].vertices[2].x = std::nextafter(s.surfaces[3].vertices[2].x, 9.0); }));
    CHECK(changed([](Scene& s) { s.surfaces[3].patches = Grid{4, 5}; }));
    CHECK(changed([](Scene& s) { s.surfaces[3].two_sided = true; }));
    CHECK(changed([](Scene& s) { s.surfaces.pop_back(); }));
    CHECK(changed([](Scene& s) { std::swap(s.surfaces[0], s.surfaces[1]); }));
    CHECK(changed([](Scene& s) {
        auto& v = s.surfaces[0].vertices;
        std::rotate(v.begin(), v.begin() + 1, v.end());
    }));
    CHECK(changed([](Scene& s) { s.surfaces[0].vertex_count = 3; }));
    CHECK(hash_of(scene, {.patch_size = {}, .patches_per_face = 4}) != hash);
    // Grids of equal size that are not the same.
    CHECK(hash_of(one_polygon(rectangle(1, 1), Grid{2, 8})) !=
          hash_of(one_polygon(rectangle(1, 1), Grid{8, 2})));
}

TEST_CASE("PatchMesh: the geometry hash depends on nothing else", "[scene]") {
    const Scene scene = room_with_blocks(4);
    const std::uint64_t hash = hash_of(scene);
    Scene other = scene;
    other.name = "another";
    other.channels = {"red", "green", "blue"};
    other.materials = {{"black", {0, 0, 0}, {1, 2, 3}}, {"white", {0.9, 0.9, 0.9}, {0, 0, 0}}};
    other.surfaces[2].material = 1;
    other.groups.push_back("new");
    other.surfaces[2].group = static_cast<std::uint32_t>(other.groups.size() - 1);
    other.enclosure = Enclosure::open;
    other.environment = {1, 1, 1};
    other.camera = Camera{};
    CHECK(hash_of(other) == hash);
    // The same grid asked for in other words, and another zero.
    CHECK(hash_of(one_polygon(rectangle(1, 1), Grid{4, 4})) ==
          hash_of(one_polygon(rectangle(1, 1)), {.patch_size = 0.25, .patches_per_face = {}}));
    auto negative = rectangle(1, 1);
    negative[0].z = -0.0;
    CHECK(hash_of(one_polygon(negative)) == hash_of(one_polygon(rectangle(1, 1))));
    // What lies in the unused corner of a triangle.
    Scene unused = one_polygon(triangle);
    unused.surfaces[0].vertices[3] = Vec3(7.0);
    CHECK(hash_of(unused) == hash_of(one_polygon(triangle)));
}

TEST_CASE("PatchMesh: the geometry hash stays what stored files hold", "[scene]") {
    // FNV-1a over 1 surface, 4 corners and one side, grid 2 x 3, and the twelve coordinates.
    std::uint64_t expected = 0xCBF29CE484222325u;
    const auto add = [&](std::uint64_t value) {
        for (int byte = 0; byte < 8; ++byte) {
            expected = (expected ^ ((value >> (8 * byte)) & 0xFFu)) * 0x100000001B3u;
        }
    };
    constexpr std::uint64_t one = 0x3FF0000000000000u; // 1.0
    for (const std::uint64_t value : {std::uint64_t{1}, std::uint64_t{8}, (std::uint64_t{2} << 32) | 3}) {
        add(value);
    }
    for (const std::uint64_t value :
         {std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{0}, one, std::uint64_t{0}, std::uint64_t{0}, one,
          one, std::uint64_t{0}, std::uint64_t{0}, one, std::uint64_t{0}}) {
        add(value);
    }
    CHECK(hash_of(one_polygon(rectangle(1, 1), Grid{2, 3})) == expected);
}

TEST_CASE("emissivities: 1 less the mean reflectance over the channels, for every patch", "[scene]") {
    Scene scene = one_polygon(rectangle(1, 1), Grid{1, 2});
    add_polygon(scene, "b", rectangle(1, 1, 2.0));
    scene.channels = {"red", "green"};
    scene.materials = {{"grey", {0.25, 0.75}, {0, 0}}, {"black", {0, 0}, {1, 1}}};
    scene.environment = {0, 0};
    scene.surfaces[0].material = 0;
    scene.surfaces[1].material = 1;
    const PatchMesh mesh(scene);
    REQUIRE(mesh.size() == 3);
    CHECK(emissivities(mesh, scene.materials) == std::vector<double>{0.5, 0.5, 1.0});
}

namespace {

/// Every third patch, and the last.
std::vector<std::uint32_t> some_patches(const PatchMesh& mesh) {
    std::vector<std::uint32_t> patches;
    for (std::uint32_t i = 0; i < mesh.size(); i += 3) {
        patches.push_back(i);
    }
    patches.push_back(mesh.size() - 1);
    return patches;
}

} // namespace

TEST_CASE("PatchMesh::split: parts fill their patches, on both sides alike", "[scene]") {
    for (const Scene& scene : various_scenes()) {
        const PatchMesh coarse(scene);
        const std::vector<std::uint32_t> wanted = some_patches(coarse);
        const auto [fine, parents] = coarse.split(wanted);
        // Again, so that three sizes meet.
        const auto [finer, between] = fine.split(some_patches(fine));
        std::vector<double> areas(coarse.size(), 0.0);
        REQUIRE(between.size() == finer.size());
        REQUIRE(finer.surface_of().size() == finer.size());
        for (std::uint32_t k = 0; k < finer.size(); ++k) {
            const std::uint32_t i = parents[between[k]];
            REQUIRE(finer.surface_of()[k] == coarse.surface_of()[i]);
            REQUIRE(finer.is_back(k) == coarse.is_back(i));
            areas[i] += finer.areas()[k];
            // Its corners are where the patch is.
            const PatchCorners outer = coarse.corners(i);
            const PatchCorners inner = finer.corners(k);
            for (const Vec3& point : inner.polygon()) {
                for (std::uint32_t c = 0; c < outer.count; ++c) {
                    const Vec3 edge = outer.points[(c + 1) % outer.count] - outer.points[c];
                    const double inside =
                        glm::dot(glm::cross(edge, point - outer.points[c]), coarse.normal(i));
                    REQUIRE(inside >= -1e-12 * glm::dot(edge, edge));
                }
            }
            const auto coarse_at = coarse.grid_coordinates(i);
            const auto at = finer.grid_coordinates(k);
            const Grid was = coarse.grid(coarse.surface_of()[i]);
            const Grid is = finer.grid(finer.surface_of()[k]);
            REQUIRE(std::abs(at[0] / is.u - coarse_at[0] / was.u) < 0.7 / was.u);
            REQUIRE(std::abs(at[1] / is.v - coarse_at[1] / was.v) < 0.7 / was.v);
        }
        for (std::uint32_t i = 0; i < coarse.size(); ++i) {
            REQUIRE(areas[i] == Approx(coarse.areas()[i]).epsilon(1e-12));
        }
        for (std::uint32_t s = 0; s < finer.surfaces().size(); ++s) {
            const std::uint32_t count = finer.patches_per_side(s);
            for (std::uint32_t k = 0; k < count && finer.surfaces()[s].two_sided; ++k) {
                const std::uint32_t front = finer.first_patch(s) + k;
                REQUIRE(finer.centres()[front] == finer.centres()[front + count]);
            }
        }
        CHECK(finer.geometry_hash() != fine.geometry_hash());
        CHECK(fine.geometry_hash() != coarse.geometry_hash());
    }
}

TEST_CASE("PatchMesh::split: all of them are a finer grid, bit by bit", "[scene]") {
    Scene scene = various_scenes()[3];
    const PatchMesh coarse(scene);
    std::vector<std::uint32_t> all(coarse.size());
    std::iota(all.begin(), all.end(), 0u);
    const auto [fine, parents] = coarse.split(all, Cut::in_four);
    for (Surface& surface : scene.surfaces) {
        surface.patches = Grid{2 * surface.patches->u, 2 * surface.patches->v};
    }
    const PatchMesh expected(scene);
    REQUIRE(fine.size() == expected.size());
    CHECK(fine.parts().empty());
    CHECK(fine.geometry_hash() == expected.geometry_hash());
    for (std::uint32_t k = 0; k < fine.size(); ++k) {
        REQUIRE(same_bits(fine.centres()[k], expected.centres()[k]));
        REQUIRE(fine.areas()[k] == expected.areas()[k]);
    }
    CHECK(std::count(parents.begin(), parents.end(), 7u) == 4);
    // Some first, then the others: the same mesh.
    const auto [some, first_parents] = coarse.split(some_patches(coarse), Cut::in_four);
    std::vector<std::uint32_t> rest;
    for (std::uint32_t k = 0; k < some.size(); ++k) {
        if (std::count(first_parents.begin(), first_parents.end(), first_parents[k]) == 1) {
            rest.push_back(k);
        }
    }
    CHECK(some.split(rest, Cut::in_four).mesh.geometry_hash() == expected.geometry_hash());
}

TEST_CASE("PatchMesh::split: long patches are cut across, triangles always in four", "[scene]") {
    const auto parts_of = [](const Scene& scene, Cut how) {
        return PatchMesh(scene).split(std::vector<std::uint32_t>{0}, how).mesh.size();
    };
    CHECK(parts_of(one_polygon(rectangle(5, 1)), Cut::by_shape) == 2);
    CHECK(parts_of(one_polygon(rectangle(1, 2)), Cut::by_shape) == 2);
    CHECK(parts_of(one_polygon(rectangle(1.9, 1)), Cut::by_shape) == 4);
    CHECK(parts_of(one_polygon(rectangle(5, 1)), Cut::in_four) == 4);
    CHECK(parts_of(one_polygon(triangle), Cut::by_shape) == 4);
}

TEST_CASE("PatchMesh::split: along u, along v or both, and what either side asks for", "[scene]") {
    Scene scene = one_polygon(rectangle(3, 2), Grid{3, 2});
    scene.surfaces[0].two_sided = true;
    const PatchMesh mesh(scene);
    const auto [fine, parents] = mesh.split(
        std::vector<PatchSplit>{{1, true, false}, {2, false, true}, {10, true, false}, {9, false, true}});
    const auto parts_of = [&](std::uint32_t patch) {
        std::vector<Vec3> sizes;
        for (std::uint32_t k = 0; k < fine.size(); ++k) {
            if (parents[k] == patch) {
                const PatchCorners own = fine.corners(k);
                sizes.push_back(glm::abs(own.points[2] - own.points[0]));
            }
        }
        return sizes;
    };
    for (const std::uint32_t side : {0U, 6U}) {
        CHECK(parts_of(side) == std::vector<Vec3>{Vec3(1, 1, 0)});
        CHECK(parts_of(side + 1) == std::vector<Vec3>(2, Vec3(0.5, 1, 0)));
        CHECK(parts_of(side + 2) == std::vector<Vec3>(2, Vec3(1, 0.5, 0)));
        CHECK(parts_of(side + 3) == std::vector<Vec3>(2, Vec3(1, 0.5, 0)));
        CHECK(parts_of(side + 4) == std::vector<Vec3>(2, Vec3(0.5, 1, 0)));
        CHECK(parts_of(side + 5) == std::vector<Vec3>{Vec3(1, 1, 0)});
    }
    // Both sides together.
    CHECK(mesh.split(std::vector<PatchSplit>{{1, true, false}, {7, false, true}}).mesh.size() == 2 * (5 + 4));
}

TEST_CASE("PatchMesh: parts are stored and read back, and refused where they do not fill", "[scene]") {
    for (Scene scene : various_scenes()) {
        const PatchMesh coarse(scene);
        const PatchMesh first = coarse.split(some_patches(coarse)).mesh;
        const PatchMesh fine = first.split(some_patches(first)).mesh;
        for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
            scene.surfaces[s].patches = fine.grid(s);
        }
        Subdivision subdivision;
        subdivision.parts = fine.parts();
        const PatchMesh again(scene, subdivision);
        REQUIRE(again.size() == fine.size());
        CHECK(again.geometry_hash() == fine.geometry_hash());
        const auto refuses = [&scene](const Subdivision& wrong) {
            CHECK_THROWS_AS(PatchMesh(scene, wrong), InvalidArgument);
        };
        std::size_t s = 0;
        while (subdivision.parts[s].empty()) {
            ++s;
        }
        Subdivision wrong = subdivision;
        wrong.parts[s].pop_back();
        refuses(wrong);
        wrong = subdivision;
        wrong.parts[s].back() = wrong.parts[s].front();
        refuses(wrong);
        wrong = subdivision;
        wrong.parts[s][0].cell = 1u << 30;
        refuses(wrong);
        wrong = subdivision;
        wrong.parts[s][0].level_u = 4000000000u;
        refuses(wrong);
        wrong = subdivision;
        wrong.parts.pop_back();
        refuses(wrong);
    }
    const PatchMesh mesh(one_polygon(rectangle(1, 1), Grid{65535, 1}));
    CHECK_THROWS_AS(mesh.split(std::vector<std::uint32_t>{0}, Cut::in_four), InvalidArgument);
}
