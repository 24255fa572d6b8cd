#pragma once

#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace hemi::test {

/// A scene put together surface by surface, grey, with materials "white" (0) and "other" (1).
class SceneBuilder {
public:
    SceneBuilder() {
        scene.materials = {{"white", {0.5}, {0.0}}, {"other", {0.5}, {0.0}}};
        scene.environment = {0.0};
    }

    /// Three or four corners, counter-clockwise seen from the front.
    Surface& add(const std::string& group, const std::vector<Vec3>& corners, Grid patches = {1, 1},
                 std::uint32_t material = 0) {
        Surface surface;
        for (std::size_t k = 0; k < corners.size(); ++k) {
            surface.vertices[k] = corners[k];
        }
        surface.vertex_count = static_cast<std::uint32_t>(corners.size());
        surface.material = material;
        surface.group = scene.group_index(group);
        surface.patches = patches;
        scene.surfaces.push_back(surface);
        return scene.surfaces.back();
    }

    /// A rectangle in the plane z = 0, facing up.
    Surface& floor(const std::string& group, double x0, double y0, double x1, double y1,
                   Grid patches = {1, 1}, std::uint32_t material = 0) {
        return add(group, {{x0, y0, 0.0}, {x1, y0, 0.0}, {x1, y1, 0.0}, {x0, y1, 0.0}}, patches, material);
    }

    [[nodiscard]] PatchMesh mesh() const { return PatchMesh(scene); }

    Scene scene;
};

} // namespace hemi::test
