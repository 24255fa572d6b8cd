#include "scene/enclosed_space.hpp"

#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace hemi;
using namespace hemi::test;

namespace {

/// Names of the groups that have an enclosed patch, and of those that have one that is not.
struct Found {
    std::vector<std::string> enclosed;
    std::vector<std::string> others;
};

Found look_at(const Scene& scene) {
    const PatchMesh mesh(scene);
    const EnclosedSpace space(mesh);
    Found found;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        std::vector<std::string>& names = space.encloses(i) ? found.enclosed : found.others;
        names.push_back(mesh.groups()[mesh.group(i)]);
    }
    for (std::vector<std::string>* names : {&found.enclosed, &found.others}) {
        std::sort(names->begin(), names->end());
        names->erase(std::unique(names->begin(), names->end()), names->end());
    }
    return found;
}

const std::vector<std::string> walls{"x0", "x1", "y0", "y1", "z0", "z1"};

Scene room() {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(2.0, 2.0, 1.0), 3);
    return scene;
}

void add_turned(Scene& scene, const std::string& group, std::vector<Vec3> polygon) {
    std::reverse(polygon.begin(), polygon.end());
    add_polygon(scene, group, std::move(polygon));
}

const std::vector<Vec3> east{Vec3(2, 0, 0), Vec3(2, 0, 1), Vec3(2, 2, 1), Vec3(2, 2, 0)};

} // namespace

TEST_CASE("EnclosedSpace: walls that meet at all edges, in T-junctions too, enclose what is in them",
          "[scene]") {
    CHECK(look_at(room()).enclosed == walls);
    CHECK(look_at(room()).others.empty());
    CHECK(look_at(rotated(room())).enclosed == walls);
    CHECK(look_at(t_junction_room()).others.empty());
    CHECK(look_at(lattice_room()).others.empty());
    CHECK(look_at(tapered_box(2)).others.empty());
    CHECK(look_at(two_rooms()).others.empty());
    Scene furnished = room();
    add_block(furnished, "block", Vec3(0.5), Vec3(0.75), 1);
    CHECK(look_at(furnished).others.empty());
}

TEST_CASE("EnclosedSpace: what a wall lacks opens it", "[scene]") {
    CHECK(look_at(open_corner()).enclosed.empty());
    CHECK(EnclosedSpace(PatchMesh(open_corner())).empty());
    for (const double gap : {1e-5, 1e-2}) {
        Scene scene = room();
        for (Surface& surface : scene.surfaces) {
            if (scene.groups[surface.group] == "x1") {
                for (Vec3& vertex : surface.vertices) {
                    vertex.x += gap;
                }
            }
        }
        CHECK(look_at(scene).enclosed.empty());
    }
}

TEST_CASE("EnclosedSpace: sheets that stand in a room are enclosed and leave it closed", "[scene]") {
    Scene scene = room();
    add_polygon(scene, "screen", {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(1, 0, 1)});
    scene.surfaces.back().two_sided = true;
    add_polygon(scene, "along an edge", {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 0.3, 0.3), Vec3(0, 0.3, 0.3)});
    CHECK(look_at(scene).others.empty());
}

TEST_CASE("EnclosedSpace: what looks out of a closed room is not enclosed", "[scene]") {
    Scene lamp = room();
    add_turned(lamp, "lamp", east);
    CHECK(look_at(lamp).enclosed == walls);
    CHECK(look_at(lamp).others == std::vector<std::string>{"lamp"});

    Scene both = room();
    add_block(both, "outside", Vec3(0.0), Vec3(2.0, 2.0, 1.0), 2);
    CHECK(look_at(both).enclosed == walls);
    CHECK(look_at(both).others == std::vector<std::string>{"outside"});

    Scene beside = room();
    add_block(beside, "beside", Vec3(3.0, 0.0, 0.0), Vec3(4.0, 1.0, 1.0), 1);
    CHECK(look_at(beside).others == std::vector<std::string>{"beside"});
}
