#include "hemi/pipeline/daylight.hpp"

#include "core/parallel_for.hpp"
#include "engine/analytic/convex_polygon.hpp"
#include "engine/rays/shadow_rays.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/matrix/product.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/scene/image_mesh.hpp"
#include "pipeline/point_daylight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hemi {

namespace {

/// Rays to a patch that are enough where all or none are blocked, and where some are.
constexpr std::uint32_t first_rays = 64;
constexpr std::uint32_t edge_rays = 1024;
/// Distance of centres, in sums of radii, from which a patch lies in one direction, and from which it is seen
/// in one way from all of a patch.
constexpr double far = 10.0;
constexpr double apart = 3.0;
constexpr std::size_t patches_at_once = 16;

void add_sun(const PatchMesh& mesh, const Sun& sun, std::size_t channels,
             std::span<const std::uint32_t> patches, DirectIrradiance& result) {
    const ImageMesh images(mesh);
    const ShadowRays rays(images.mesh());
    result.sun.assign(patches.size() * channels, 0.0);
    result.lit.assign(patches.size(), 0.0);
    parallel_for(patches.size(), patches_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto [share, lit] = rays.sun_share(patches[k], sun, first_rays, edge_rays);
            result.lit[k] = lit;
            for (std::size_t c = 0; c < channels; ++c) {
                result.sun[k * channels + c] = sun.irradiance[c] * share;
            }
        }
        stop_if_interrupted();
    });
}

/// What patches see of the sky.
class SkyShares {
public:
    SkyShares(const PatchMesh& mesh, const FormFactorMatrix& factors, const Vec3& up)
        : mesh_(mesh), factors_(factors), up_(up) {
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            double radius = 0.0;
            const PatchCorners corners = mesh.corners(i);
            for (const Vec3& corner : corners.polygon()) {
                radius = std::max(radius, glm::length(corner - mesh.centres()[i]));
            }
            radii_.push_back(radius);
        }
        if (factors.clusters() != nullptr) {
            enclose(*factors.clusters());
        }
    }

    [[nodiscard]] PointDaylight::Environment seen(std::uint32_t i) const {
        if (!factors_.known(i) || !(factors_.environment(i) > 0.0)) {
            return {};
        }
        const RowView row = factors_.row(i);
        const Eyes eyes = eyes_of(i);
        SkyMoments hidden;
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            const auto factor = static_cast<double>(row.values[k]);
            const std::uint32_t column = row.columns[k];
            hidden += factor * (column < mesh_.size() ? behind(i, eyes, column)
                                                      : behind_cluster(i, eyes, column - mesh_.size()));
        }
        return PointDaylight::split(row.environment, row.blocked, open_sky(mesh_.normal(i), up_), hidden);
    }

private:
    /// Points of a patch with the areas that they stand for; the last one, its centre, stands for all.
    struct Eyes {
        std::array<Vec3, 5> at;
        std::array<double, 5> weight;
    };

    /// Of a cluster: where its patches are, by their weights.
    struct Sphere {
        Vec3 centre{0.0};
        double radius = 0.0; ///< about it, of all patches
    };

    void enclose(const SourceClusters& clusters) {
        spheres_.resize(clusters.nodes().size());
        for (std::size_t k = spheres_.size(); k-- > 0;) { // children come after their parents
            const std::uint32_t child = clusters.nodes()[k].child;
            if (child == 0) {
                const std::uint32_t patch = clusters.order()[clusters.nodes()[k].begin];
                spheres_[k] = {mesh_.centres()[patch], radii_[patch]};
                continue;
            }
            const Sphere& a = spheres_[child];
            const Sphere& b = spheres_[child + 1];
            Sphere& whole = spheres_[k];
            whole.centre = glm::mix(b.centre, a.centre, clusters.first_share(static_cast<std::uint32_t>(k)));
            whole.radius = std::max(glm::distance(whole.centre, a.centre) + a.radius,
                                    glm::distance(whole.centre, b.centre) + b.radius);
        }
    }

    [[nodiscard]] Eyes eyes_of(std::uint32_t i) const {
        const PatchCorners corners = mesh_.corners(i);
        const BilinearMap map(corners.polygon(), mesh_.normal(i));
        const double place = 1.0 / std::numbers::sqrt3;
        Eyes eyes;
        for (std::size_t k = 0; k < 4; ++k) {
            const double s = k % 2 == 0 ? -place : place;
            const double t = k / 2 == 0 ? -place : place;
            eyes.at[k] = map.point(s, t);
            eyes.weight[k] = map.jacobian_at(s, t);
        }
        eyes.at[4] = mesh_.centres()[i];
        eyes.weight[4] = 1.0;
        return eyes;
    }

    /// The same of a cluster: at once where all of it is above the horizon, or below.
    [[nodiscard]] SkyMoments behind_cluster(std::uint32_t i, const Eyes& eyes, std::uint32_t cluster) const {
        const SourceClusters& clusters = *factors_.clusters();
        const Sphere& sphere = spheres_[cluster];
        const Vec3 way = sphere.centre - mesh_.centres()[i];
        const double rise = glm::dot(way, up_);
        if (std::abs(rise) > radii_[i] + sphere.radius) {
            return in_direction(rise / glm::length(way));
        }
        const SourceClusters::Node& node = clusters.nodes()[cluster];
        if (node.child == 0) {
            return behind(i, eyes, clusters.order()[node.begin]);
        }
        const double first = clusters.first_share(cluster);
        SkyMoments above = first * behind_cluster(i, eyes, node.child);
        above += (1.0 - first) * behind_cluster(i, eyes, node.child + 1);
        return above;
    }

    /// Mean over what a patch sees of another, of being above the horizon, and of sin(elevation) there.
    [[nodiscard]] SkyMoments behind(std::uint32_t i, const Eyes& eyes, std::uint32_t j) const {
        const Vec3 way = mesh_.centres()[j] - mesh_.centres()[i];
        const double distance = glm::length(way);
        const double size = radii_[i] + radii_[j];
        const double rise = glm::dot(way, up_);
        if (distance > far * size && std::abs(rise) > size) {
            return in_direction(rise / distance);
        }
        const PatchCorners corners = mesh_.corners(j);
        const Vec3 normal = mesh_.normal(i);
        const std::size_t first = distance > apart * size ? 4 : 0;
        const std::size_t end = distance > apart * size ? 5 : 4;
        SkyMoments above;
        double all = 0.0;
        for (std::size_t k = first; k < end; ++k) {
            all += eyes.weight[k] * point_factor(eyes.at[k], normal, corners.polygon());
            above += eyes.weight[k] * sky_behind(eyes.at[k], normal, corners.polygon(), up_);
        }
        if (!(all > 0.0)) {
            return distance > 0.0 ? in_direction(rise / distance) : SkyMoments{};
        }
        const double share = std::min(1.0, above.share / all);
        return {share, std::min(share, above.elevation / all)};
    }
    static SkyMoments in_direction(double sine) { return sine > 0.0 ? SkyMoments{1.0, sine} : SkyMoments{}; }

    const PatchMesh& mesh_;
    const FormFactorMatrix& factors_;
    Vec3 up_;
    std::vector<double> radii_;
    std::vector<Sphere> spheres_; ///< of clusters
};

std::vector<double> sky_irradiance(const PatchMesh& mesh, const Sky& sky, const Vec3& up,
                                   std::size_t channels, const FormFactorMatrix& factors,
                                   std::span<const std::uint32_t> patches) {
    const SkyShares shares(mesh, factors, up);
    std::vector<double> result(patches.size() * channels, 0.0);
    parallel_for(patches.size(), patches_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const PointDaylight::Environment seen = shares.seen(patches[k]);
            const double above = sky_irradiance(sky.distribution, seen.above);
            for (std::size_t c = 0; c < channels; ++c) {
                result[k * channels + c] = sky.horizontal[c] * (above + sky.ground[c] * seen.below);
            }
        }
        stop_if_interrupted();
    });
    return result;
}

} // namespace

DirectIrradiance direct_irradiances(const Scene& scene, const PatchMesh& mesh,
                                    const FormFactorMatrix& factors) {
    return direct_irradiances(scene, mesh, factors, all_patches(mesh.size()));
}

DirectIrradiance direct_irradiances(const Scene& scene, const PatchMesh& mesh,
                                    const FormFactorMatrix& factors, std::span<const std::uint32_t> patches) {
    DirectIrradiance result;
    if (factors.size() != mesh.size()) {
        throw InvalidArgument(
            fmt::format("rows of {} patches for a mesh of {}", factors.size(), mesh.size()));
    }
    const std::size_t channels = scene.channels.size();
    if (scene.sun) {
        add_sun(mesh, *scene.sun, channels, patches, result);
    }
    if (scene.sky) {
        result.sky = sky_irradiance(mesh, *scene.sky, upwards(scene.up), channels, factors, patches);
    }
    return result;
}

std::vector<double> direct_irradiance(const Scene& scene, const PatchMesh& mesh,
                                      const FormFactorMatrix& factors) {
    DirectIrradiance parts = direct_irradiances(scene, mesh, factors);
    if (parts.sun.empty()) {
        return std::move(parts.sky);
    }
    for (std::size_t k = 0; k < parts.sky.size(); ++k) {
        parts.sun[k] += parts.sky[k];
    }
    return std::move(parts.sun);
}

std::vector<double> direct_heat(const Scene& scene, const PatchMesh& mesh, const FormFactorMatrix& factors,
                                std::uint32_t bands) {
    std::vector<double> all = direct_irradiance(scene, mesh, factors);
    const std::size_t channels = scene.channels.size();
    if (bands == channels) {
        return all;
    }
    if (bands != 1) {
        throw InvalidArgument(fmt::format("{} bands for {} channels", bands, channels));
    }
    std::vector<double> grey;
    for (std::size_t k = 0; k < all.size(); k += channels) {
        grey.push_back(all[k]);
    }
    return grey;
}

} // namespace hemi
