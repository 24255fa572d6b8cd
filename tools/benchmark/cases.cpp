#include "benchmark/cases.hpp"

#include "hemi/core/diagnostics.hpp"
#include "hemi/io/scene_reader.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace hemi::bench {

namespace {

void add_surface(Scene& scene, const std::array<Vec3, 4>& corners) {
    Surface surface;
    surface.vertices = corners;
    scene.surfaces.push_back(surface);
}

/// The corners of a box turned about the vertical, bottom before top, each counter-clockwise from above.
std::array<Vec3, 8> box_corners(const Vec3& centre_of_base, const Vec3& size, double degrees) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const Vec3 along = 0.5 * size.x * Vec3(std::cos(angle), std::sin(angle), 0.0);
    const Vec3 across = 0.5 * size.y * Vec3(-std::sin(angle), std::cos(angle), 0.0);
    const Vec3 height(0.0, 0.0, size.z);
    std::array<Vec3, 8> corners{};
    corners[0] = centre_of_base - along - across;
    corners[1] = centre_of_base + along - across;
    corners[2] = centre_of_base + along + across;
    corners[3] = centre_of_base - along + across;
    for (std::size_t k = 0; k < 4; ++k) {
        corners[k + 4] = corners[k] + height;
    }
    return corners;
}

void add_block(Scene& scene, const std::array<Vec3, 8>& c) {
    add_surface(scene, {c[4], c[5], c[6], c[7]});
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t next = (k + 1) % 4;
        add_surface(scene, {c[k], c[next], c[next + 4], c[k + 4]});
    }
}

void add_walls(Scene& scene, const std::array<Vec3, 8>& c) {
    add_surface(scene, {c[0], c[1], c[2], c[3]});
    add_surface(scene, {c[7], c[6], c[5], c[4]});
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t next = (k + 1) % 4;
        add_surface(scene, {c[next], c[k], c[k + 4], c[next + 4]});
    }
}

Scene room_scene() {
    Scene scene;
    scene.materials.push_back({"grey", {0.5}, {0.0}});
    scene.groups = {"room"};
    add_walls(scene, box_corners({0.0, 0.0, 0.0}, {1.0, 1.02, 0.98}, 0.0));
    add_block(scene, box_corners({-0.17, 0.13, 0.0}, {0.29, 0.30, 0.60}, 17.0));
    add_block(scene, box_corners({0.19, -0.16, 0.0}, {0.30, 0.29, 0.30}, -16.0));
    return scene;
}

} // namespace

Case make_room(std::uint32_t patches) {
    const Scene scene = room_scene();
    double coarse = 1.0; // patch sizes that give fewer patches, and at least as many
    double fine = 1e-3;
    for (int step = 0; step < 24; ++step) {
        const double size = std::sqrt(coarse * fine);
        (PatchMesh(scene, {size, {}}).size() < patches ? coarse : fine) = size;
    }
    return {"room", PatchMesh(scene, {fine, {}})};
}

Case read_case(const std::filesystem::path& scene_file) {
    Diagnostics diagnostics;
    return {scene_file.stem().string(), PatchMesh(io::read_scene(scene_file, {}, diagnostics))};
}

} // namespace hemi::bench
