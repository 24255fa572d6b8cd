#pragma once

#include "engine/baselines/reference_engine.hpp"
#include "engine/hemicube/eye.hpp"

#include <catch2/catch.hpp>

#include <cstdint>

namespace hemi::test {

/// Texels where the item buffer and the ray differ although the ray is further than `margin` texels from any
/// change of item.
/// @tparam Rows  GlRows or CpuRows
template <class Rows>
[[nodiscard]] std::size_t disagreements(const PatchMesh& mesh, const HemicubeSettings& settings,
                                        std::uint32_t patch, double margin, Rows& engine) {
    const ReferenceTracer tracer(mesh, settings);
    const auto drawn = engine.items(patch);
    const auto traced = tracer.items(patch);
    REQUIRE(drawn.size() == traced.size());
    const EyeFrame frame(mesh.normal(patch), patch, 0, settings.seed);
    const std::uint32_t resolution = settings.resolution;
    std::size_t wrong = 0;
    for (std::size_t texel = 0; texel < drawn.size(); ++texel) {
        if (drawn[texel] == traced[texel]) {
            continue;
        }
        // What the texel shows must then be met by a ray within the margin.
        const auto x = static_cast<std::uint32_t>(texel % resolution);
        const auto row = static_cast<std::uint32_t>(texel / resolution);
        const int face = row < resolution ? 0 : 1 + static_cast<int>((row - resolution) / (resolution / 2));
        const std::uint32_t y = face == 0 ? row : (row - resolution) % (resolution / 2);
        bool near_edge = false;
        for (int dx = -1; dx <= 1 && !near_edge; ++dx) {
            for (int dy = -1; dy <= 1 && !near_edge; ++dy) {
                const double right = (2.0 * (x + 0.5 + dx * margin)) / resolution - 1.0;
                const double up = (2.0 * (y + 0.5 + dy * margin)) / resolution - (face == 0 ? 1.0 : 0.0);
                const Vec3 local = face_direction(face, right, up);
                const auto hit = tracer.trace(patch, mesh.centres()[patch],
                                              local.x * frame.x + local.y * frame.y + local.z * frame.z);
                near_edge = hit.item == drawn[texel];
            }
        }
        wrong += near_edge ? 0 : 1;
    }
    return wrong;
}

} // namespace hemi::test
