#include "engine/visibility_weighted/facing_test.hpp"

namespace hemi {

FacingTest::FacingTest(const PatchMesh& mesh) : patches_(mesh.size()), tolerance_(mesh.rounding()) {
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchCorners corners = mesh.corners(i);
        Patch& patch = patches_[i];
        patch.normal = mesh.normal(i);
        patch.height = glm::dot(patch.normal, mesh.centres()[i]);
        for (std::size_t k = 0; k < patch.corners.size(); ++k) {
            patch.corners[k] = corners.points[std::min<std::size_t>(k, corners.count - 1)];
        }
    }
}

} // namespace hemi
