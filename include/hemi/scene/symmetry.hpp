#pragma once

#include "hemi/core/geometry.hpp"

#include <glm/mat3x3.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hemi {

struct Scene;

/// A plane across a coordinate axis.
struct MirrorPlane {
    int axis = 0;        ///< 0, 1, 2: x, y, z
    double offset = 0.0; ///< the coordinate of all of its points, scene units

    bool operator==(const MirrorPlane&) const = default; ///< member by member
};

/// Rotations about a coordinate axis that leave a scene as it is.
struct RotationAxis {
    int axis = 2;            ///< 0, 1, 2: x, y, z, through the origin
    std::uint32_t folds = 2; ///< turns by whole numbers of 360/folds degrees; 2 to 360

    bool operator==(const RotationAxis&) const = default; ///< member by member
};

/// How often a scene repeats each way along a translation where nothing says it.
inline constexpr std::uint32_t usual_images = 8;

/// What a scene repeats itself by: its surfaces are a part, the others are images of them. All combinations
/// of mirror images and rotations are images, and of those the translated ones.
struct Symmetry {
    std::vector<MirrorPlane> mirrors;     ///< at most one across each axis
    std::optional<RotationAxis> rotation; ///< none: not rotated
    std::vector<Vec3> periods;            ///< translations, with their opposites
    std::uint32_t images = usual_images;  ///< so many each way along every translation

    bool operator==(const Symmetry&) const = default; ///< member by member
};

/// What takes a scene to one of its images: lengths stay as they are.
struct Isometry {
    glm::dmat3 turn{1.0}; ///< orthogonal
    Vec3 shift{0.0};      ///< after it, scene units

    /// Where a point of the scene is in the image.
    [[nodiscard]] Vec3 operator()(const Vec3& point) const { return turn * point + shift; }
    /// The same of a direction.
    [[nodiscard]] Vec3 direction(const Vec3& of) const { return turn * of; }
    /// Whether the image is a mirror image: what is counter-clockwise is clockwise there.
    [[nodiscard]] bool mirrors() const { return glm::determinant(turn) < 0.0; }
};

/// Images of a scene by number; the first is the scene itself.
struct SceneImages {
    std::vector<Isometry> all;          ///< no two alike
    std::vector<std::uint32_t> inverse; ///< of each the number of the one that takes it back
};

/// Most images that a scene may have.
inline constexpr std::uint32_t most_images = 4096;

/// All images.
/// @throws InputError for a symmetry without mirror plane, rotation or translation; two planes across one
/// axis,
///   another number of folds, translations that are not finite or depend on each other, no images or more
///   than most_images; where mirrors and rotations go on without end; and where the translations are others
///   in mirror images or rotated ones
[[nodiscard]] SceneImages images_of(const Symmetry& symmetry);

/// A plane as the command line and files have it: "x=0".
[[nodiscard]] std::string plane_text(const MirrorPlane& plane);
/// The plane of such a text; nothing of another.
[[nodiscard]] std::optional<MirrorPlane> plane_from_text(std::string_view text);
/// "x", "y", "z" of 0, 1, 2.
[[nodiscard]] std::string axis_text(int axis);
/// The number of such a text; nothing of another.
[[nodiscard]] std::optional<int> axis_from_text(std::string_view text);

/// Checks that a scene can be the part that its symmetry repeats: images_of(); no surface beyond a mirror
/// plane or in it; no sky, and a sun in the same direction in all images.
/// @throws InputError with the surface and how far it is on the other side; as images_of()
void check_symmetry(const Scene& scene);

} // namespace hemi
