#include "hemi/scene/imprint.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>

namespace hemi {

namespace {

Surface face(const std::vector<Vec3>& corners, bool continues = false) {
    Surface surface;
    surface.vertex_count = static_cast<std::uint32_t>(corners.size());
    std::copy(corners.begin(), corners.end(), surface.vertices.begin());
    surface.continues = continues;
    return surface;
}

/// A square that looks up, then a quadrilateral out of plane as two triangles, then a triangle.
Scene with_warped_face() {
    Scene scene;
    scene.materials.push_back({"", {0.5}, {0.0}});
    scene.groups = {"square", "warped", "triangle"};
    scene.surfaces = {
        face({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}), face({{2, 0, 0}, {3, 0, 0}, {3, 1, 0.5}}),
        face({{3, 1, 0.5}, {2, 1, 0}, {2, 0, 0}}, true), face({{4, 0, 0}, {5, 0, 0}, {4, 1, 0}})};
    scene.surfaces[1].group = scene.surfaces[2].group = 1;
    scene.surfaces[3].group = 2;
    return scene;
}

} // namespace

TEST_CASE("PatchMesh: pieces of a face are one patch, with their area, their centre and their mean normal",
          "[scene]") {
    Scene scene = with_warped_face();
    CHECK(face_numbers(scene.surfaces) == std::vector<std::uint32_t>{0, 1, 1, 2});
    const PatchMesh mesh(scene);
    const auto [whole, patch_of] = mesh.whole_faces();
    REQUIRE(whole.size() == 3);
    CHECK(patch_of == std::vector<std::uint32_t>{0, 1, 1, 2});
    CHECK(whole.group(1) == 1);
    CHECK(whole.areas()[0] == 1.0);
    CHECK(whole.areas()[1] == mesh.areas()[1] + mesh.areas()[2]);
    CHECK(whole.areas()[2] == 0.5);
    const Vec3 centre =
        (mesh.areas()[1] * mesh.centres()[1] + mesh.areas()[2] * mesh.centres()[2]) / whole.areas()[1];
    CHECK(glm::distance(whole.centres()[1], centre) < 1e-15);
    const Vec3 normal =
        glm::normalize(area_vector(std::vector<Vec3>{{2, 0, 0}, {3, 0, 0}, {3, 1, 0.5}, {2, 1, 0}}));
    CHECK(glm::distance(whole.normal(1), normal) < 1e-15);

    scene.surfaces[1].two_sided = scene.surfaces[2].two_sided = true;
    const auto [both, sides] = PatchMesh(scene).whole_faces();
    CHECK(both.size() == 4);
    CHECK(sides == std::vector<std::uint32_t>{0, 1, 2, 1, 2, 3});
    CHECK(both.areas()[2] == whole.areas()[1]);
    CHECK(glm::distance(both.normal(2), -normal) < 1e-15);
}

TEST_CASE("PatchMesh: pieces that are subdivided, or are unlike, stay surfaces of their own", "[scene]") {
    Scene scene = with_warped_face();
    const auto finer = PatchMesh(scene, {{}, 4, {}}).whole_faces();
    CHECK(finer.mesh.size() == 16);
    CHECK(finer.mesh.surfaces().size() == 4);
    CHECK(finer.patch_of.back() == 15);
    scene.surfaces[2].two_sided = true;
    CHECK(PatchMesh(scene).whole_faces().mesh.size() == 5);
}

TEST_CASE("imprint: parts are of whole faces, whether others touch them or not", "[scene]") {
    Scene scene = with_warped_face();
    for (const bool contacts : {false, true}) {
        const auto cut = imprint(scene, {}, contacts);
        REQUIRE(cut);
        CHECK(cut->parts.patch_of == std::vector<std::uint32_t>{0, 1, 1, 2});
        CHECK(cut->parts.group_of == std::vector<std::uint32_t>{0, 1, 2});
        CHECK(cut->findings.empty());
        CHECK(std::none_of(cut->scene.surfaces.begin(), cut->scene.surfaces.end(),
                           [](const Surface& surface) { return surface.continues; }));
    }
    // A sheet stands on one of the triangles; another face is one of them once more.
    scene.surfaces.push_back(face({{2.2, 0.5, 0.1}, {2.2, 0.9, 0.1}, {2.2, 0.9, 1}, {2.2, 0.5, 1}}));
    scene.surfaces.push_back(face({{2, 0, 0}, {3, 0, 0}, {3, 1, 0.5}}));
    const auto cut = imprint(scene);
    REQUIRE(cut->findings.size() == 1);
    CHECK(cut->findings[0].what == Imprint::What::overlapped); // not all of it is left out
    CHECK(cut->findings[0].face == 1);
    CHECK(cut->findings[0].other == 5);
    const std::vector<double> left = areas_of_patches(cut->parts, PatchMesh(cut->scene).areas());
    REQUIRE(left.size() == 5);
    const PatchMesh mesh(scene);
    CHECK(left[1] == Approx(mesh.areas()[2]));
    CHECK(left[4] == Approx(mesh.areas()[1]));
    scene.surfaces[2].continues = false; // two faces, of which one is there again
    const auto two = imprint(scene);
    CHECK(two->findings[0].what == Imprint::What::duplicate);
}

TEST_CASE("imprint: a face with a piece that becomes the back of another face is joined, not cut",
          "[scene]") {
    Scene scene = with_warped_face();
    scene.surfaces[0] = face({{3, 1, 0.5}, {2, 0, 0}, {2, 1, 0}}); // a piece, turned round
    scene.surfaces[0].group = 1;
    const auto cut = imprint(scene);
    REQUIRE(cut);
    REQUIRE(cut->findings.size() == 1);
    CHECK(cut->findings[0].face == 1);
    CHECK(cut->findings[0].what == Imprint::What::joined);
    CHECK(cut->findings[0].other == 0);
}

} // namespace hemi
