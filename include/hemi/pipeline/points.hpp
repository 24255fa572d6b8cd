#pragma once

#include "hemi/core/names.hpp"
#include "hemi/engine/point_rows.hpp"
#include "hemi/pipeline/heat.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi {

/// A place of which something is to be known, anywhere in or outside a scene.
struct Receiver {
    Vec3 position{0.0};         ///< scene units
    std::optional<Vec3> normal; ///< of unit length: a small plane area; none: a small sphere
    /// Index of the surface that it lies on, or no_surface; see SurfacePoint::surface.
    std::uint32_t surface = no_surface;
};

/// What patches and the environment send out, the same in all directions, W/m² (or lm/m²), and what comes
/// from sun and sky.
struct Radiation {
    std::uint32_t channels = 1;      ///< wavelengths, bands or colours
    std::vector<double> radiosity;   ///< B, N·channels; not a number where it is not known: counts as none
    std::vector<double> environment; ///< exitance of the environment, channels; empty: dark
    std::optional<Sun> sun{};        ///< channels as the radiosity
    std::optional<Sky> sky{};        ///< likewise
    UpAxis up = UpAxis::z;           ///< of the horizon
    /// Channels of short waves, as the sun's: bands that end at 4 µm or before; empty: none is known to be.
    std::vector<bool> short_wave{};
};
/// That of a solution, with what can be seen of patches that something stands on. Sun, sky and the axis
/// upwards are the scene's, and are left to be set.
/// @param mesh      N patches
/// @param values    what patches and the environment radiate
/// @param solution  radiosity and back-face shares are used
/// @throws InvalidArgument for values that do not fit
[[nodiscard]] Radiation radiation_of(const PatchMesh& mesh, const PatchValues& values,
                                     const Solution& solution);
/// Heat radiation, by bands; sun and sky likewise.
[[nodiscard]] Radiation radiation_of(const HeatProblem& problem, const HeatSolution& solution);

/// That of a stored solution of heat: see heat_as_solution() and scene_of_heat().
/// @throws InvalidArgument for a solution without net fluxes, or of other channels than the scene's
[[nodiscard]] Radiation radiation_of(const Scene& scene, const Solution& solution);

/// Directions of a point's six planes, in this order: up, down, and to the right, left, front and back of
/// somebody who faces an azimuth.
/// @param facing  degrees from +y towards +x, or, where y is upwards, from -z towards +x
/// @param up      axis
[[nodiscard]] std::array<Vec3, 6> plane_directions(double facing, UpAxis up = UpAxis::z);

/// What P points get. Shares and factors of a plane are weighted with the cosine, those of a sphere are
/// shares of the full solid angle. Upwards is the radiation's axis.
struct PointValues {
    std::uint32_t channels = 1;     ///< of the radiation
    std::uint32_t groups = 0;       ///< of the mesh
    std::vector<double> irradiance; ///< P·channels; without a normal: mean spherical, (1/4) ∫ L dω
    std::vector<double> factors;    ///< to groups, P·groups
    /// Share of the environment above the horizon, P: of a horizontal area the sky view factor.
    std::vector<double> sky;
    std::vector<double> below_horizon; ///< share of the environment below it, P
    std::vector<double> blocked; ///< share of back faces, P, from which nothing comes; inside a body about 1
    /// Exitance of black surroundings that would send as much as what is seen does, all channels together,
    /// W/m², P: of patches, and of the environment unless what is seen of it is but a leak, with sun and sky.
    /// Backs and patches of unknown radiosity are left out; not a number where nothing else is seen.
    std::vector<double> surroundings;
    /// The same for the six planes of points without a normal, see plane_directions(), without short waves
    /// and what comes from sun and sky: P·6, not a number with a normal; empty if it was not wanted.
    std::vector<double> planes;
    /// Irradiance of these planes by short waves, and by what comes from sun and sky in any channel: P·6.
    std::vector<double> planes_short;
};

/// Irradiance and factors of points, by rows of their own, see compute_point_rows(): of a plane by the
/// cosine, of a sphere the exact solid angle of every patch times the share of it that is seen. The horizon
/// cuts patches exactly, but where backs are seen what they hide of the sky is estimated. Memory: some
/// hundreds of rows, and what is returned.
/// @param mesh       N patches
/// @param points     P
/// @param radiation  of the patches
/// @param enclosure  as the scene says
/// @param settings   resolution, rule, shadow rays by the preset; device and workers
/// @param facing     for the six planes, see plane_directions(); none: they are not found, which saves most
///   of the time of points without a normal
/// @param observer   gets progress (Phase::points) and may cancel
/// @throws InvalidArgument for values that do not fit, positions that are not finite, normals not of unit
///   length; as make_point_visibility_engine(); Cancelled
[[nodiscard]] PointValues compute_point_values(const PatchMesh& mesh, std::span<const Receiver> points,
                                               const Radiation& radiation, Enclosure enclosure,
                                               const FactorSettings& settings,
                                               std::optional<double> facing = std::nullopt,
                                               Observer& observer = no_observer());

/// How a person is there, for whom the mean radiant temperature is wanted.
enum class Posture {
    standing, ///< projected areas 0.08 (up, down), 0.23 (right, left), 0.35 (front, back)
    seated,   ///< 0.18, 0.22, 0.30
};

/// Words of Posture.
template <>
struct Names<Posture> {
    /// Every value with its word.
    static constexpr NamedValue<Posture> table[] = {{Posture::standing, "standing"},
                                                    {Posture::seated, "seated"}};
};

/// What a body absorbs of what falls on it. Source of the values: VDI 3787 part 2, of a clothed person.
struct BodyAbsorption {
    double short_wave = 0.7; ///< of short waves, and of what comes from sun and sky; in (0, 1]
    double long_wave = 0.97; ///< of heat radiation, which is its emissivity; in (0, 1]
};
/// Exitance of black surroundings that would heat a body as much as what its six planes receive, short waves
/// by their absorptance over the emissivity: the planes of person_radiant_temperature(), W/m². In one grey
/// band short waves are what comes from sun and sky straight; their reflections count as heat radiation.
/// @param values  with planes
/// @param point   index
/// @param body    that receives
[[nodiscard]] std::array<double, 6> plane_exitances(const PointValues& values, std::size_t point,
                                                    const BodyAbsorption& body = {});

/// Mean radiant temperature of a person by six plane radiant temperatures, each weighted with the projected
/// area of its direction. Source: ISO 7726:1998, annex B.
/// @param planes   see plane_exitances(), W/m²
/// @param posture  standing or seated
/// @param faces    whether the person faces front; else sides, front and back count alike
/// @return K; not a number where a plane sees nothing
[[nodiscard]] double person_radiant_temperature(std::span<const double, 6> planes, Posture posture,
                                                bool faces);

/// Points in front of faces, on square grids. A grid is that of faces in one plane, along the sides of the
/// smallest rectangle about them, in its middle, as many points as fit; those that are beside the faces are
/// left out.
struct PointGrid {
    /// Of one plane.
    struct Plane {
        std::uint32_t columns = 0;       ///< along u
        std::uint32_t rows = 0;          ///< along v
        Vec3 u{0.0};                     ///< of unit length
        Vec3 v{0.0};                     ///< of unit length
        std::vector<std::uint32_t> cell; ///< of every point: column + columns·row
    };
    std::vector<Plane> planes;    ///< in the faces' order
    std::vector<Receiver> points; ///< plane by plane, row by row; with the faces' normals
};
/// Those in front of a group's faces.
/// @param mesh     whose surfaces are meant
/// @param group    index
/// @param spacing  of the points, scene units; at least half of it is left to the rectangle's sides, where it
///   is not wider than that
/// @param height   of the points above the faces, scene units
/// @throws InvalidArgument for a spacing that is not positive, a height that is not finite, and more than
///   2^26 points
[[nodiscard]] PointGrid make_point_grid(const PatchMesh& mesh, std::uint32_t group, double spacing,
                                        double height);

} // namespace hemi
