#include "hemi/engine/leaks.hpp"

#include "core/parallel_for.hpp"
#include "engine/rays/patch_rays.hpp"
#include "engine/rays/ray_tracer.hpp"
#include "hemi/scene/image_mesh.hpp"

namespace hemi {

std::vector<std::optional<Vec3>> leak_directions(const PatchMesh& mesh,
                                                 std::span<const std::uint32_t> patches) {
    constexpr std::uint32_t rays = 65536;
    constexpr std::uint32_t min_escaped = 2; // a single ray may slip through where edges meet
    std::vector<std::optional<Vec3>> directions(patches.size());
    if (patches.empty()) {
        return directions;
    }
    const ImageMesh images(mesh);
    const RayTracer tracer(images.mesh());
    parallel_for(patches.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const PatchRays sequence(mesh, patches[k], 0);
            Vec3 sum(0.0);
            std::uint32_t escaped = 0;
            for (std::uint32_t index = 0; index < rays; ++index) {
                const PatchRays::Ray ray = sequence[index];
                if (tracer.trace(ray.origin, ray.direction).side == RayTracer::Side::nothing) {
                    sum += ray.direction;
                    ++escaped;
                }
            }
            if (escaped >= min_escaped) {
                directions[k] = glm::normalize(sum);
            }
        }
    });
    return directions;
}

} // namespace hemi
