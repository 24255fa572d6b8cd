#pragma once

#include "hemi/scene/scene.hpp"

#include <utility>

namespace hemi::test {

/// A scene of quadrilaterals with each as two triangles, as exporters cut them, uncut.
inline Scene in_triangles(const Scene& scene) {
    Scene result = scene;
    result.surfaces.clear();
    for (const Surface& surface : scene.surfaces) {
        const auto& p = surface.vertices;
        for (const auto& [b, c] : {std::pair(p[1], p[2]), std::pair(p[2], p[3])}) {
            Surface& half = result.surfaces.emplace_back(surface);
            half.vertices = {p[0], b, c, Vec3(0.0)};
            half.vertex_count = 3;
            half.patches.reset();
        }
    }
    return result;
}

} // namespace hemi::test
