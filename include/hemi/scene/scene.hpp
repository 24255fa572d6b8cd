#pragma once

#include "hemi/core/enclosure.hpp"
#include "hemi/core/geometry.hpp"
#include "hemi/core/names.hpp"
#include "hemi/core/patch_cuts.hpp"
#include "hemi/scene/symmetry.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi {

/// What a surface does with light (or heat): a diffuse reflector that may also radiate by itself.
struct Material {
    std::string name;                ///< as in the file
    std::vector<double> reflectance; ///< Share reflected, in [0, 1), one value per channel.
    std::vector<double> exitance;    ///< Radiated by itself, W/m² (or lm/m²), >= 0, one value per channel.
    /// Emissivity by temperature, in all bands: pairs of kelvin, ascending, and emissivity, straight between
    /// them and constant beyond. Empty: 1 - reflectance, whatever the temperature. Where there is one, the
    /// reflectance is that at 300 K.
    std::vector<std::array<double, 2>> emissivity_table{};

    bool operator==(const Material&) const = default; ///< member by member
};

/// Emissivity at a temperature by a table as Material::emissivity_table.
/// @param table   not empty
/// @param kelvin  temperature
[[nodiscard]] double emissivity_at(std::span<const std::array<double, 2>> table, double kelvin);

/// What is known of the heat of some surfaces: one of temperature, heat flux and power.
struct HeatCondition {
    std::optional<double> temperature; ///< K
    std::optional<double> heat_flux;   ///< net, leaving the surface positive, W/m²; 0: adiabatic
    std::optional<double> power;       ///< net, of all surfaces with this condition together, W
    /// All surfaces with this condition have one temperature, which follows from their power or mean flux;
    /// else that is a uniform flux.
    bool isothermal = false;

    bool operator==(const HeatCondition&) const = default; ///< member by member
};

/// What a scene says of heat beside its materials' emissivities.
struct Thermal {
    /// Limits of the wavelength bands, µm, ascending: n limits make n + 1 bands from 0 to infinity, which are
    /// the channels. Empty: one, grey.
    std::vector<double> band_limits;
    std::vector<HeatCondition> conditions;         ///< Surface::heat points here.
    std::optional<double> environment_temperature; ///< K; radiates as a black body does

    bool operator==(const Thermal&) const = default; ///< member by member
};

/// Surface::heat where nothing is known.
inline constexpr std::uint32_t no_heat = 0xFFFFFFFF;

/// A planar convex triangle or quadrilateral. Front side: vertices counter-clockwise.
struct Surface {
    std::array<Vec3, 4> vertices{}; ///< The fourth is unused for a triangle.
    std::uint32_t vertex_count = 4; ///< 3 or 4
    std::uint32_t material = 0;     ///< Index into Scene::materials.
    std::uint32_t group = 0;        ///< Index into Scene::groups.
    bool two_sided = false;       ///< Radiates and receives on its back too; otherwise the back only blocks.
    std::optional<Grid> patches;  ///< Subdivision of its own; beats Scene::patch_size.
    std::uint32_t heat = no_heat; ///< Index into Thermal::conditions, or no_heat.
    /// A further piece of the face that the surface before it is of: one that is not plane, not convex, or of
    /// many corners.
    bool continues = false;
    bool joins = false; ///< Two triangles of the file, one after the other, that are its halves.

    /// The vertices that are used.
    [[nodiscard]] std::span<const Vec3> polygon() const { return {vertices.data(), vertex_count}; }
};

/// Of every surface, the number of the face that it is, is a piece of, or begins with: faces as the file has
/// them, from 0.
[[nodiscard]] std::vector<std::uint32_t> face_numbers(std::span<const Surface> surfaces);

/// Where a picture is taken from. An orthographic camera shows what a perspective one shows at the target's
/// depth, at that size everywhere, and nothing is too near for it: also what lies behind its eye.
struct Camera {
    Vec3 eye{0.0};              ///< position, scene units
    Vec3 target{0.0, 1.0, 0.0}; ///< what is in the middle of the picture
    Vec3 up{0.0, 0.0, 1.0};     ///< direction that is upwards in the picture, of any length
    double fov = 40.0;          ///< vertical field of view, degrees
    bool orthographic = false;  ///< else perspective
};

/// Light from afar: parallel, or from an evenly bright disc. It is not seen itself.
struct Sun {
    Vec3 direction{0.0, 0.0, 1.0};  ///< towards its middle, of unit length
    std::vector<double> irradiance; ///< of an area normal to the beam, W/m² (or lx), one value per channel
    double diameter = 0.0;          ///< of the disc, degrees, in [0, 90]; 0: parallel light

    bool operator==(const Sun&) const = default; ///< member by member
};

/// How bright a sky is in which direction above the horizon.
enum class SkyDistribution {
    uniform,  ///< the same everywhere
    overcast, ///< L = L_z (1 + 2 sin(elevation)) / 3. Source: CIE standard overcast sky, ISO 15469.
};

/// Words of SkyDistribution.
template <>
struct Names<SkyDistribution> {
    /// Every value with its word.
    static constexpr NamedValue<SkyDistribution> table[] = {{SkyDistribution::uniform, "uniform"},
                                                            {SkyDistribution::overcast, "overcast"}};
};

/// What comes from above and below the horizon, beside what Scene::environment sends from everywhere.
/// Upwards is Scene::up.
struct Sky {
    SkyDistribution distribution = SkyDistribution::uniform; ///< above the horizon
    std::vector<double>
        horizontal; ///< of an unobstructed horizontal area, W/m² (or lx), one value per channel
    /// Reflectance of the half-space below the horizon, which is lit by `horizontal`; one value per channel.
    std::vector<double> ground;

    bool operator==(const Sky&) const = default; ///< member by member
};

/// The axis that points upwards in a scene. Coordinates are the file's, whatever it is: cameras that are
/// chosen for a scene, the sky and its horizon, and where an azimuth counts from depend on it.
enum class UpAxis { y, z };

/// The words of UpAxis.
template <>
struct Names<UpAxis> {
    /// In the order in which they are listed.
    static constexpr NamedValue<UpAxis> table[] = {{UpAxis::y, "y"}, {UpAxis::z, "z"}};
};

/// Turns a direction (right, ahead, up) of a scene whose z axis points upwards into that of a scene of
/// another such axis; a quarter turn about x.
/// @param direction  of any length
/// @param up         of the other scene
[[nodiscard]] inline Vec3 turned_upright(const Vec3& direction, UpAxis up) {
    return up == UpAxis::z ? direction : Vec3(direction.x, direction.z, -direction.y);
}
/// The direction upwards, of unit length.
[[nodiscard]] inline Vec3 upwards(UpAxis up) {
    return turned_upright({0.0, 0.0, 1.0}, up);
}

/// A scene as its file tells it: plain data, in the file's order and units.
struct Scene {
    std::string name;                           ///< Its own, or the file's.
    std::vector<std::string> channels{"grey"};  ///< Names, of one channel or more.
    std::vector<Material> materials;            ///< In the file's order.
    std::vector<std::string> groups;            ///< Unique names, in order of first appearance.
    std::vector<Surface> surfaces;              ///< In the file's order.
    std::optional<double> patch_size;           ///< Longest patch edge, scene units.
    Enclosure enclosure = Enclosure::automatic; ///< What the file says about it.
    std::vector<double> environment; ///< Exitance of the environment (pi times its radiance), per channel.
    std::optional<Camera> camera;    ///< None: see default_camera().
    UpAxis up = UpAxis::z;           ///< for the sky, and for cameras that are chosen for the scene
    std::optional<double> unit;      ///< Metres in a scene unit; none: 1.
    /// What it says of heat. Reflectances of 1 are allowed where there is some: such surfaces are adiabatic.
    std::optional<Thermal> thermal;
    std::optional<Sun> sun;           ///< a beam that casts shadows
    std::optional<Sky> sky;           ///< what comes from above and below the horizon
    bool photometric = false;         ///< Fluxes are in lumens: exitances in lm/m², irradiances in lx.
    std::optional<Symmetry> symmetry; ///< the surfaces are a part of what is there; none: they are all

    /// Index of the group of that name, made if it is new.
    std::uint32_t group_index(const std::string& group_name);
    /// Of all vertices.
    [[nodiscard]] Bounds bounds() const;
};

/// Checks what every part of hemi relies on: at least one surface, indices in range, one value per channel,
/// reflectance in [0, 1), or [0, 1] where the scene is thermal, exitance finite and >= 0, finite planar
/// convex polygons of positive area, a scene that is not lost in the rounding of its coordinates.
/// @throws InputError naming the material or the group and surface, the value and the range.
void validate(const Scene& scene);

/// What is wrong with a polygon as a surface, or nothing: too few or too many vertices, a value that is not
/// finite, zero area, not planar (by more than 1e-5 of its size), not convex.
[[nodiscard]] std::optional<std::string> polygon_defect(std::span<const Vec3> polygon);

} // namespace hemi
