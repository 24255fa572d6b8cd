#pragma once

#include "engine/analytic/sky_integral.hpp"
#include "engine/rays/shadow_rays.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/matrix/source_clusters.hpp"
#include "hemi/scene/image_mesh.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// What comes straight from sun and sky to points, by rows of theirs over the patches. Thread-safe after
/// construction.
class PointDaylight {
public:
    /// @param mesh  must outlive this
    /// @param sun   none: no beam
    /// @param sky   none: no light; moments of what is seen are of shares alone then
    /// @param up    of the horizon
    /// @param clusters  that columns of rows may be; null: they are patches
    PointDaylight(const PatchMesh& mesh, std::optional<Sun> sun, std::optional<Sky> sky, UpAxis up,
                  std::shared_ptr<const SourceClusters> clusters = nullptr);

    /// What is seen of the environment.
    struct Environment {
        SkyMoments above;   ///< of the horizon
        double below = 0.0; ///< share
    };

    /// Of what is seen of a patch or a cluster: the share above the point's horizon, and the mean of
    /// sin(elevation) there.
    /// @param normal  none: of a small sphere
    [[nodiscard]] SkyMoments seen_above(const Vec3& at, const std::optional<Vec3>& normal,
                                        std::uint32_t column) const;
    /// The environment's share of a row, split at the horizon.
    /// @param blocked    share of backs, which hide sky as evenly as that is seen
    /// @param available  of all directions
    /// @param above      of patches
    [[nodiscard]] static Environment split(double environment, double blocked, const SkyMoments& available,
                                           const SkyMoments& above);
    /// That of an area, or of a small sphere, by its row.
    [[nodiscard]] Environment seen_by(const Vec3& at, const std::optional<Vec3>& normal,
                                      const RowView& row) const;

    /// Irradiance of an area; what it sees need not be told where there is no sky.
    /// @param add  takes a channel and an irradiance
    /// @param normal  none: mean spherical irradiance
    template <class Add>
    void irradiance(const Vec3& at, const std::optional<Vec3>& normal, const Environment& seen,
                    const Add& add) const {
        if (sky_) {
            const double above = sky_irradiance(sky_->distribution, seen.above);
            for (std::uint32_t c = 0; c < sky_->horizontal.size(); ++c) {
                add(c, sky_->horizontal[c] * (above + sky_->ground[c] * seen.below));
            }
        }
        const double beam = rays_ ? rays_->sun_share_at(at, normal, *sun_) : 0.0;
        for (std::uint32_t c = 0; beam > 0.0 && c < sun_->irradiance.size(); ++c) {
            add(c, beam * sun_->irradiance[c]);
        }
    }

    [[nodiscard]] bool has_sky() const { return sky_.has_value(); }
    /// Of all directions in front of an area, or of a small sphere.
    [[nodiscard]] SkyMoments available(const std::optional<Vec3>& normal) const {
        return normal ? open_sky(*normal, up_) : open_sky();
    }

private:
    [[nodiscard]] SkyMoments seen_above_of_patch(const Vec3& at, const std::optional<Vec3>& normal,
                                                 std::uint32_t patch) const;

    const PatchMesh& mesh_;
    std::shared_ptr<const SourceClusters> clusters_;
    std::optional<Sun> sun_;
    std::optional<Sky> sky_;
    Vec3 up_;
    ImageMesh images_;
    std::optional<ShadowRays> rays_; ///< where there is a sun
    std::vector<double> low_;        ///< height of every patch, then of every cluster
    std::vector<double> high_;       ///< likewise
    std::vector<double> centres_;    ///< three numbers a column, where there are clusters and a sky
};

} // namespace hemi
