#pragma once

#include "hemi/core/enclosure.hpp"
#include "hemi/core/geometry.hpp"

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

    bool operator==(const Material&) const = default; ///< member by member
};

/// Number of patches along the two directions of a surface.
struct Grid {
    std::uint32_t u = 1; ///< along vertex 0 -> vertex 1
    std::uint32_t v = 1; ///< along vertex 0 -> vertex 3 (quadrilateral); equal to u for a triangle

    bool operator==(const Grid&) const = default; ///< member by member
};

/// A planar convex triangle or quadrilateral. Front side: vertices counter-clockwise.
struct Surface {
    std::array<Vec3, 4> vertices{}; ///< The fourth is unused for a triangle.
    std::uint32_t vertex_count = 4; ///< 3 or 4
    std::uint32_t material = 0;     ///< Index into Scene::materials.
    std::uint32_t group = 0;        ///< Index into Scene::groups.
    bool two_sided = false;      ///< Radiates and receives on its back too; otherwise the back only blocks.
    std::optional<Grid> patches; ///< Subdivision of its own; beats Scene::patch_size.

    /// The vertices that are used.
    [[nodiscard]] std::span<const Vec3> polygon() const { return {vertices.data(), vertex_count}; }
};

/// Where a picture is taken from. An orthographic camera shows what a perspective one shows at the target's
/// depth, at that size everywhere, and nothing is too near for it: also what lies behind its eye.
struct Camera {
    Vec3 eye{0.0};              ///< position, scene units
    Vec3 target{0.0, 1.0, 0.0}; ///< what is in the middle of the picture
    Vec3 up{0.0, 0.0, 1.0};     ///< direction that is upwards in the picture, of any length
    double fov = 40.0;          ///< vertical field of view, degrees
    bool orthographic = false;  ///< else perspective
};

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

    /// Index of the group of that name, made if it is new.
    std::uint32_t group_index(const std::string& group_name);
    /// Of all vertices.
    [[nodiscard]] Bounds bounds() const;
};

/// Checks what every part of hemi relies on: at least one surface, indices in range, one value per channel,
/// reflectance in [0, 1), exitance finite and >= 0, finite planar convex polygons of positive area, a scene
/// that is not lost in the rounding of its coordinates.
/// @throws InputError naming the material or the group and surface, the value and the range.
void validate(const Scene& scene);

/// What is wrong with a polygon as a surface, or nothing: too few or too many vertices, a value that is not
/// finite, zero area, not planar (by more than 1e-5 of its size), not convex.
[[nodiscard]] std::optional<std::string> polygon_defect(std::span<const Vec3> polygon);

} // namespace hemi
