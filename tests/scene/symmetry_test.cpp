#include "support/scenes.hpp"

#include "hemi/core/error.hpp"
#include "hemi/scene/image_mesh.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <string>

using namespace hemi;
using namespace hemi::test;
using Catch::Contains;

namespace {

/// A floor on the positive side of x = 0, of 2 x 3 quadrilaterals, and a triangle of 4 on it that stands.
Scene part() {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}, {2, 3});
    add_polygon(scene, "fin", {{0.2, 0.5, 0}, {1.4, 0.8, 0}, {0.2, 0.5, 1}}, {3, 3});
    scene.surfaces.back().two_sided = true;
    return scene;
}

Symmetry mirrored(std::vector<MirrorPlane> planes) {
    Symmetry symmetry;
    symmetry.mirrors = std::move(planes);
    return symmetry;
}

void check_images(const Scene& scene) {
    const PatchMesh mesh(scene);
    const ImageMesh images(mesh);
    const SceneImages all = images_of(*scene.symmetry);
    REQUIRE(images.images() == all.all.size());
    REQUIRE(images.mesh().size() == mesh.size() * images.images());
    for (std::uint32_t image = 0; image < images.images(); ++image) {
        const Isometry& place = all.all[image];
        const Isometry& back = all.all[all.inverse[image]];
        CHECK(glm::length(back(place(Vec3(0.3, 0.7, -1.1))) - Vec3(0.3, 0.7, -1.1)) < 1e-12);
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const std::uint32_t p = images.patch(image, i);
            CHECK(images.original(p) == i);
            CHECK(images.mesh().areas()[p] == Approx(mesh.areas()[i]).epsilon(1e-12));
            CHECK(glm::length(images.mesh().centres()[p] - place(mesh.centres()[i])) < 1e-12);
            CHECK(glm::length(images.mesh().normal(p) - place.direction(mesh.normal(i))) < 1e-12);
            CHECK(images.mesh().group(p) == mesh.group(i));
            const auto [from, to] = images.counterpart(0, p);
            CHECK(from == i);
            // Both lie to each other as the pair that it stands for.
            CHECK(glm::length(images.mesh().centres()[to] - mesh.centres()[from]) ==
                  Approx(glm::length(images.mesh().centres()[p] - mesh.centres()[0])).margin(1e-12));
            const auto again = images.counterpart(from, to);
            CHECK((again.from == 0 && again.to == p));
        }
    }
}

std::string message(const Scene& scene) {
    try {
        validate(scene);
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing is wrong";
}

} // namespace

TEST_CASE("Symmetry: images of patches lie where the images take them", "[scene]") {
    Scene scene = part();
    SECTION("in one mirror") {
        scene.symmetry = mirrored({{0, 0.0}});
        CHECK(images_of(*scene.symmetry).all.size() == 2);
    }
    SECTION("in three, not through the origin") {
        scene.symmetry = mirrored({{0, 2.5}, {1, -1.0}, {2, 3.0}});
        CHECK(images_of(*scene.symmetry).all.size() == 8);
    }
    SECTION("by turns, and mirrored") {
        scene.symmetry = mirrored({{2, 0.0}});
        scene.surfaces.erase(scene.surfaces.begin());
        scene.symmetry->rotation = RotationAxis{2, 6};
        CHECK(images_of(*scene.symmetry).all.size() == 12);
    }
    SECTION("by a plane that holds the axis") { // the plane and its turned ones
        scene.symmetry = mirrored({{1, 0.0}});
        scene.symmetry->rotation = RotationAxis{2, 3};
        CHECK(images_of(*scene.symmetry).all.size() == 6);
    }
    SECTION("by two planes whose turns hold each other") {
        scene.symmetry = mirrored({{0, 0.0}, {1, 0.0}});
        scene.symmetry->rotation = RotationAxis{2, 4};
        CHECK(images_of(*scene.symmetry).all.size() == 8);
    }
    SECTION("along translations, in a mirror") {
        scene.symmetry = mirrored({{0, 0.0}});
        scene.symmetry->periods = {{5, 0, 0}, {0, 0, 7}};
        scene.symmetry->images = 2;
        CHECK(images_of(*scene.symmetry).all.size() == 50);
    }
    check_images(scene);
}

TEST_CASE("Symmetry: images of patches that differ in size keep their order", "[scene]") {
    Scene scene = part();
    scene.symmetry = mirrored({{0, 0.0}});
    const std::vector<std::uint32_t> cut{1, 4, 7};
    const PatchMesh mesh = PatchMesh(scene).split(cut, Cut::by_shape).mesh;
    REQUIRE(mesh.parts().size() == 2);
    const ImageMesh images(mesh);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const Vec3 there = images.mesh().centres()[images.patch(1, i)];
        CHECK(glm::length(there - mesh.centres()[i] * Vec3(-1, 1, 1)) < 1e-12);
    }
}

TEST_CASE("Symmetry: a mesh without one is its own images", "[scene]") {
    const PatchMesh mesh(part());
    const ImageMesh images(mesh);
    CHECK(images.images() == 1);
    CHECK(&images.mesh() == &mesh);
    const auto [from, to] = images.counterpart(3, 5);
    CHECK((from == 5 && to == 3));
}

TEST_CASE("Symmetry: the geometry's hash tells symmetries apart", "[scene]") {
    Scene scene = part();
    const std::uint64_t none = PatchMesh(scene).geometry_hash();
    scene.symmetry = mirrored({{0, 0.0}});
    const std::uint64_t one = PatchMesh(scene).geometry_hash();
    scene.symmetry = mirrored({{0, -0.5}});
    CHECK((none != one && one != PatchMesh(scene).geometry_hash()));
}

TEST_CASE("Symmetry: what cannot be one is refused with what is wrong", "[scene]") {
    Scene scene = part();
    scene.symmetry = mirrored({{0, 0.5}});
    CHECK_THAT(message(scene),
               Contains("face 0 (group \"floor\") reaches 0.5 beyond the mirror plane x=0.5"));
    scene.symmetry = mirrored({{2, 0.0}});
    CHECK_THAT(message(scene), Contains("face 0 (group \"floor\") lies in the mirror plane z=0"));
    scene.symmetry = mirrored({{0, 0.0}, {0, 3.0}});
    CHECK_THAT(message(scene), Contains("mirror planes x=0 and x=3 are not perpendicular"));
    scene.symmetry = mirrored({{0, -1.0}});
    scene.symmetry->rotation = RotationAxis{2, 4};
    CHECK_THAT(message(scene), Contains("images without end"));
    scene.symmetry = Symmetry();
    CHECK_THAT(message(scene), Contains("neither mirror plane nor rotation nor translation"));
    scene.symmetry->periods = {{1, 0, 0}, {2, 0, 0}};
    CHECK_THAT(message(scene), Contains("a translation that follows from the others"));
    scene.symmetry->periods = {{0, 0, 0}};
    CHECK_THAT(message(scene), Contains("a translation by (0, 0, 0)"));
    scene.symmetry = mirrored({{0, 0.0}});
    scene.symmetry->periods = {{1, 1, 0}};
    CHECK_THAT(message(scene), Contains("makes the translation (1, 1, 0) another one, (-1, 1, 0)"));
    scene.symmetry->periods = {{0, 1, 0}};
    scene.symmetry->images = 4000;
    CHECK_THAT(message(scene), Contains("more than 4096"));
    scene.symmetry->images = 1;
    scene.symmetry->periods = {{0, 1e9, 0}};
    CHECK_THAT(message(scene), Contains("must be at most 1e+06 times as far"));
    scene.symmetry->images = 0;
    CHECK_THAT(message(scene), Contains("0 images along a translation"));
    scene.symmetry = mirrored({{0, 0.0}});
    scene.sun = Sun{{0.6, 0, 0.8}, {1.0}, 0.0};
    CHECK_THAT(message(scene),
               Contains("the sun stands towards (0.6, 0, 0.8), in an image of the scene towards "
                        "(-0.6, 0, 0.8)"));
    scene.sun->direction = {0, 0.6, 0.8};
    scene.sky = Sky{SkyDistribution::uniform, {1.0}, {0.0}};
    CHECK_THAT(message(scene), Contains("the scene has a sky"));
    scene.sky.reset();
    CHECK(message(scene) == "nothing is wrong");
}

TEST_CASE("Symmetry: planes are read as they are written", "[scene]") {
    CHECK(plane_text({1, -2.5}) == "y=-2.5");
    CHECK(plane_from_text("y=-2.5") == MirrorPlane{1, -2.5});
    for (const char* wrong : {"", "x", "x=", "=1", "w=0", "xy=0", "x=0x", "x=inf", "x= 0"}) {
        INFO(wrong);
        CHECK_FALSE(plane_from_text(wrong).has_value());
    }
}
