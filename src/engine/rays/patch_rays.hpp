#pragma once

#include "engine/analytic/convex_polygon.hpp"
#include "engine/hemicube/eye.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>

namespace hemi {

/// Rays that leave a patch as its light does: from Sobol points evenly distributed over its area, in
/// cosine-weighted Sobol directions, shifted by bits hashed from patch and seed. Each stands for the same
/// share of what leaves.
class PatchRays {
public:
    struct Ray {
        Vec3 origin;
        Vec3 direction; ///< of unit length
    };

    PatchRays(const PatchMesh& mesh, std::uint32_t patch, std::uint64_t seed);

    /// Ray `index` of the sequence; powers of two of them from 0 on are spread best.
    [[nodiscard]] Ray operator[](std::uint32_t index) const;

private:
    EyeFrame frame_;
    BilinearMap map_;
    std::array<std::uint32_t, 4> shift_{};
};

} // namespace hemi
