#include "display/orbit_camera.hpp"

#include "display/display_fixtures.hpp"
#include "display/visible_point.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace hemi;
using hemi::test::SceneBuilder;

namespace {

Bounds unit_bounds() {
    Bounds bounds;
    bounds.add({-1, -1, -1});
    bounds.add({1, 1, 1});
    return bounds;
}

Camera from_front() {
    return {{0, -5, 0}, {0, 0, 0}, {0, 0, 1}, 40.0};
}

bool same(const Camera& a, const Camera& b) {
    return a.eye == b.eye && a.target == b.target && a.up == b.up && a.fov == b.fov;
}

/// Where a point appears, in heights of the picture from its centre.
std::array<double, 2> on_screen(const Camera& camera, const Vec3& point) {
    const Vec3 forward = glm::normalize(camera.target - camera.eye);
    const Vec3 right = glm::normalize(glm::cross(forward, camera.up));
    const Vec3 up = glm::cross(right, forward);
    const Vec3 offset = point - camera.eye;
    const double scale = 2.0 * std::tan(camera.fov * std::numbers::pi / 360.0) * glm::dot(offset, forward);
    return {glm::dot(offset, right) / scale, glm::dot(offset, up) / scale};
}

void check_near(const Vec3& a, const Vec3& b, double tolerance = 1e-12) {
    INFO("(" << a.x << ", " << a.y << ", " << a.z << ") and (" << b.x << ", " << b.y << ", " << b.z << ")");
    CHECK(glm::length(a - b) <= tolerance);
}

} // namespace

TEST_CASE("OrbitCamera: until it is moved it is the camera it was given", "[display]") {
    const Camera odd{{1, 2, 3}, {0.3, 0.1, 0.7}, {0.2, 0.1, 3.0}, 33.0};
    OrbitCamera orbit(odd, unit_bounds());
    CHECK(same(orbit.camera(), odd));
    orbit.grab({0, 0, 0});
    CHECK(same(orbit.camera(), odd));
}

TEST_CASE("OrbitCamera: a hand that returns within a gesture brings back the same bits", "[display]") {
    const Camera odd{{1, 2, 3}, {0.3, 0.1, 0.7}, {0.2, 0.1, 3.0}, 33.0};
    OrbitCamera orbit(odd, unit_bounds());
    orbit.grab({0.1, 0.2, -0.4});
    orbit.orbit(1.0, 0.4);
    orbit.orbit(-2.0, 50.0); // far beyond the pole
    CHECK_FALSE(same(orbit.camera(), odd));
    orbit.orbit(0.0, 0.0);
    CHECK(same(orbit.camera(), odd));
    orbit.pan(0.3, 0.2);
    orbit.pan(0.0, 0.0);
    CHECK(same(orbit.camera(), odd));
    orbit.zoom(3.0);
    orbit.zoom(1.0);
    CHECK(same(orbit.camera(), odd));
}

TEST_CASE("OrbitCamera: two opposite gestures about one pivot return to the start", "[display]") {
    OrbitCamera orbit(from_front(), unit_bounds());
    const Vec3 pivot(0.5, -1.0, 0.25);
    orbit.grab(pivot);
    orbit.orbit(0.8, 0.0);
    orbit.grab(pivot);
    orbit.orbit(-0.8, 0.0);
    check_near(orbit.camera().eye, from_front().eye);
    check_near(orbit.camera().target, from_front().target);
    orbit.grab(pivot);
    orbit.orbit(0.0, 0.5);
    orbit.grab(pivot);
    orbit.orbit(0.0, -0.5);
    check_near(orbit.camera().eye, from_front().eye);
}

TEST_CASE("OrbitCamera: the scene follows the hand, and the pivot keeps its place on the screen",
          "[display]") {
    OrbitCamera orbit(from_front(), unit_bounds());
    const Vec3 pivot(0.7, -0.9, 0.3);
    const auto before = on_screen(orbit.camera(), pivot);
    const auto front_before = on_screen(orbit.camera(), {0, -1, 0});
    orbit.grab(pivot);
    orbit.orbit(0.6, 0.3);
    const auto after = on_screen(orbit.camera(), pivot);
    CHECK(after[0] == Approx(before[0]).margin(1e-12));
    CHECK(after[1] == Approx(before[1]).margin(1e-12));
    CHECK(orbit.camera().up.z > 0.0);

    orbit.reset();
    orbit.grab({0, 0, 0});
    orbit.orbit(0.2, 0.0);
    CHECK(on_screen(orbit.camera(), {0, -1, 0})[0] > front_before[0]); // dragged right, goes right
    orbit.orbit(0.0, 0.2);
    CHECK(on_screen(orbit.camera(), {0, -1, 0})[1] < front_before[1]); // tipped: seen more from above
    CHECK(orbit.camera().eye.z > 0.0);
}

TEST_CASE("OrbitCamera: it stops over the pole, does not roll over, and turns on from there", "[display]") {
    OrbitCamera orbit(from_front(), unit_bounds());
    orbit.grab({0, 0, 0});
    orbit.orbit(0.0, 10.0);
    check_near(orbit.camera().eye, {0, 0, 5});
    check_near(orbit.camera().up, {0, 1, 0});
    // At the pole itself a turn across still means a turn about the upward axis.
    orbit.grab({0, 0, 0});
    orbit.orbit(0.5 * std::numbers::pi, 0.0);
    check_near(orbit.camera().eye, {0, 0, 5});
    check_near(orbit.camera().up, {1, 0, 0});
    // And down again, on the side that was turned to.
    orbit.grab({0, 0, 0});
    orbit.orbit(0.0, -0.5 * std::numbers::pi);
    check_near(orbit.camera().eye, {-5, 0, 0});
    check_near(orbit.camera().up, {0, 0, 1});
    // A small step does not jump near the pole.
    orbit.grab({0, 0, 0});
    orbit.orbit(0.0, 0.5 * std::numbers::pi - 1e-4);
    const Camera near_pole = orbit.camera();
    orbit.grab({0, 0, 0});
    orbit.orbit(0.0, 2e-4);
    CHECK(glm::length(orbit.camera().eye - near_pole.eye) < 1e-2);
    CHECK(glm::length(orbit.camera().up - near_pole.up) < 1e-2);
}

TEST_CASE("OrbitCamera: the other pole stops it too", "[display]") {
    OrbitCamera orbit(from_front(), unit_bounds());
    orbit.grab({0, 0, 0});
    orbit.orbit(0.0, -10.0);
    check_near(orbit.camera().eye, {0, 0, -5});
    check_near(orbit.camera().up, {0, -1, 0}, 1e-9);
}

TEST_CASE("OrbitCamera: panning keeps the grabbed point under the hand", "[display]") {
    OrbitCamera orbit(from_front(), unit_bounds());
    const Vec3 point(0.4, -0.8, -0.2);
    const auto before = on_screen(orbit.camera(), point);
    orbit.grab(point);
    orbit.pan(0.21, -0.13);
    const auto after = on_screen(orbit.camera(), point);
    CHECK(after[0] == Approx(before[0] + 0.21));
    CHECK(after[1] == Approx(before[1] - 0.13));
}

TEST_CASE("OrbitCamera: zooming keeps the point under the cursor and scales its distance", "[display]") {
    OrbitCamera orbit(from_front(), unit_bounds());
    const Vec3 point(0.4, -0.8, -0.2);
    const auto before = on_screen(orbit.camera(), point);
    const double distance = glm::length(point - orbit.camera().eye);
    orbit.grab(point);
    orbit.zoom(0.5);
    const auto after = on_screen(orbit.camera(), point);
    CHECK(after[0] == Approx(before[0]));
    CHECK(after[1] == Approx(before[1]));
    CHECK(glm::length(point - orbit.camera().eye) == Approx(0.5 * distance));
    for (int i = 0; i < 2000; ++i) { // no way to zoom until nothing is left of the view's direction
        orbit.grab(orbit.camera().target);
        orbit.zoom(0.5);
    }
    CHECK(glm::length(orbit.camera().target - orbit.camera().eye) > 1e-7);
}

TEST_CASE("OrbitCamera: rays run through the points that appear there", "[display]") {
    const OrbitCamera orbit({{3, -4, 2}, {0, 0.5, 0}, {0.1, 0, 1}, 50.0}, unit_bounds());
    const Vec3 point(0.3, -0.2, 0.6);
    const auto place = on_screen(orbit.camera(), point);
    const ViewRay ray = orbit.ray(place[0], place[1]);
    CHECK(glm::length(glm::cross(glm::normalize(ray.direction), glm::normalize(point - ray.origin))) < 1e-12);
}

TEST_CASE("OrbitCamera: framing and axis views have the whole scene in the picture", "[display]") {
    OrbitCamera orbit({{30, 1, 2}, {31, 1, 2}, {0, 0, 1}, 40.0}, unit_bounds());
    const auto check_all_in_view = [&](double aspect) {
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 point((corner & 1) * 2 - 1, (corner & 2) - 1, (corner & 4) / 2 - 1);
            const auto place = on_screen(orbit.camera(), point);
            CHECK(std::abs(place[0]) <= 0.5 * aspect + 1e-12);
            CHECK(std::abs(place[1]) <= 0.5 + 1e-12);
        }
    };
    for (const double aspect : {0.4, 1.0, 2.5}) {
        orbit.frame_all(aspect);
        check_all_in_view(aspect);
        for (const auto axis : {OrbitCamera::Axis::front, OrbitCamera::Axis::right, OrbitCamera::Axis::top}) {
            orbit.look_along(axis, false, aspect);
            check_all_in_view(aspect);
        }
    }
    orbit.look_along(OrbitCamera::Axis::front, false, 1.0);
    CHECK(orbit.camera().eye.y < -1.0);
    orbit.look_along(OrbitCamera::Axis::right, false, 1.0);
    CHECK(orbit.camera().eye.x > 1.0);
    orbit.look_along(OrbitCamera::Axis::top, false, 1.0);
    CHECK(orbit.camera().eye.z > 1.0);
    orbit.reset();
    CHECK(orbit.camera().eye == Vec3(30, 1, 2));
}

TEST_CASE("OrbitCamera: axis views go by the axis that is upwards", "[display]") {
    OrbitCamera orbit({{5, 1, 2}, {0, 0, 0}, {0, 1, 0}, 40.0}, unit_bounds());
    orbit.look_along(OrbitCamera::Axis::front, false, 1.0);
    CHECK(orbit.camera().eye.z > 1.0);
    CHECK(orbit.camera().up == Vec3(0, 1, 0));
    orbit.look_along(OrbitCamera::Axis::right, false, 1.0);
    CHECK(orbit.camera().eye.x > 1.0);
    orbit.look_along(OrbitCamera::Axis::top, false, 1.0);
    CHECK(orbit.camera().eye.y > 1.0);
}

TEST_CASE("VisiblePoint: finds the nearest front side and passes through backs", "[display]") {
    SceneBuilder builder;
    builder.floor("low", 0.0, 0.0, 1.0, 1.0);
    builder.add("mid", {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}); // faces down
    const PatchMesh mesh = builder.mesh();
    const auto down = visible_point(mesh, {0.3, 0.4, 5.0}, {0, 0, -2});
    REQUIRE(down);
    check_near(down->position, {0.3, 0.4, 0.0});
    const auto up = visible_point(mesh, {0.3, 0.4, -5.0}, {0, 0, 1});
    REQUIRE(up);
    check_near(up->position, {0.3, 0.4, 1.0});
    CHECK_FALSE(visible_point(mesh, {1.3, 0.4, 5.0}, {0, 0, -1}));
    CHECK_FALSE(visible_point(mesh, {0.3, 0.4, 5.0}, {0, 0, 1}));

    builder.scene.surfaces[1].two_sided = true;
    const auto sheet = visible_point(builder.mesh(), {0.3, 0.4, 5.0}, {0, 0, -1});
    REQUIRE(sheet);
    check_near(sheet->position, {0.3, 0.4, 1.0});
    CHECK(sheet->surface == 1);
    CHECK(sheet->back); // it faces down

    builder.scene.surfaces[1].patches = Grid{4, 2};
    const PatchMesh cut = builder.mesh();
    const std::uint32_t patch = patch_at(cut, *visible_point(cut, {0.3, 0.4, 5.0}, {0, 0, -1}));
    CHECK(cut.is_back(patch));
    CHECK(distance_to_polygon({0.3, 0.4, 1.0}, cut.corners(patch).polygon()) == 0.0);
}

TEST_CASE("OrbitCamera: a line is seen where rays through its ends leave the eye", "[display]") {
    const Bounds bounds = [] {
        Bounds box;
        box.add({-1.0, -1.0, -1.0});
        box.add({1.0, 1.0, 1.0});
        return box;
    }();
    const OrbitCamera orbit({{0.0, -5.0, 0.5}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 40.0}, bounds);
    const ViewRay a = orbit.ray(-0.3, 0.2);
    const ViewRay b = orbit.ray(0.4, -0.1);
    const auto line = orbit.line(a.origin + 3.0 * a.direction, b.origin + 6.0 * b.direction);
    REQUIRE(line);
    CHECK((*line)[0][0] == Approx(-0.3));
    CHECK((*line)[0][1] == Approx(0.2));
    CHECK((*line)[1][0] == Approx(0.4));
    CHECK((*line)[1][1] == Approx(-0.1));
    CHECK_FALSE(orbit.line(a.origin - a.direction, b.origin - b.direction));
    CHECK(orbit.line(a.origin - a.direction, b.origin + b.direction));
}

TEST_CASE("OrbitCamera: an orthographic one keeps the target's size, its rays are parallel", "[display]") {
    OrbitCamera orbit(from_front(), unit_bounds());
    const ViewRay perspective = orbit.ray(0.3, 0.2);
    orbit.set_orthographic(true);
    const ViewRay a = orbit.ray(0.3, 0.2);
    const ViewRay b = orbit.ray(-0.1, 0.4);
    check_near(a.direction, b.direction);
    check_near(a.origin + (a.origin.y / -a.direction.y) * a.direction,
               perspective.origin + 5.0 * perspective.direction);
    CHECK(a.origin.y < -1.0); // before all of the scene, wherever the eye is
    const auto line = orbit.line(a.origin + 9.0 * a.direction, b.origin);
    REQUIRE(line);
    CHECK((*line)[0][0] == Approx(0.3));
    CHECK((*line)[0][1] == Approx(0.2));
    CHECK((*line)[1][0] == Approx(-0.1));
    CHECK((*line)[1][1] == Approx(0.4));

    const Vec3 pivot = a.origin + 6.0 * a.direction;
    orbit.grab(pivot);
    orbit.zoom(0.5);
    const ViewRay zoomed = orbit.ray(0.3, 0.2);
    CHECK(glm::length(glm::cross(pivot - zoomed.origin, zoomed.direction)) < 1e-12);
    orbit.grab(pivot);
    orbit.pan(0.1, -0.2);
    const ViewRay panned = orbit.ray(0.4, 0.0);
    CHECK(glm::length(glm::cross(pivot - panned.origin, panned.direction)) < 1e-12);
}

TEST_CASE("OrbitCamera: the field of view stays within what can be chosen", "[display]") {
    OrbitCamera orbit(from_front(), unit_bounds());
    orbit.set_fov(70.0);
    CHECK(orbit.camera().fov == 70.0);
    CHECK(orbit.camera().eye == from_front().eye);
    orbit.set_fov(500.0);
    CHECK(orbit.camera().fov == OrbitCamera::largest_fov);
    orbit.set_fov(-1.0);
    CHECK(orbit.camera().fov == OrbitCamera::smallest_fov);
}

TEST_CASE("OrbitCamera: axis views have a side each to look from", "[display]") {
    OrbitCamera orbit(from_front(), unit_bounds());
    orbit.look_along(OrbitCamera::Axis::front, true, 1.0);
    CHECK(orbit.camera().eye.y > 1.0);
    orbit.look_along(OrbitCamera::Axis::right, true, 1.0);
    CHECK(orbit.camera().eye.x < -1.0);
    orbit.look_along(OrbitCamera::Axis::top, true, 1.0);
    CHECK(orbit.camera().eye.z < -1.0);
}
