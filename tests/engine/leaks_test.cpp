#include "hemi/engine/leaks.hpp"

#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <numeric>

using namespace hemi;
using namespace hemi::test;

namespace {

std::vector<std::uint32_t> all(const PatchMesh& mesh) {
    std::vector<std::uint32_t> patches(mesh.size());
    std::iota(patches.begin(), patches.end(), 0U);
    return patches;
}

} // namespace

TEST_CASE("leak_directions: nothing leaves a closed room", "[engine]") {
    Scene scene = empty_scene();
    add_room(scene, {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}, 2);
    const PatchMesh mesh(scene);
    for (const auto& direction : leak_directions(mesh, all(mesh))) {
        CHECK_FALSE(direction);
    }
}

TEST_CASE("leak_directions: they point from every patch to the hole", "[engine]") {
    // A ceiling of four strips around a hole of a twentieth of its edge.
    constexpr double lower = 0.7;
    constexpr double upper = 0.75;
    Scene scene = empty_scene();
    add_room(scene, {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}, 3);
    scene.surfaces.erase(scene.surfaces.begin() + 5); // z1
    const auto strip = [&](double x0, double x1, double y0, double y1) {
        add_polygon(scene, "ceiling", {{x0, y1, 1.0}, {x1, y1, 1.0}, {x1, y0, 1.0}, {x0, y0, 1.0}});
    };
    strip(0.0, 1.0, 0.0, lower);
    strip(0.0, 1.0, upper, 1.0);
    strip(0.0, lower, lower, upper);
    strip(upper, 1.0, lower, upper);
    const PatchMesh mesh(scene);
    std::vector<std::uint32_t> below;
    for (const std::uint32_t patch : all(mesh)) {
        if (mesh.centres()[patch].z < 0.9) {
            below.push_back(patch);
        }
    }
    const auto directions = leak_directions(mesh, below);
    const Vec3 hole(0.5 * (lower + upper), 0.5 * (lower + upper), 1.0);
    for (std::size_t k = 0; k < below.size(); ++k) {
        INFO("patch " << below[k]);
        REQUIRE(directions[k]);
        CHECK(glm::length(*directions[k]) == Approx(1.0));
        const Vec3 wanted = glm::normalize(hole - mesh.centres()[below[k]]);
        // Patches are a third of an edge: their points see the hole from different sides.
        CHECK(glm::dot(*directions[k], wanted) > 0.9);
    }
}
