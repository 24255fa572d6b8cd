#include "hemi/core/error.hpp"
#include "hemi/scene/imprint.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace hemi {

namespace {

Surface face(const std::vector<Vec3>& corners, Grid grid = {1, 1}, bool two_sided = false) {
    Surface surface;
    surface.vertex_count = static_cast<std::uint32_t>(corners.size());
    std::copy(corners.begin(), corners.end(), surface.vertices.begin());
    surface.patches = grid;
    surface.two_sided = two_sided;
    return surface;
}

Scene scene_of(std::vector<Surface> surfaces) {
    Scene scene;
    scene.materials.push_back({"", {0.5}, {0.0}});
    scene.groups = {"all"};
    scene.surfaces = std::move(surfaces);
    return scene;
}

/// A horizontal rectangle that looks up.
Surface plate(double x0, double y0, double x1, double y1, double z, Grid grid = {1, 1}) {
    return face({{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}}, grid);
}

/// The walls and the top of a box on z = 0, outwards.
std::vector<Surface> block(double x0, double y0, double x1, double y1, double height, double base = 0.0) {
    return {plate(x0, y0, x1, y1, height),
            face({{x0, y0, base}, {x1, y0, base}, {x1, y0, height}, {x0, y0, height}}),
            face({{x1, y0, base}, {x1, y1, base}, {x1, y1, height}, {x1, y0, height}}),
            face({{x1, y1, base}, {x0, y1, base}, {x0, y1, height}, {x1, y1, height}}),
            face({{x0, y1, base}, {x0, y0, base}, {x0, y0, height}, {x0, y1, height}})};
}

/// Checks that every part lies within the patch that it is said to be part of, and looks the same way.
void check_parts(const Scene& scene, const Imprint& cut) {
    const PatchMesh whole(scene);
    const PatchMesh mesh(cut.scene);
    REQUIRE(cut.parts.patch_of.size() == mesh.size());
    REQUIRE(cut.parts.patches() == whole.size());
    const double size = whole.bounds().diagonal();
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::uint32_t patch = cut.parts.patch_of[i];
        INFO("part " << i << " of patch " << patch);
        CHECK(cut.parts.group_of[patch] == mesh.group(i));
        CHECK(glm::dot(whole.normal(patch), mesh.normal(i)) > 0.999);
        const PatchCorners corners = whole.corners(patch);
        for (std::uint32_t k = 0; k < corners.count; ++k) {
            const Vec3 edge = corners.points[(k + 1) % corners.count] - corners.points[k];
            const Vec3 inwards = glm::cross(whole.normal(patch), edge) / glm::length(edge);
            CHECK(glm::dot(mesh.centres()[i] - corners.points[k], inwards) > -1e-7 * size);
        }
    }
}

/// Area of what is left of each face of the scene as it was.
std::vector<double> areas_of_faces(const Imprint& cut, std::size_t faces) {
    std::vector<double> areas(faces, 0.0);
    const PatchMesh mesh(cut.scene);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        areas[cut.face_of[mesh.surface_of()[i]]] += mesh.areas()[i];
    }
    return areas;
}

} // namespace

TEST_CASE("Imprint: faces that do not touch, or touch along their edges, stay as they are", "[imprint]") {
    std::vector<Surface> cube = block(0.0, 0.0, 1.0, 1.0, 1.0);
    cube.push_back(plate(0.0, 0.0, 1.0, 1.0, 0.0, {4, 4}));
    cube.push_back(plate(1.0, 0.0, 2.0, 1.0, 0.0)); // a neighbour in the same plane
    cube.push_back(plate(0.25, 0.25, 0.75, 0.75, 2.0));
    CHECK_FALSE(imprint(scene_of(cube)));
}

TEST_CASE("Imprint: the foot of a block is cut out of the floor, at any scale and place", "[imprint]") {
    const double scale = GENERATE(1.0, 1e-6, 1e6);
    const Vec3 place = GENERATE(Vec3(0.0), Vec3(1e5, -3e4, 7e4));
    std::vector<Surface> surfaces = block(1.3, 2.2, 2.7, 3.4, 1.0);
    surfaces.push_back(plate(0.0, 0.0, 5.0, 5.0, 0.0, {5, 5}));
    for (Surface& surface : surfaces) {
        for (Vec3& vertex : surface.vertices) {
            vertex = scale * (vertex + place);
        }
    }
    const auto cut = imprint(scene_of(surfaces));
    REQUIRE(cut);
    REQUIRE(cut->findings.size() == 1);
    CHECK(cut->findings[0].what == Imprint::What::cut);
    CHECK(cut->findings[0].face == 5);
    const double foot = 1.4 * 1.2;
    CHECK(cut->covered == Approx(foot * scale * scale).epsilon(1e-7));
    const auto areas = areas_of_faces(*cut, surfaces.size());
    CHECK(areas[5] == Approx((25.0 - foot) * scale * scale).epsilon(1e-7));
    CHECK(areas[0] == Approx(foot * scale * scale).epsilon(1e-7)); // the block's top, whole
    // No patch has its centre under the block.
    const PatchMesh mesh(cut->scene);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const Vec3 at = mesh.centres()[i] / scale - place;
        const bool under = at.x > 1.3 && at.x < 2.7 && at.y > 2.2 && at.y < 3.4 && at.z < 1e-6;
        CHECK_FALSE(under);
    }
}

TEST_CASE("Imprint: parts know the patches that they are parts of", "[imprint]") {
    std::vector<Surface> surfaces = block(1.3, 2.2, 2.7, 3.4, 1.0, -0.5);
    surfaces.push_back(plate(0.0, 0.0, 5.0, 5.0, 0.0, {5, 4}));
    // A two-sided sheet across it, and a triangle with the block's corner in it.
    surfaces.push_back(
        face({{2.0, 2.8, 0.5}, {4.2, 2.8, 0.5}, {4.2, 3.9, 1.5}, {2.0, 3.9, 1.5}}, {3, 2}, true));
    surfaces.push_back(face({{0.0, 0.0, 0.6}, {4.0, 0.0, 0.6}, {0.0, 4.0, 0.6}}, {4, 4}));
    // Back to back: the second one begins elsewhere.
    surfaces.push_back(face({{0.0, 0.0, 2.0}, {3.0, 0.0, 2.0}, {3.0, 1.0, 2.0}, {0.0, 1.0, 2.0}}, {3, 2}));
    surfaces.push_back(face({{3.0, 0.0, 2.0}, {0.0, 0.0, 2.0}, {0.0, 1.0, 2.0}, {3.0, 1.0, 2.0}}, {3, 2}));
    const Scene scene = scene_of(surfaces);
    const auto cut = imprint(scene);
    REQUIRE(cut);
    check_parts(scene, *cut);
    // Where nothing else is cut.
    const Scene baffle = scene_of({surfaces[8], surfaces[9]});
    const auto joined = imprint(baffle);
    REQUIRE(joined);
    check_parts(baffle, *joined);
    std::vector<std::uint32_t> patches = joined->parts.patch_of;
    std::sort(patches.begin(), patches.end());
    CHECK(patches == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
}

TEST_CASE("Imprint: faces back to back are joined where their patches are the same", "[imprint]") {
    const Surface front = face({{0.0, 0.0, 2.0}, {3.0, 0.0, 2.0}, {3.0, 1.0, 2.0}, {0.0, 1.0, 2.0}}, {3, 2});
    const auto with_back = [&](const Grid& grid) {
        // From corner to corner as the front in the other sense, so that its u is the front's v.
        return scene_of(
            {front, face({{0.0, 0.0, 2.0}, {0.0, 1.0, 2.0}, {3.0, 1.0, 2.0}, {3.0, 0.0, 2.0}}, grid)});
    };
    const Scene same = with_back({2, 3});
    const auto joined = imprint(same);
    REQUIRE(joined);
    CHECK(joined->scene.surfaces.size() == 1);
    check_parts(same, *joined);
    for (const Grid& other : {Grid{3, 2}, Grid{1, 1}, Grid{6, 1}, Grid{4, 6}}) {
        const Scene scene = with_back(other);
        const auto apart = imprint(scene);
        REQUIRE((!apart || apart->scene.surfaces.size() >= 2));
        if (apart) {
            check_parts(scene, *apart);
        }
    }
}

TEST_CASE("Imprint: a block that passes through a floor is cut where it does, and its foot is not seen",
          "[imprint]") {
    std::vector<Surface> surfaces = block(1.3, 2.2, 2.7, 3.4, 1.0, -0.5);
    surfaces.push_back(plate(0.0, 0.0, 5.0, 5.0, 0.0, {5, 5}));
    const auto cut = imprint(scene_of(surfaces));
    REQUIRE(cut);
    const auto areas = areas_of_faces(*cut, surfaces.size());
    CHECK(areas[5] == Approx(25.0 - 1.4 * 1.2));
    CHECK(areas[1] == Approx(1.4 * 1.5)); // cut in two, both are there
}

TEST_CASE("Imprint: what stands between two faces closes a cavity with parts of both", "[imprint]") {
    // A post without ends between a floor and a seat, in a foot without a bottom.
    const auto sides = [](double x0, double y0, double x1, double y1, double top) {
        std::vector<Surface> box = block(x0, y0, x1, y1, top);
        box.erase(box.begin()); // the top
        return box;
    };
    std::vector<Surface> surfaces = sides(-0.03, -0.03, 0.03, 0.03, 0.42);
    for (const Surface& surface : block(-0.3, -0.1, 0.3, 0.1, 0.06)) {
        surfaces.push_back(surface);
    }
    surfaces.push_back(plate(-1.0, -1.0, 1.0, 1.0, 0.0, {8, 8}));
    surfaces.push_back(
        face({{-0.24, -0.24, 0.42}, {-0.24, 0.24, 0.42}, {0.24, 0.24, 0.42}, {0.24, -0.24, 0.42}}, {4, 4}));
    const auto cut = imprint(scene_of(surfaces));
    REQUIRE(cut);
    const auto areas = areas_of_faces(*cut, surfaces.size());
    constexpr double post = 0.06 * 0.06;
    CHECK(areas[surfaces.size() - 1] == Approx(0.48 * 0.48 - post));
    CHECK(areas[surfaces.size() - 2] == Approx(4.0 - 0.6 * 0.2));
    for (std::size_t f = 0; f < 4; ++f) {
        CHECK(areas[f] == Approx(0.06 * 0.36)); // above the foot
    }
    CHECK(areas[4] == Approx(0.6 * 0.2 - post)); // the foot's top
}

TEST_CASE("Imprint: patches are cut along a sheet that stands on them, and nothing is left out",
          "[imprint]") {
    std::vector<Surface> surfaces{plate(0.0, 0.0, 4.0, 4.0, 0.0, {4, 4})};
    surfaces.push_back(
        face({{1.5, 0.0, 0.0}, {1.5, 4.0, 0.0}, {1.5, 4.0, 1.0}, {1.5, 0.0, 1.0}}, {1, 1}, true));
    const auto cut = imprint(scene_of(surfaces));
    REQUIRE(cut);
    CHECK(cut->covered == 0.0);
    CHECK(areas_of_faces(*cut, 2)[0] == Approx(16.0));
    const PatchMesh mesh(cut->scene);
    CHECK(mesh.size() == 16 + 4 + 2);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        bool left = false;
        bool right = false;
        const PatchCorners corners = mesh.corners(i);
        for (const Vec3& corner : corners.polygon()) {
            left = left || corner.x < 1.5 - 1e-9;
            right = right || corner.x > 1.5 + 1e-9;
        }
        CHECK_FALSE((left && right));
    }
}

TEST_CASE("Imprint: of faces over each other in one plane the smaller is on top, of equal ones the later",
          "[imprint]") {
    SECTION("a rug in the floor") {
        const std::vector<Surface> surfaces{plate(1.2, 1.2, 2.9, 3.1, 0.0),
                                            plate(0.0, 0.0, 4.0, 4.0, 0.0, {4, 4})};
        const auto cut = imprint(scene_of(surfaces));
        REQUIRE(cut);
        const auto areas = areas_of_faces(*cut, 2);
        CHECK(areas[0] == Approx(1.7 * 1.9));
        CHECK(areas[1] == Approx(16.0 - 1.7 * 1.9));
        REQUIRE(cut->findings.size() == 1);
        CHECK(cut->findings[0].what == Imprint::What::overlapped);
        CHECK(cut->findings[0].other == 0);
    }
    SECTION("the same face twice") {
        const bool two_sided = GENERATE(false, true);
        std::vector<Surface> surfaces{plate(0.0, 0.0, 1.0, 1.0, 0.0), plate(0.0, 0.0, 1.0, 1.0, 0.0)};
        surfaces[0].two_sided = surfaces[1].two_sided = two_sided;
        const auto cut = imprint(scene_of(surfaces));
        REQUIRE(cut);
        CHECK(cut->scene.surfaces.size() == 1);
        CHECK(cut->face_of == std::vector<std::uint32_t>{1});
        REQUIRE(cut->findings.size() == 1);
        CHECK(cut->findings[0].what == Imprint::What::duplicate);
        CHECK(cut->findings[0].face == 0);
    }
    SECTION("the same face ten thousand times, from other corners on") {
        std::vector<Surface> surfaces(10'000, plate(0.0, 0.0, 2.0, 1.0, 0.0));
        for (std::size_t k = 0; k < surfaces.size(); ++k) {
            std::rotate(surfaces[k].vertices.begin(), surfaces[k].vertices.begin() + k % 4,
                        surfaces[k].vertices.end());
        }
        const auto cut = imprint(scene_of(surfaces));
        REQUIRE(cut);
        CHECK(cut->face_of == std::vector<std::uint32_t>{9'999});
        CHECK(cut->parts.patch_of == std::vector<std::uint32_t>{9'999});
        CHECK(cut->covered == Approx(2.0 * 9'999));
        REQUIRE(cut->findings.size() == 9'999);
        CHECK(cut->findings[17].what == Imprint::What::duplicate);
        CHECK(cut->findings[17].other == 18);
    }
    SECTION("twice, and back to back: the back stays") {
        std::vector<Surface> surfaces(3, plate(0.0, 0.0, 1.0, 1.0, 0.0));
        std::swap(surfaces[2].vertices[1], surfaces[2].vertices[3]);
        const auto cut = imprint(scene_of(surfaces));
        REQUIRE(cut);
        CHECK(cut->face_of == std::vector<std::uint32_t>{1});
        CHECK(cut->scene.surfaces[0].two_sided);
        CHECK(cut->parts.patch_of == std::vector<std::uint32_t>{1, 2});
        CHECK(cut->covered == Approx(1.0));
    }
    SECTION("triangles of the same corners, and others of three of them") {
        const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
        const auto triangle = [&](std::size_t a, std::size_t b, std::size_t c) {
            return face({corners[a], corners[b], corners[c]});
        };
        const auto cut = imprint(scene_of({triangle(0, 1, 2), triangle(0, 2, 3), triangle(2, 0, 1)}));
        REQUIRE(cut);
        CHECK(cut->face_of == std::vector<std::uint32_t>{1, 2});
    }
    SECTION("back to back: one two-sided face") {
        std::vector<Surface> surfaces{plate(0.0, 0.0, 1.0, 1.0, 0.0), plate(0.0, 0.0, 1.0, 1.0, 0.0)};
        std::swap(surfaces[1].vertices[1], surfaces[1].vertices[3]);
        const auto cut = imprint(scene_of(surfaces));
        REQUIRE(cut);
        REQUIRE(cut->scene.surfaces.size() == 1);
        CHECK(cut->scene.surfaces[0].two_sided);
        surfaces[1].group = 1; // another name: both stay
        Scene named = scene_of(surfaces);
        named.groups = {"one", "other"};
        CHECK_FALSE(imprint(named));
    }
}

TEST_CASE("Imprint: a sheet that lies on a face has one side left", "[imprint]") {
    std::vector<Surface> surfaces{plate(0.0, 0.0, 4.0, 4.0, 0.0, {4, 4}), plate(1.0, 1.0, 2.0, 2.0, 0.0)};
    surfaces[1].two_sided = true;
    const auto cut = imprint(scene_of(surfaces));
    REQUIRE(cut);
    CHECK(areas_of_faces(*cut, 2)[0] == Approx(15.0));
    CHECK(areas_of_faces(*cut, 2)[1] == Approx(1.0)); // else 2
    CHECK_FALSE(cut->scene.surfaces.back().two_sided);
}

TEST_CASE("Imprint: bodies on each other touch without a gap, and what is between them is left out",
          "[imprint]") {
    std::vector<Surface> surfaces = block(0.0, 0.0, 2.0, 2.0, 1.0);
    const std::vector<Surface> upper = block(0.5, 0.5, 1.5, 1.5, 2.0, 1.0);
    surfaces.insert(surfaces.end(), upper.begin(), upper.end());
    Surface bottom = plate(0.5, 0.5, 1.5, 1.5, 1.0); // of the upper one, looks down
    std::swap(bottom.vertices[1], bottom.vertices[3]);
    surfaces.push_back(bottom);
    Surface ground = plate(0.0, 0.0, 2.0, 2.0, 0.0); // the lower one's bottom
    std::swap(ground.vertices[1], ground.vertices[3]);
    surfaces.push_back(ground);
    const auto cut = imprint(scene_of(surfaces));
    REQUIRE(cut);
    const auto areas = areas_of_faces(*cut, surfaces.size());
    CHECK(areas[0] == Approx(3.0)); // the lower one's top
    CHECK(areas[10] == 0.0);        // the upper one's bottom
    CHECK(areas[11] == Approx(4.0));
    CHECK(cut->covered == Approx(2.0));
}

TEST_CASE("Imprint: what is left does not depend on how fine the patches are", "[imprint]") {
    std::vector<Surface> surfaces = block(1.3, 2.2, 2.7, 3.4, 1.0);
    surfaces.push_back(plate(0.0, 0.0, 5.0, 5.0, 0.0));
    for (const double size : {5.0, 1.7, 0.3}) {
        Subdivision subdivision;
        subdivision.patch_size = size;
        const auto cut = imprint(scene_of(surfaces), subdivision);
        REQUIRE(cut);
        const PatchMesh mesh(cut->scene);
        double floor = 0.0;
        double longest = 0.0;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            floor += cut->face_of[mesh.surface_of()[i]] == 5 ? mesh.areas()[i] : 0.0;
            const auto polygon = mesh.corners(i);
            for (std::uint32_t k = 0; k < polygon.count; ++k) {
                longest = std::max(longest,
                                   glm::distance(polygon.points[k], polygon.points[(k + 1) % polygon.count]));
            }
        }
        CHECK(floor == Approx(25.0 - 1.4 * 1.2));
        CHECK(longest <= size * std::sqrt(2.0) * (1.0 + 1e-9));
    }
}

TEST_CASE("Imprint: patches of different sizes are refused", "[imprint]") {
    Subdivision subdivision;
    subdivision.parts = {{{1, 1, 0}, {1, 1, 1}, {1, 1, 2}, {1, 1, 3}}};
    CHECK_THROWS_AS(imprint(scene_of({plate(0.0, 0.0, 1.0, 1.0, 0.0)}), subdivision), InvalidArgument);
}

} // namespace hemi
