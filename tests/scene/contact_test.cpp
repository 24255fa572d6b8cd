#include "hemi/scene/contact.hpp"

#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace hemi;
using namespace hemi::test;

namespace {

std::vector<std::uint32_t> all_patches(const PatchMesh& mesh) {
    std::vector<std::uint32_t> patches(mesh.size());
    std::iota(patches.begin(), patches.end(), 0u);
    return patches;
}

std::vector<std::uint32_t> contacts(const Scene& scene) {
    const PatchMesh mesh(scene);
    return patches_in_contact(mesh, all_patches(mesh));
}

/// Floor of 4 x 4 patches with z up, and a small plate at `height` that faces up or down.
Scene floor_and_plate(double height, bool faces_down) {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(4, 4, 0), Vec3(0, 4, 0)}, {4, 4});
    std::vector<Vec3> plate{Vec3(1, 1, height), Vec3(2, 1, height), Vec3(2, 2, height), Vec3(1, 2, height)};
    if (faces_down) {
        plate = {plate.rbegin(), plate.rend()};
    }
    add_polygon(scene, "plate", plate);
    return scene;
}

} // namespace

TEST_CASE("patches_in_contact: a block's bottom and the floor under it", "[scene]") {
    const PatchMesh mesh(room_with_blocks(6));
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::string& group = mesh.groups()[mesh.group(i)];
        const bool bottom = group == "block" && mesh.normal(i).z < -0.5;
        if (bottom || (group == "z0" && under_block(mesh.centres()[i]))) {
            expected.push_back(i);
        }
    }
    REQUIRE(expected.size() > 9);
    CHECK(patches_in_contact(mesh, all_patches(mesh)) == expected);
}

TEST_CASE("patches_in_contact: the same ones at every scale and place and turn", "[scene]") {
    const auto expected = contacts(room_with_blocks(6));
    CHECK(contacts(scaled(room_with_blocks(6), 1e-6)) == expected);
    CHECK(contacts(scaled(room_with_blocks(6), 1e6)) == expected);
    CHECK(contacts(moved(room_with_blocks(6), Vec3(1e5))) == expected);
    CHECK(contacts(rotated(room_with_blocks(6))) == expected);
    CHECK(contacts(moved(rotated(room_with_blocks(6)), Vec3(1e5))) == expected);
}

TEST_CASE("patches_in_contact: looks at the patches asked for alone and keeps their order", "[scene]") {
    const PatchMesh mesh(floor_and_plate(0.0, true));
    CHECK(patches_in_contact(mesh, {}).empty());
    CHECK(patches_in_contact(mesh, std::vector<std::uint32_t>{0, 1}).empty());
    CHECK(patches_in_contact(mesh, std::vector<std::uint32_t>{16, 4, 5}) ==
          std::vector<std::uint32_t>{16, 5});
}

TEST_CASE("patches_in_contact: needs surfaces face to face without a gap", "[scene]") {
    CHECK(contacts(floor_and_plate(0.0, true)) == std::vector<std::uint32_t>{5, 16});
    CHECK(contacts(floor_and_plate(0.0, false)).empty()); // both face up
    CHECK(contacts(floor_and_plate(1e-3, true)).empty());
    CHECK(contacts(floor_and_plate(-1e-3, true)).empty());
}

TEST_CASE("patches_in_contact: neighbours in a plane and walls that share an edge are none", "[scene]") {
    CHECK(contacts(lattice_room()).empty());
    CHECK(contacts(two_plates(true)).empty());
}

TEST_CASE("patches_in_contact: a two-sided sheet is not in contact with itself", "[scene]") {
    Scene scene = floor_and_plate(1.0, false);
    scene.surfaces[1].two_sided = true;
    CHECK(contacts(scene).empty());
}

TEST_CASE("patches_in_contact: the back of a two-sided sheet on the floor", "[scene]") {
    Scene scene = floor_and_plate(0.0, false);
    scene.surfaces[1].two_sided = true;
    const auto found = contacts(scene);
    CHECK(std::find(found.begin(), found.end(), 17) != found.end()); // the sheet's back
    CHECK(std::find(found.begin(), found.end(), 16) == found.end()); // its front
}

TEST_CASE("near_contacts: a sheet that ends a hair above the floor", "[scene]") {
    const auto screen = [](double gap) {
        Scene scene = floor_and_plate(1.0, false);
        scene.surfaces.pop_back();
        add_polygon(scene, "screen", {Vec3(1, 1, gap), Vec3(2, 2, gap), Vec3(2, 2, 1), Vec3(1, 1, 1)});
        scene.surfaces.back().two_sided = true;
        return scene;
    };
    for (const double gap : {1e-4, -1e-4, 1e-5, 2e-6}) {
        const auto found = near_contacts(screen(gap));
        REQUIRE(found.size() == 1);
        CHECK(found[0].sheet == 1);
        CHECK(found[0].face == 0);
        CHECK(found[0].gap == Approx(std::abs(gap)));
    }
    for (const double gap : {0.0, 1e-7, -0.3, 0.01}) { // touches, passes through, or stands clear of it
        CHECK(near_contacts(screen(gap)).empty());
    }
    Scene body = screen(1e-4);
    body.surfaces.back().two_sided = false; // a body's, which is closed below
    CHECK(near_contacts(body).empty());
    Scene rug = floor_and_plate(1e-4, false);
    rug.surfaces.back().two_sided = true;
    CHECK(near_contacts(rug).empty());
}
