#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/matrix/provenance.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Factor from a surface element at `at` with unit normal `normal` to a polygon, unoccluded.
///
/// The part of the polygon below the element's horizon does not count. 0 if the element sees the polygon's
/// back or lies in its plane.
/// @param at       position of the element, scene units
/// @param normal   of the element, of unit length
/// @param polygon  3 or 4 corners, planar, convex, counter-clockwise about its front.
/// Source: J. H. Lambert, "Photometria", 1760; C. M. Goral, K. E. Torrance, D. P. Greenberg, B. Battaile,
/// "Modeling the Interaction of Light Between Diffuse Surfaces", SIGGRAPH 1984; D. R. Baum, H. E. Rushmeier,
/// J. M. Winget, "Improving Radiosity Solutions Through the Use of Analytically Determined Form-Factors",
/// SIGGRAPH 1989.
[[nodiscard]] double point_factor(const Vec3& at, const Vec3& normal, std::span<const Vec3> polygon);

/// Solid angle of a polygon's front, unoccluded, in steradians, up to 2 pi. 0 from its back or in its plane.
/// @param at       position of the observer, scene units
/// @param polygon  3 to 6 corners, planar, convex, counter-clockwise about its front.
/// Source: A. Van Oosterom, J. Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30,
/// 1983.
[[nodiscard]] double solid_angle(const Vec3& at, std::span<const Vec3> polygon);

/// Exchange areas A_i F(i, j) of all pairs of patches, unoccluded, in scene units squared.
///
/// Only the parts of two patches that lie in front of each other count. Far pairs are integrated over both
/// areas, by products of Gauss rules; near ones over both contours, one integral in closed form, the other by
/// Gauss rules whose order follows from the distance of the two edges. Parallel edges and edges that touch
/// are done in closed form. No length is compared with a constant: results do not depend on scale, and
/// depend on the distance from the origin only as far as the corners were rounded there.
/// Thread-safe. Memory: about 300 bytes a patch.
/// Source: E. M. Sparrow, "A New and Simpler Formulation for Radiative Angle Factors", J. Heat Transfer 85,
/// 1963; P. Schröder, P. Hanrahan, "On the Form Factor between Two Polygons", SIGGRAPH 1993.
class ExchangeAreas {
public:
    /// @param mesh  is read here and not kept
    /// @param rule  how closely areas are computed
    explicit ExchangeAreas(const PatchMesh& mesh, ExchangeRule rule = ExchangeRule::standard);

    /// A_i F(i, j) = A_j F(j, i); both orders give the same bits. 0 where the two do not face each other, and
    /// on one surface.
    [[nodiscard]] double operator()(std::uint32_t i, std::uint32_t j) const;

    /// Factor from a surface element to patch j, unoccluded: point_factor(), but by the patch's Gauss points
    /// where it is far away.
    /// @param at      position of the element, scene units
    /// @param normal  of the element, of unit length
    /// @param j       the patch
    [[nodiscard]] double at_point(const Vec3& at, const Vec3& normal, std::uint32_t j) const;

    /// Solid angle of patch j's front, unoccluded: solid_angle().
    /// @param at  position of the observer, scene units
    /// @param j   the patch
    [[nodiscard]] double solid_angle_at(const Vec3& at, std::uint32_t j) const;

    /// Number of patches.
    [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(patches_.size()); }

private:
    struct Patch {
        Vec3 centre;   ///< mean of the corners, so in the patch's plane
        double radius; ///< of the sphere about it that holds the patch
        Vec3 normal;
        double area;
        /// Points and weights of the rule for far patches.
        std::array<double, 4> x, y, z, weight;
        /// Corners; those of a triangle end with the third one twice.
        std::array<double, 4> corner_x, corner_y, corner_z;
        std::uint32_t corners;
        std::uint32_t surface;
    };

    [[nodiscard]] static std::array<Vec3, 4> corners_of(const Patch& patch);
    [[nodiscard]] double near_area(const Patch& a, const Patch& b, bool clipped, double distance) const;

    ExchangeRule rule_;
    Vec3 origin_; ///< that coordinates count from
    double rounding_;
    double far_;
    std::vector<Patch> patches_;
};

} // namespace hemi
