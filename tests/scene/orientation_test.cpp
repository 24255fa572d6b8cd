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

TEST_CASE("make_bodies_one_sided: a room that holds all keeps its inside, what is in it its outside",
          "[scene]") {
    Scene scene;
    scene.groups = {"all"};
    add_cube(scene, Vec3(0, 0, 0), 5.0);
    add_cube(scene, Vec3(1, 1, 0), 1.0); // on the floor
    turn_round(scene.surfaces[2]);
    turn_round(scene.surfaces[8]);
    scene.surfaces.emplace_back().vertices = {Vec3(2, 2, 4.9), Vec3(2, 3, 4.9), Vec3(3, 3, 4.9),
                                              Vec3(3, 2, 4.9)};
    for (Surface& surface : scene.surfaces) {
        surface.two_sided = true;
    }
    Scene kept = scene;
    const OneSidedBodies found = make_bodies_one_sided(scene, {true});
    CHECK(found.inwards == 1);
    CHECK(found.outwards == 1);
    CHECK(found.faces == 12);
    CHECK(six_volumes(scene, 0) == Approx(-6.0 * 125.0));
    CHECK(six_volumes(scene, 6) == Approx(6.0));
    for (std::size_t s = 0; s < 12; ++s) {
        CHECK_FALSE(scene.surfaces[s].two_sided);
    }
    CHECK(scene.surfaces[12].two_sided); // a lamp without thickness
    CHECK(make_bodies_one_sided(kept, {false}).faces == 0);
    CHECK(kept.surfaces[0].two_sided);
}

TEST_CASE("make_bodies_one_sided: bodies of which both sides may meet something stay", "[scene]") {
    const auto faces_of = [](Scene scene) {
        scene.groups = {"all"};
        for (Surface& surface : scene.surfaces) {
            surface.two_sided = true;
        }
        return make_bodies_one_sided(scene, {true}).faces;
    };
    Scene room;
    add_cube(room, Vec3(0, 0, 0), 5.0);
    CHECK(faces_of(room) == 6); // alone: a room
    Scene two = room;
    add_cube(two, Vec3(9, 0, 0), 5.0);
    CHECK(faces_of(two) == 0); // rooms, or blocks
    Scene nested = room;
    add_cube(nested, Vec3(1, 1, 1), 3.0);
    add_cube(nested, Vec3(2, 2, 2), 1.0);
    CHECK(faces_of(nested) == 12); // the one in the middle has something on both sides
    Scene open = room;
    open.surfaces.pop_back();
    CHECK(faces_of(open) == 0);
    Scene ground = room;
    ground.surfaces.emplace_back().vertices = {Vec3(-9, -9, 0), Vec3(9, -9, 0), Vec3(9, 9, 0),
                                               Vec3(-9, 9, 0)};
    CHECK(faces_of(ground) == 0);
    Scene pierced = room;
    add_cube(pierced, Vec3(1, 1, 1), 2.0);
    pierced.surfaces.emplace_back().vertices = {Vec3(2, 2, 2), Vec3(4, 2, 2), Vec3(4, 2.5, 2),
                                                Vec3(2, 2.5, 2)};
    CHECK(faces_of(pierced) == 6);
    // An angle bracket, alone: both of its sides see themselves.
    Scene bracket;
    const std::array<Vec3, 6> outline{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 1, 0),
                                      Vec3(1, 1, 0), Vec3(1, 2, 0), Vec3(0, 2, 0)};
    const Vec3 up(0, 0, 1);
    for (std::size_t k = 0; k < 6; ++k) {
        const Vec3& a = outline[k];
        const Vec3& b = outline[(k + 1) % 6];
        bracket.surfaces.emplace_back().vertices = {a, b, b + up, a + up};
    }
    for (const Vec3& shift : {Vec3(0.0), up}) {
        for (const auto& triangle :
             {std::array{0, 1, 2}, std::array{0, 2, 3}, std::array{0, 3, 4}, std::array{0, 4, 5}}) {
            Surface& surface = bracket.surfaces.emplace_back();
            surface.vertex_count = 3;
            for (std::size_t k = 0; k < 3; ++k) {
                surface.vertices[k] = outline[static_cast<std::size_t>(triangle[k])] + shift;
            }
        }
    }
    CHECK(faces_of(bracket) == 0);
}

} // namespace hemi
