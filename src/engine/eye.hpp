#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <vector>

namespace hemi {

/// Where a hemicube stands. Trivially copyable.
struct EyePoint {
    Vec3 position{0.0};
    Vec3 normal{0.0};
    std::uint32_t surface = 0; ///< the surface that it lies on
};

/// One eye point a patch: its centroid.
[[nodiscard]] std::vector<EyePoint> make_eye_points(const PatchMesh& mesh);

/// Axes of a hemicube: z is the patch's normal, x and y are turned about it by an angle hashed from the patch
/// index and the seed. Without the turn, patch edges fall exactly on texel centres in regular scenes.
struct EyeFrame {
    Vec3 x, y, z;

    EyeFrame(const Vec3& normal, std::uint32_t patch, std::uint64_t seed);
};

/// Faces of a hemicube, in the order of the item buffer.
inline constexpr int hemicube_faces = 5;

/// Direction through a point of a face, in the eye's frame. Face 0 is the top (depth along z, `right` along
/// x, `up` along y); faces 1 to 4 look along +x, +y, -x, -y with `up` along z.
[[nodiscard]] Vec3 face_direction(int face, double right, double up);

} // namespace hemi
