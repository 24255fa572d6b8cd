#include "hemi/scene/contact.hpp"

#include "scene/convex_polygon.hpp"

#include <algorithm>

namespace hemi {

std::vector<std::uint32_t> patches_in_contact(const PatchMesh& mesh, std::span<const std::uint32_t> patches) {
    std::vector<std::uint32_t> found;
    const double slack = 1e-7 * mesh.bounds().diagonal();
    for (const std::uint32_t patch : patches) {
        const Vec3 normal = mesh.normal(patch);
        const Vec3& centre = mesh.centres()[patch];
        for (std::uint32_t s = 0; s < mesh.surfaces().size(); ++s) {
            const auto polygon = mesh.surfaces()[s].polygon();
            if (s != mesh.surface_of()[patch] && glm::dot(mesh.surface_normal(s), normal) < -1.0 + 1e-6 &&
                std::abs(glm::dot(centre - polygon[0], normal)) <= slack &&
                contains(polygon, mesh.surface_normal(s), centre, slack)) {
                found.push_back(patch);
                break;
            }
        }
    }
    return found;
}

} // namespace hemi
