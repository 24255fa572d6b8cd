#include "hemi/engine/touching_faces.hpp"

#include "hemi/engine/engine.hpp"
#include "support/device.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

using namespace hemi;
using namespace hemi::test;

namespace {

FormFactorMatrix rows_of(const PatchMesh& mesh) {
    return compute_matrix(
        *make_hemicube_engine(mesh, {.resolution = 32}, {test_device(), 1, find_worker_program()}));
}

} // namespace

TEST_CASE("mark_touching_faces_buried: the bottom of a block on the floor of a closed room is covered",
          "[engine][gl][every-device]") {
    const PatchMesh mesh(room_with_blocks(4));
    FormFactorMatrix factors = rows_of(mesh);
    const auto contacts = find_touching_faces(factors, mesh);
    REQUIRE(contacts.size() == 4); // the block's faces are cut 2 x 2
    for (const std::uint32_t patch : contacts) {
        CHECK(mesh.normal(patch).z == Approx(-1.0));
        CHECK(factors.row(patch).environment == 1.0);
    }
    FormFactorMatrix open = factors;
    mark_touching_faces_buried(open, contacts, Enclosure::open);
    CHECK(open.row(contacts[0]).environment == 1.0);
    for (const Enclosure enclosure : {Enclosure::closed, Enclosure::automatic}) {
        FormFactorMatrix closed = factors;
        mark_touching_faces_buried(closed, contacts, enclosure);
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            CHECK(closed.row(i).environment == 0.0);
        }
        CHECK(closed.row(contacts[0]).blocked == 1.0);
    }
}

TEST_CASE("mark_touching_faces_buried: back-to-back sheets in the open keep their view of the sky",
          "[engine][gl][every-device]") {
    const PatchMesh mesh(read_case("12_occluded_corner.obj"));
    FormFactorMatrix factors = rows_of(mesh);
    const RowView before = factors.row(0);
    const double environment = before.environment;
    REQUIRE(environment > 0.0);
    mark_touching_faces_buried(factors, find_touching_faces(factors, mesh), Enclosure::automatic);
    CHECK(factors.row(0).environment == environment);
}

TEST_CASE("find_touching_faces: what lies back to back with the walls of a room looks out of it",
          "[engine][gl][every-device]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(2.0, 2.0, 1.0), 2);
    add_block(scene, "outside", Vec3(0.0), Vec3(2.0, 2.0, 1.0), 2);
    add_block(scene, "block", Vec3(0.6, 0.6, 0.0), Vec3(0.9, 0.9, 0.5), 1);
    add_polygon(scene, "rug", {Vec3(1.5, 0, 0), Vec3(1.5, 1, 0), Vec3(2, 1, 0), Vec3(2, 0, 0)}); // face down
    const PatchMesh mesh(scene);
    FormFactorMatrix factors = rows_of(mesh);
    const auto contacts = find_touching_faces(factors, mesh);
    REQUIRE(contacts.size() == 1);
    CHECK(mesh.groups()[mesh.group(contacts[0])] == "block");
    mark_touching_faces_buried(factors, contacts, Enclosure::automatic);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::string& group = mesh.groups()[mesh.group(i)];
        if (group == "outside" || group == "rug") {
            CHECK(factors.row(i).environment == Approx(1.0));
        }
    }
}
