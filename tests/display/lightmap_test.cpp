#include "hemi/display/lightmap.hpp"

#include "hemi/core/error.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>

using namespace hemi;
using namespace hemi::test;

namespace {

/// A field that is linear in space, at the corners of all patches.
std::vector<float> field(const PatchMesh& mesh) {
    std::vector<float> values(std::size_t{mesh.size()} * 12);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchCorners corners = mesh.corners(i);
        for (std::size_t k = 0; k < corners.count; ++k) {
            const Vec3& p = corners.points[k];
            values[(i * std::size_t{4} + k) * 3] = static_cast<float>(1.0 + p.x + 2.0 * p.y);
            values[(i * std::size_t{4} + k) * 3 + 1] = static_cast<float>(3.0 - p.y + p.z);
            values[(i * std::size_t{4} + k) * 3 + 2] = 0.5F;
        }
    }
    return values;
}

/// Between the centres of four texels.
float sampled(const Lightmap& map, double u, double v, std::size_t channel) {
    const double x = u * map.size - 0.5;
    const double y = v * map.size - 0.5;
    const auto left = static_cast<std::size_t>(x);
    const auto top = static_cast<std::size_t>(y);
    const auto texel = [&](std::size_t column, std::size_t row) {
        return static_cast<double>(map.texels[(row * map.size + column) * 3 + channel]);
    };
    const double across = x - static_cast<double>(left);
    const double down = y - static_cast<double>(top);
    return static_cast<float>(
        (1.0 - down) * ((1.0 - across) * texel(left, top) + across * texel(left + 1, top)) +
        down * ((1.0 - across) * texel(left, top + 1) + across * texel(left + 1, top + 1)));
}

/// Largest difference of what the texture gives at corners, and between them, from what they have.
double largest_error(const PatchMesh& mesh, const std::vector<float>& values, const Lightmap& map) {
    double largest = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::uint32_t corners = mesh.corners(i).count;
        for (std::uint32_t k = 0; k < corners; ++k) {
            const std::size_t here = std::size_t{i} * 4 + k;
            const std::size_t next = std::size_t{i} * 4 + (k + 1) % corners;
            for (std::size_t c = 0; c < 3; ++c) {
                for (const double share : {0.0, 0.25, 0.7}) { // along an edge
                    const auto between = [share](float a, float b) {
                        return (1.0 - share) * static_cast<double>(a) + share * static_cast<double>(b);
                    };
                    const float found =
                        sampled(map, between(map.coordinates[here * 2], map.coordinates[next * 2]),
                                between(map.coordinates[here * 2 + 1], map.coordinates[next * 2 + 1]), c);
                    largest =
                        std::max(largest, std::abs(static_cast<double>(found) -
                                                   between(values[here * 3 + c], values[next * 3 + c])));
                }
            }
        }
    }
    return largest;
}

Scene room() {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}, {6, 3});
    add_polygon(scene, "sheet", {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {2, 3});
    scene.surfaces.back().two_sided = true;
    add_polygon(scene, "sail", {{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}, {3, 3});
    return scene;
}

} // namespace

TEST_CASE("Lightmap: sampled bilinearly it has the values of all corners, and those between", "[display]") {
    const Scene scene = room();
    const PatchMesh mesh(scene);
    const std::vector<float> values = field(mesh);
    for (const std::uint32_t size : {64U, 200U, 512U}) {
        INFO(size);
        const Lightmap map = make_lightmap(mesh, values, size);
        CHECK(map.texels.size() == std::size_t{size} * size * 3);
        CHECK(map.patch_size >= 1);
        CHECK(largest_error(mesh, values, map) < 1e-4);
        for (const float place : map.coordinates) {
            CHECK(place >= 0.0F);
            CHECK(place <= 1.0F);
        }
    }
    CHECK(make_lightmap(mesh, values, 512).patch_size > make_lightmap(mesh, values, 64).patch_size);
}

TEST_CASE("Lightmap: patches with values of their own at common corners have rectangles of their own",
          "[display]") {
    const Scene scene = room();
    const PatchMesh mesh(scene);
    std::vector<float> values = field(mesh);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) { // a step from patch to patch
        for (std::size_t k = 0; k < 12; ++k) {
            values[std::size_t{i} * 12 + k] += static_cast<float>(i % 5);
        }
    }
    const Lightmap map = make_lightmap(mesh, values, 256);
    CHECK(largest_error(mesh, values, map) < 1e-4);
}

TEST_CASE("Lightmap: outermost texels are repeated around a rectangle", "[display]") {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {2, 2});
    const PatchMesh mesh(scene);
    const Lightmap map = make_lightmap(mesh, field(mesh), 32);
    const auto texel = [&map](std::size_t x, std::size_t y) { return map.texels[(y * map.size + x) * 3]; };
    CHECK(texel(0, 0) == texel(2, 2));
    CHECK(texel(1, 2) == texel(2, 2));
    CHECK(texel(2, 5) != texel(3, 5));
    CHECK(texel(0, 5) == texel(2, 5));
}

TEST_CASE("Lightmap: a size that is too small names one that is enough", "[display]") {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {40, 40});
    const PatchMesh mesh(scene);
    const std::vector<float> values = field(mesh);
    try {
        (void)make_lightmap(mesh, values, 32);
        FAIL("it does not fit");
    } catch (const InvalidArgument& error) {
        CHECK(std::string(error.what()).find("64 are enough") != std::string::npos);
    }
    CHECK_NOTHROW(make_lightmap(mesh, values, 64));
    CHECK_THROWS_AS(make_lightmap(mesh, values, 8), InvalidArgument);
    CHECK_THROWS_AS(make_lightmap(mesh, std::vector<float>(3), 64), InvalidArgument);
}
