#pragma once

#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include <cstdint>
#include <memory>
#include <optional>

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
    /// @param normal  of the point, of unit length; none: of a small sphere, by solid angles
    /// @param key     shifts the rays' ends on the patch
    [[nodiscard]] Estimate visibility_from(const Vec3& at, const std::optional<Vec3>& normal, std::uint32_t j,
                                           std::uint32_t rays, std::uint64_t key) const;
    /// Irradiance by the sun.
    struct SunShare {
        double share; ///< of that normal to the beam: the cosine times what is lit
        double lit;   ///< of what the same area would get with nothing else there; 1: no ray was blocked
    };
    /// Of a patch: means over patch and disc, by rays from Sobol points. Backs get none.
    /// @param rays  to trace; powers of two are spread best; where some are blocked, `edge_rays` are traced
    [[nodiscard]] SunShare sun_share(std::uint32_t i, const Sun& sun, std::uint32_t rays,
                                     std::uint32_t edge_rays) const;
    /// The same of a point, whose own surface hides nothing; few rays where the sun is a point.
    /// @param normal  of unit length; none: of a small sphere, whose cross-section is a quarter of its
    /// surface
    [[nodiscard]] double sun_share_at(const Vec3& at, const std::optional<Vec3>& normal,
                                      const Sun& sun) const;

private:
    struct Packet;
    class Sum;
    /// A point in that direction beyond all surfaces.
    [[nodiscard]] Vec3 beyond(const Vec3& at, const Vec3& towards) const;
    /// As sun_share(), by so many rays.
    [[nodiscard]] SunShare sun_by_rays(std::uint32_t i, const Sun& sun, std::uint32_t rays) const;

    const PatchMesh& mesh_;
    double rounding_;
    std::unique_ptr<EmbreeScene> scene_; ///< of surfaces
};

} // namespace hemi
