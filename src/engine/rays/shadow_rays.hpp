#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <memory>

namespace hemi {

class EmbreeScene;

/// Visibility of pairs of patches by rays between them, by Embree.
///
/// Sobol points on both patches; each pair of points is weighted by cos·cos / r², so that V is the share of
/// the unoccluded factor that nothing hides. Surfaces in whose plane either end lies hide nothing, and backs
/// hide as fronts do: as hemicubes have it. Thread-safe after construction.
class ShadowRays {
public:
    /// @param mesh  must outlive this.
    /// @throws Error if Embree cannot be set up.
    explicit ShadowRays(const PatchMesh& mesh);
    ~ShadowRays();

    struct Estimate {
        double visibility;
        double rays; ///< of equal weight that it is worth: few where patches are near; 0: none goes front to
                     ///< front
    };
    /// The same for (i, j) and (j, i).
    /// @param rays  to trace; powers of two are spread best
    [[nodiscard]] Estimate visibility(std::uint32_t i, std::uint32_t j, std::uint32_t rays) const;
    /// The same from a point to patch j.
    /// @param at      position of the point, scene units
    /// @param normal  of the point, of unit length
    /// @param key     shifts the rays' ends on the patch
    [[nodiscard]] Estimate visibility_from(const Vec3& at, const Vec3& normal, std::uint32_t j,
                                           std::uint32_t rays, std::uint64_t key) const;
    /// Share of a patch that parallel light reaches, by rays from Sobol points on it. Backs get none.
    /// @param towards  direction of the light, of unit length
    /// @param rays     to trace; powers of two are spread best
    [[nodiscard]] double lit_share(std::uint32_t i, const Vec3& towards, std::uint32_t rays) const;
    /// Whether parallel light reaches a point; its own surface hides nothing.
    [[nodiscard]] bool is_lit(const Vec3& at, const Vec3& towards) const;

private:
    struct Packet;
    class Sum;

    /// A point in that direction beyond all surfaces.
    [[nodiscard]] Vec3 beyond(const Vec3& at, const Vec3& towards) const;

    const PatchMesh& mesh_;
    double rounding_;
    std::unique_ptr<EmbreeScene> scene_; ///< of surfaces
};

} // namespace hemi
