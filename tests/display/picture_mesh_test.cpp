#include "hemi/display/picture.hpp"

#include "display/display_fixtures.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace hemi;
using hemi::test::SceneBuilder;

TEST_CASE("PictureMesh: corners are stored relative to the scene's centre, triangles with the third repeated",
          "[display]") {
    SceneBuilder builder;
    builder.add("a", {{1e6, 0, 0}, {1e6 + 2, 0, 0}, {1e6 + 2, 2, 0}, {1e6, 2, 0}});
    builder.add("b", {{1e6, 0, 1}, {1e6 + 2, 0, 1}, {1e6, 2, 1}});
    const PatchMesh mesh = builder.mesh();
    const PictureMesh picture = make_picture_mesh(mesh, 1, std::vector<double>{1.0, 2.0}, {}, {0, 0, 0});
    REQUIRE(picture.positions.size() == 24);
    REQUIRE(picture.corners.size() == 24);
    REQUIRE(picture.patches.size() == 6);
    CHECK(picture.origin == mesh.bounds().centre());
    CHECK(picture.positions[0] == -1.0F);
    CHECK(picture.positions[3] == 1.0F);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(picture.positions[12 + 6 + i] == picture.positions[12 + 9 + i]);
        CHECK(picture.corners[12 + 6 + i] == picture.corners[12 + 9 + i]);
        CHECK(picture.patches[i] == 1.0F);
        CHECK(picture.patches[3 + i] == 2.0F);
    }
}

TEST_CASE("PictureMesh: shows the channels that are asked for", "[display]") {
    SceneBuilder builder;
    builder.scene.channels = {"a", "b"};
    builder.scene.materials = {{"white", {0.5, 0.5}, {0.0, 0.0}}};
    builder.scene.environment = {0.0, 0.0};
    builder.floor("floor", 0.0, 0.0, 1.0, 1.0);
    const PatchMesh mesh = builder.mesh();
    const PictureMesh picture = make_picture_mesh(mesh, 2, std::vector<double>{3.0, 4.0}, {}, {1, 0, 1});
    CHECK(picture.patches == std::vector<float>{4.0F, 3.0F, 4.0F});
    CHECK_THROWS_AS(make_picture_mesh(mesh, 2, std::vector<double>{3.0, 4.0}, {}, {0, 1, 2}),
                    InvalidArgument);
    CHECK_THROWS_AS(make_picture_mesh(mesh, 2, std::vector<double>{3.0}, {}, {0, 0, 0}), InvalidArgument);
}

TEST_CASE("PictureMesh: a covered patch looks like its surroundings, flat too", "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 2.0, 1.0, {2, 1});
    const PatchMesh mesh = builder.mesh();
    const PictureMesh picture =
        make_picture_mesh(mesh, 1, std::vector<double>{4.0, 0.0}, std::vector<double>{0.0, 1.0}, {0, 0, 0});
    CHECK(picture.patches[3] == 4.0F);
}

TEST_CASE("PictureMesh: patches that meet share every bit of their corners", "[display]") {
    // A third of an edge, found from either end, is not the same double.
    SceneBuilder builder;
    builder.add("a", {{0.1, 0, 0}, {1.3, 0.7, 0}, {1.3, 1.9, 0}, {0.1, 1.2, 0}}, {3, 1});
    builder.add("b", {{1.3, 0.7, 0}, {0.1, 0, 0}, {0.1, 0, 1}, {1.3, 0.7, 1}}, {3, 1});
    const PatchMesh mesh = builder.mesh();
    const PictureMesh picture = make_picture_mesh(mesh, 1, std::vector<double>(6, 1.0), {}, {0, 0, 0});
    const auto position = [&](std::size_t patch, std::size_t k) {
        return std::vector<float>(
            picture.positions.begin() + static_cast<std::ptrdiff_t>((patch * 4 + k) * 3),
            picture.positions.begin() + static_cast<std::ptrdiff_t>((patch * 4 + k) * 3 + 3));
    };
    CHECK(position(0, 1) == position(4, 1));
    CHECK(position(1, 1) == position(3, 1));
}

TEST_CASE("AutomaticExposure: lit walls come out bright, whatever the unit and however small the lamp",
          "[display]") {
    const auto bright_wall = [](double lamp_size, double unit) {
        SceneBuilder builder;
        builder.floor("wall", 0.0, 0.0, 1.0, 1.0, {8, 8});
        builder.floor("lamp", 2.0, 0.0, 2.0 + lamp_size, lamp_size);
        const PatchMesh mesh = builder.mesh();
        std::vector<double> radiosity(mesh.size(), 20.0 * unit);
        std::vector<double> exitance(mesh.size(), 0.0);
        radiosity.back() = exitance.back() = 5000.0 * unit;
        const PictureMesh picture = make_picture_mesh(mesh, 1, radiosity, {}, {0, 0, 0});
        return 20.0 * unit * automatic_exposure(mesh, picture, {}, exitance, 1);
    };
    for (const double lamp : {0.001, 0.1, 1.0}) {
        for (const double unit : {1e-6, 1.0, 1e6}) {
            CHECK(bright_wall(lamp, unit) == Approx(0.6).epsilon(1e-5));
        }
    }
}

TEST_CASE("AutomaticExposure: covered patches and the dark do not count", "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 10.0, 1.0, {10, 1});
    const PatchMesh mesh = builder.mesh();
    std::vector<double> radiosity(10, 2.0);
    std::vector<double> blocked(10, 0.0);
    radiosity[0] = 1000.0;
    blocked[0] = 1.0;
    radiosity[1] = radiosity[2] = 0.0;
    const PictureMesh picture = make_picture_mesh(mesh, 1, radiosity, blocked, {0, 0, 0});
    CHECK(automatic_exposure(mesh, picture, blocked, {}, 1) == Approx(0.3));
    const PictureMesh dark = make_picture_mesh(mesh, 1, std::vector<double>(10, 0.0), {}, {0, 0, 0});
    CHECK(automatic_exposure(mesh, dark, {}, {}, 1) == 1.0);
}

TEST_CASE("AutomaticExposure: where every surface glows, the glow is what is shown", "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 1.0, 1.0, {2, 2});
    const PatchMesh mesh = builder.mesh();
    const PictureMesh picture = make_picture_mesh(mesh, 1, std::vector<double>(4, 300.0), {}, {0, 0, 0});
    CHECK(automatic_exposure(mesh, picture, {}, std::vector<double>(4, 100.0), 1) == Approx(0.6 / 300.0));
}

TEST_CASE("EvenLight: goes with the reflectance, differs by direction, and shows black surfaces, too",
          "[display]") {
    SceneBuilder builder;
    builder.floor("floor", 0.0, 0.0, 1.0, 1.0, {2, 1});
    builder.add("wall", {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}});
    const PatchMesh mesh = builder.mesh();
    const std::vector<double> light = even_light(mesh, std::vector<double>{1.0, 0.0, 0.5, 0.5, 0.5, 0.5}, 2);
    REQUIRE(light.size() == 6);
    CHECK(light[1] == Approx(0.2 * light[0]));
    CHECK(light[1] > 0.0);
    CHECK(light[2] == Approx(0.6 * light[0]));
    CHECK(light[3] == light[2]);
    CHECK(light[2] > 1.2 * light[4]); // more comes from above
    CHECK_THROWS_AS(even_light(mesh, std::vector<double>(5), 2), InvalidArgument);
}

TEST_CASE("DefaultCamera: has the whole scene in view", "[display]") {
    Bounds bounds;
    bounds.add({-3.0, 100.0, 5.0});
    bounds.add({40.0, 120.0, 9.0});
    const Camera camera = default_camera(bounds);
    const Vec3 forward = glm::normalize(camera.target - camera.eye);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 point((corner & 1) != 0 ? bounds.upper.x : bounds.lower.x,
                         (corner & 2) != 0 ? bounds.upper.y : bounds.lower.y,
                         (corner & 4) != 0 ? bounds.upper.z : bounds.lower.z);
        const double cosine = glm::dot(glm::normalize(point - camera.eye), forward);
        CHECK(std::acos(cosine) <= 0.5 * camera.fov * std::numbers::pi / 180.0 + 1e-9);
    }
    CHECK(std::isfinite(default_camera(Bounds{}).eye.x));
}

TEST_CASE("DefaultCamera: of a scene with y upwards it is that of the same scene with z upwards, turned",
          "[display]") {
    Bounds upright;
    upright.add({-3.0, 1.0, 5.0});
    upright.add({40.0, 12.0, 9.0});
    Bounds turned;
    turned.add(turned_upright(upright.lower, UpAxis::y));
    turned.add(turned_upright(upright.upper, UpAxis::y));
    const Camera expected = default_camera(upright);
    const Camera camera = default_camera(turned, UpAxis::y);
    CHECK(glm::distance(camera.eye, turned_upright(expected.eye, UpAxis::y)) < 1e-12);
    CHECK(glm::distance(camera.target, turned_upright(expected.target, UpAxis::y)) < 1e-12);
    CHECK(camera.up == Vec3(0.0, 1.0, 0.0));
    CHECK(expected.up == Vec3(0.0, 0.0, 1.0));
}
