#pragma once

#include "core/box_tree.hpp"
#include "hemi/core/geometry.hpp"
#include "hemi/scene/symmetry.hpp"

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// One side of a piece of a face.
struct PieceSide {
    std::uint32_t face = 0;
    std::uint32_t piece = 0;
    bool back = false;

    auto operator<=>(const PieceSide&) const = default;
};

/// What hides others: a face, or a piece of one.
struct Occluder {
    static constexpr std::uint32_t whole = 0xFFFFFFFFu; ///< no piece

    std::span<const Vec3> corners;
    Vec3 normal;
    std::uint32_t face;
    std::uint32_t piece; ///< or `whole`
    bool front;          ///< radiates from its front
    bool back;
    bool sheet;         ///< its face is two-sided: it bounds no body
    bool image = false; ///< in an image of the scene: hides what the face itself sees, too
};

/// What a point beside a face sees, but for directions in which it sees borders.
struct Sight {
    /// Nothing in some direction, or whole faces that bodies do not hide: no more was looked at.
    bool open = false;
    int backs = 0;                     ///< in so many directions it sees what does not radiate
    std::vector<PieceSide> sides;      ///< in others sides of pieces, which do: one for every direction
    std::vector<std::uint32_t> wholes; ///< in the others whole faces, which do
    /// In so many directions a body is left that was not entered before: what looks is inside that body.
    /// Sheets are looked through.
    int inside = 0;

    [[nodiscard]] bool only_backs() const { return !open && backs > 0 && backs == directions(); }
    [[nodiscard]] int directions() const {
        return backs + static_cast<int>(sides.size()) + static_cast<int>(wholes.size());
    }
};

/// Directions over a hemisphere about `normal`, evenly spread: 64.
[[nodiscard]] std::vector<Vec3> hemisphere(const Vec3& normal);

/// All that hides others in a scene.
class Surroundings {
public:
    /// @param occluders  of the part of a scene that is given
    /// @param slack      what is no farther from an occluder's border meets it
    /// @param symmetry   of the scene, whose images hide as well
    Surroundings(std::vector<Occluder> occluders, double slack, const std::optional<Symmetry>& symmetry = {});

    /// @param face  is not seen itself
    [[nodiscard]] Sight look(std::uint32_t face, const Vec3& eye, std::span<const Vec3> rays) const;

private:
    std::vector<std::vector<Vec3>> image_corners_; ///< of occluders that are images
    std::vector<Occluder> occluders_;
    BoxTree tree_;
    double slack_;
};

} // namespace hemi
