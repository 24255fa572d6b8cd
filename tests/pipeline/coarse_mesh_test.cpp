#include "hemi/pipeline/coarse_mesh.hpp"

#include "support/in_triangles.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

using namespace hemi;
using namespace hemi::test;

TEST_CASE("coarse mesh: some 400 patches, of quadrilaterals as of triangles", "[pipeline]") {
    Scene room = empty_scene();
    add_room(room, Vec3(0, 0, 0), Vec3(5, 4, 3), 20); // its own 2,400 do not count
    const std::uint32_t quadrilaterals = coarse_mesh(room).mesh.size();
    const std::uint32_t triangles = coarse_mesh(in_triangles(room)).mesh.size();
    CHECK(quadrilaterals >= 400);
    CHECK(quadrilaterals < 500);
    CHECK(triangles >= 400);
    CHECK(triangles < 500);
}

TEST_CASE("coarse mesh: needles, which are cut by their longest edges, take no more patches", "[pipeline]") {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)});
    for (int k = 0; k < 10; ++k) {
        const double y = 0.1 * k;
        add_polygon(scene, "needles", {Vec3(0, y, 1), Vec3(40, y, 1), Vec3(0, y + 1e-5, 1)});
    }
    CHECK(coarse_mesh(scene).mesh.size() < 500);
}

TEST_CASE("coarse mesh: what shines has 4 x 4 patches, unless that is much", "[pipeline]") {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {Vec3(0, 0, 0), Vec3(9, 0, 0), Vec3(9, 9, 0), Vec3(0, 9, 0)});
    scene.materials.push_back(scene.materials[0]);
    scene.materials[1].exitance = {1.0};
    const auto patches_of_lamps = [&scene](int lamps) {
        Scene lit = scene;
        for (int k = 0; k < lamps; ++k) {
            const double x = 0.01 * k;
            add_polygon(lit, "lamps",
                        {Vec3(x, 0, 1), Vec3(x, 0.001, 1), Vec3(x + 0.001, 0.001, 1), Vec3(x + 0.001, 0, 1)});
            lit.surfaces.back().material = 1;
        }
        const PatchMesh mesh = coarse_mesh(lit).mesh;
        return mesh.patches_per_side(static_cast<std::uint32_t>(lit.surfaces.size() - 1));
    };
    CHECK(patches_of_lamps(1) == 16);
    CHECK(patches_of_lamps(25) == 16);
    CHECK(patches_of_lamps(100) == 4);
    CHECK(patches_of_lamps(500) == 1);
}
