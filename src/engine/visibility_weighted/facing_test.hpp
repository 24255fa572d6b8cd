#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace hemi {

/// Whether two patches have parts in front of each other: without them they see nothing of each other,
/// whatever lies between. Copies what it needs, so that the test, made for every pair, reads one short record
/// a patch.
class FacingTest {
public:
    explicit FacingTest(const PatchMesh& mesh);

    [[nodiscard]] bool operator()(std::uint32_t i, std::uint32_t j) const {
        return height(i, j) > tolerance_ && height(j, i) > tolerance_;
    }
    /// Height of the highest corner of j above the plane of i, scene units.
    [[nodiscard]] double height(std::uint32_t i, std::uint32_t j) const {
        const Patch& plane = patches_[i];
        double highest = -std::numeric_limits<double>::infinity();
        for (const Vec3& corner : patches_[j].corners) {
            highest = std::max(highest, glm::dot(plane.normal, corner));
        }
        return highest - plane.height;
    }

private:
    struct Patch {
        Vec3 normal;
        double height;               ///< of the plane above the origin, along the normal
        std::array<Vec3, 4> corners; ///< those of a triangle end with the third one twice
    };
    std::vector<Patch> patches_;
    double tolerance_;
};

} // namespace hemi
