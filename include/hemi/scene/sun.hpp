#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/scene/scene.hpp"

#include <string>

namespace hemi {

/// Where the sun is in the sky.
struct SunPosition {
    double azimuth = 0.0;   ///< degrees clockwise from north
    double elevation = 0.0; ///< of its centre above the horizon, degrees, with refraction by the air
};

/// Position of the sun by the solar calculator's formulas; good to 0.01 degrees from 1900 to 2100, and to 0.1
/// at the horizon, where refraction varies. Source: NOAA Global Monitoring Laboratory, Solar Calculation
/// Details, after J. Meeus, "Astronomical Algorithms", 1991.
/// @param latitude   degrees, north positive, in [-90, 90]
/// @param longitude  degrees, east positive, in [-180, 180]
/// @param time       ISO 8601 with offset, such as 2026-06-21T12:00:00+02:00, or Z for UTC
/// @throws InvalidArgument for a place or a time that is none
[[nodiscard]] SunPosition sun_position(double latitude, double longitude, const std::string& time);

/// Unit vector to a place in the sky. North is +y, or, where y is upwards, -z, turned clockwise by `north`.
/// @param azimuth    degrees clockwise from north
/// @param elevation  degrees above the horizon
/// @param north      direction of north, degrees clockwise from +y or -z
/// @param up         axis upwards
[[nodiscard]] Vec3 sky_direction(double azimuth, double elevation, double north = 0.0, UpAxis up = UpAxis::z);

} // namespace hemi
