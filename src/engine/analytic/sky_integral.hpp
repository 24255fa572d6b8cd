#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/scene/scene.hpp"

#include <span>

namespace hemi {

/// Integrals over directions above the horizon, with the cosine to a normal over pi, or, for small spheres,
/// over 4 pi without it.
struct SkyMoments {
    double share = 0.0;     ///< of 1
    double elevation = 0.0; ///< of sin(elevation)

    SkyMoments& operator+=(const SkyMoments& other) {
        share += other.share;
        elevation += other.elevation;
        return *this;
    }
    friend SkyMoments operator*(double factor, const SkyMoments& moments) {
        return {factor * moments.share, factor * moments.elevation};
    }
};

/// Those of all directions in front of an area.
/// @param normal  of unit length
/// @param up      likewise
[[nodiscard]] SkyMoments open_sky(const Vec3& normal, const Vec3& up);
/// Those of a small sphere.
[[nodiscard]] SkyMoments open_sky();

/// Those of the directions from a point to the front of a polygon, unoccluded. Closed form: J. Arvo,
/// "Applications of irradiance tensors to the simulation of non-Lambertian phenomena", SIGGRAPH 1995.
/// @param normal   at the point, of unit length
/// @param polygon  planar and convex, of three or four corners
/// @param up       of unit length
[[nodiscard]] SkyMoments sky_behind(const Vec3& at, const Vec3& normal, std::span<const Vec3> polygon,
                                    const Vec3& up);
/// Those of a small sphere.
[[nodiscard]] SkyMoments sky_behind(const Vec3& at, std::span<const Vec3> polygon, const Vec3& up);

/// Irradiance by an unobstructed horizontal area's of 1.
[[nodiscard]] double sky_irradiance(SkyDistribution distribution, const SkyMoments& moments);

} // namespace hemi
