#include "hemi/scene/orientation.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>

namespace hemi {

namespace {

/// Six squares that look outwards.
void add_cube(Scene& scene, const Vec3& corner, double edge) {
    const auto at = [&](double x, double y, double z) { return corner + edge * Vec3(x, y, z); };
    const std::array<std::array<Vec3, 4>, 6> faces{{{at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0)},
                                                    {at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)},
                                                    {at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1)},
                                                    {at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1)},
                                                    {at(1, 1, 0), at(0, 1, 0), at(0, 1, 1), at(1, 1, 1)},
                                                    {at(0, 1, 0), at(0, 0, 0), at(0, 0, 1), at(0, 1, 1)}}};
    for (const auto& face : faces) {
        scene.surfaces.emplace_back().vertices = face;
    }
}

/// Six times the volume of a cube's faces, positive if they look outwards.
double six_volumes(const Scene& scene, std::size_t first) {
    double sum = 0.0;
    for (std::size_t s = first; s < first + 6; ++s) {
        sum += 2.0 * glm::dot(scene.surfaces[s].vertices[0], area_vector(scene.surfaces[s].polygon()));
    }
    return sum;
}

} // namespace

TEST_CASE("orientation: a cube with any faces turned is turned to the inside or the outside as a whole",
          "[scene]") {
    for (unsigned turned = 0; turned < 64; ++turned) {
        Scene scene;
        add_cube(scene, Vec3(5, -3, 2), 1.0);
        for (std::size_t s = 0; s < 6; ++s) {
            if ((turned >> s & 1u) != 0) {
                turn_round(scene.surfaces[s]);
            }
        }
        Scene other = scene;
        const OrientedFaces out = orient(scene, Orientation::out);
        CHECK(six_volumes(scene, 0) == Approx(6.0));
        const OrientedFaces in = orient(other, Orientation::in);
        CHECK(six_volumes(other, 0) == Approx(-6.0));
        CHECK(in.turned + out.turned == 6);
        CHECK(in.undecided == 0);
        CHECK(orient(other, Orientation::in).turned == 0);
    }
}

TEST_CASE("orientation: what stands in a room looks away from itself, and so on inwards", "[scene]") {
    Scene scene;
    add_cube(scene, Vec3(0.0), 10.0);
    add_cube(scene, Vec3(1, 1, 0), 4.0); // stands on the floor
    add_cube(scene, Vec3(2, 2, 1), 1.0); // a cavity in it
    add_cube(scene, Vec3(20, 0, 0), 2.0);
    orient(scene, Orientation::in);
    CHECK(six_volumes(scene, 0) < 0.0);
    CHECK(six_volumes(scene, 6) > 0.0);
    CHECK(six_volumes(scene, 12) < 0.0);
    CHECK(six_volumes(scene, 18) < 0.0);
    orient(scene, Orientation::out);
    CHECK(six_volumes(scene, 0) > 0.0);
    CHECK(six_volumes(scene, 6) < 0.0);
    CHECK(six_volumes(scene, 18) > 0.0);
}

TEST_CASE("orientation: an open box is turned by the side of its opening, a sheet and two-sided faces stay",
          "[scene]") {
    Scene scene;
    add_cube(scene, Vec3(0.0), 1.0);
    scene.surfaces.erase(scene.surfaces.begin() + 1); // the lid
    turn_round(scene.surfaces[2]);
    Surface sheet;
    sheet.vertices = {Vec3(3, 0, 0), Vec3(4, 0, 0), Vec3(4, 1, 0), Vec3(3, 1, 0)};
    scene.surfaces.push_back(sheet);
    sheet.two_sided = true;
    scene.surfaces.push_back(sheet);
    const OrientedFaces done = orient(scene, Orientation::in);
    CHECK(done.turned == 4);
    CHECK(done.undecided == 1);
    CHECK(area_vector(scene.surfaces[0].polygon()).z == 1.0);
    CHECK(area_vector(scene.surfaces[2].polygon()).x == -1.0);
    CHECK(area_vector(scene.surfaces[5].polygon()).z == 1.0);
}

TEST_CASE("orientation: faces of watertight bodies that are turned against the others are found", "[scene]") {
    Scene scene;
    add_cube(scene, Vec3(0.0), 1.0);
    CHECK(turned_against_others(scene).empty());
    turn_round(scene.surfaces[3]);
    CHECK(turned_against_others(scene) == std::vector<std::uint32_t>{3});
    turn_round(scene.surfaces[1]);
    CHECK(turned_against_others(scene) == std::vector<std::uint32_t>{1, 3});
    for (Surface& surface : scene.surfaces) {
        turn_round(surface);
    }
    CHECK(turned_against_others(scene) == std::vector<std::uint32_t>{1, 3});
    scene.surfaces.pop_back(); // not watertight: an edge of one face says nothing
    CHECK(turned_against_others(scene).empty());
}

TEST_CASE("orientation: a grid stays where it is on a face that is turned", "[scene]") {
    Surface surface;
    surface.vertices = {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 1, 0), Vec3(0, 1, 0)};
    surface.patches = Grid{4, 1};
    turn_round(surface);
    CHECK(area_vector(surface.polygon()).z == -2.0);
    CHECK(surface.vertices[3] == Vec3(2, 0, 0));
    CHECK(*surface.patches == Grid{1, 4});
}

} // namespace hemi
