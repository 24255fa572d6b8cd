#pragma once

#include "hemi/scene/imprint.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hemi {

/// Gaps up to this share of the scene's diagonal are none, as where corners are welded.
inline constexpr double contact_share = 1e-7;

/// Corners of faces, those in one place made one.
struct WeldedFaces {
    std::vector<std::array<std::uint32_t, 4>>
        corners; ///< of every face; the fourth of a triangle is 0xFFFFFFFF
    std::size_t vertex_count = 0;
};

/// @param tolerance  corners no farther apart are one
[[nodiscard]] WeldedFaces weld(const Scene& scene, double tolerance);

/// A scene without faces that are there again, and one-sided ones back to back in one place.
struct Joined {
    Scene scene;
    std::vector<std::uint32_t> face_of{};
    std::vector<Imprint::Finding> findings{};
    double left_out = 0.0;                           ///< area
    std::vector<std::vector<std::uint32_t>> backs{}; ///< of every face that was joined: its backs' patches
};

/// Of faces that are the same keeps the last one, which is on top of the others.
/// Of two one-sided faces with the same corners, which look different ways and are of one material and group
/// and alike subdivided, makes one that is two-sided: a picture cannot tell which of two in one place is
/// nearer.
[[nodiscard]] Joined join_back_to_back(const Scene& scene, const Subdivision& subdivision);

/// Of every patch of a scene whose faces were joined, the one that it was before.
/// @param mesh     of the joined scene
/// @param as_read  of the scene before
[[nodiscard]] std::vector<std::uint32_t> patches_before(const Joined& joined, const PatchMesh& mesh,
                                                        const PatchMesh& as_read);

} // namespace hemi
