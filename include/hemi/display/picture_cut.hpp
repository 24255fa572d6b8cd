#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/core/names.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi {

/// How much of a group a picture shows.
enum class Visibility : std::uint8_t {
    shown,    ///< its patches
    outlines, ///< the outlines of its patches; one looks through them
    hidden,   ///< nothing
};

/// Words of Visibility.
template <>
struct Names<Visibility> {
    /// Every value with its word.
    static constexpr NamedValue<Visibility> table[] = {
        {Visibility::shown, "shown"}, {Visibility::outlines, "outlines"}, {Visibility::hidden, "hidden"}};
};

/// A plane that cuts a picture: points with dot(normal, point) <= offset are shown.
struct ClipPlane {
    Vec3 normal{1.0, 0.0, 0.0}; ///< of unit length, towards what is cut away
    double offset = 0.0;        ///< scene units

    bool operator==(const ClipPlane&) const = default; ///< member by member
};

/// Reads what is shown: "x<1.5" or "z>0", of any axis, or "A,B,C<D" where A x + B y + C z is less than D.
/// @param text  without blanks
/// @throws InvalidArgument for anything else, for numbers that are not finite, and where A, B and C are 0
[[nodiscard]] ClipPlane parse_clip_plane(const std::string& text);

/// What parse_clip_plane() reads as the same plane.
/// @param plane  its normal is of unit length
[[nodiscard]] std::string clip_plane_text(const ClipPlane& plane);

/// What a picture leaves out of a scene, which takes part in its light all the same.
struct PictureCut {
    std::vector<Visibility> groups{}; ///< by the groups' index; empty, or too few: others are shown
    std::optional<ClipPlane> clip{};  ///< none: nothing is cut

    /// How much is shown of a group.
    [[nodiscard]] Visibility of_group(std::uint32_t group) const {
        return group < groups.size() ? groups[group] : Visibility::shown;
    }
    /// Whether the plane leaves a point.
    [[nodiscard]] bool keeps(const Vec3& point) const {
        return !clip || glm::dot(clip->normal, point) <= clip->offset;
    }
    bool operator==(const PictureCut&) const = default; ///< member by member
};

/// Index of a group.
/// @param groups  names of all groups
/// @param name    of the one
/// @param what    begins the message, such as "--hide"
/// @throws InvalidArgument where there is no such group, with the nearest name
[[nodiscard]] std::uint32_t group_by_name(std::span<const std::string> groups, const std::string& name,
                                          const std::string& what);

} // namespace hemi
