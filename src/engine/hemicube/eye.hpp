#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Where a hemicube stands. Trivially copyable.
struct EyePoint {
    Vec3 position{0.0};
    Vec3 normal{0.0};
    double share = 1.0;        ///< of its patch that it stands for; a patch's shares sum to 1
    std::uint32_t surface = 0; ///< the surface that it lies on; another number: none
    std::uint32_t index = 0;   ///< among the eye points of its patch
};

/// Where the hemicubes of all patches stand: those of patch i are [first[i], first[i + 1]).
struct EyePoints {
    std::vector<EyePoint> points;
    std::vector<std::uint32_t> first; ///< N + 1

    [[nodiscard]] std::uint32_t patches() const { return static_cast<std::uint32_t>(first.size() - 1); }
    [[nodiscard]] std::span<const EyePoint> of(std::uint32_t patch) const {
        return std::span(points).subspan(first[patch], first[patch + 1] - first[patch]);
    }
};

/// Long patches have at most so many times the eye points that were asked for.
inline constexpr std::uint32_t max_more_eye_points = 4;

/// Eye points of every patch. One: its centroid. k²: a Gauss–Legendre rule of k × k points on quadrilaterals,
/// weighted by the share of the area they stand for; on triangles the symmetric rule of fewest points that
/// integrates polynomials of degree k (1, 3, 6 or 12 points, k = 1 to 4; above that as on quadrilaterals).
/// Patches whose length is more than twice their width have ceil(length / 2 width) times as many, at most
/// four times, as a Fibonacci lattice along them; one point remains one point.
/// @param count       a square: 1, 4, 9 … 64
/// @param near_count  another: where a surface hovers close above a patch or stands on it
///   (find_near_surfaces), at a gap of g patch sizes, k is at least 1 / 2g, but k² at most this; the points
///   are then those of a Fibonacci lattice
/// @throws InvalidArgument if one is another number.
[[nodiscard]] EyePoints make_eye_points(const PatchMesh& mesh, std::uint32_t count,
                                        std::uint32_t near_count = 1);

/// Axes of a hemicube: z is the patch's normal, x and y are turned about it by an angle hashed from the patch
/// index, the index of the eye point and the seed. Without the turn, patch edges fall exactly on texel
/// centres in regular scenes.
struct EyeFrame {
    Vec3 x, y, z;

    EyeFrame(const Vec3& normal, std::uint32_t patch, std::uint32_t eye, std::uint64_t seed);
};

/// Faces of a hemicube, in the order of the item buffer.
inline constexpr int hemicube_faces = 5;

/// Direction through a point of a face, in the eye's frame. Face 0 is the top (depth along z, `right` along
/// x, `up` along y); faces 1 to 4 look along +x, +y, -x, -y with `up` along z.
[[nodiscard]] Vec3 face_direction(int face, double right, double up);

} // namespace hemi
