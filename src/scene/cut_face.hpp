#pragma once

#include "scene/convex_polygon.hpp"

#include <cstdint>
#include <vector>

namespace hemi {

inline constexpr std::uint32_t no_face = 0xFFFFFFFFu;

/// What a face touches.
struct Contacts {
    std::vector<Segment> cuts;           ///< within the face
    std::vector<std::uint32_t> cut_by;   ///< of each, which face
    std::vector<std::uint32_t> coplanar; ///< faces that lie over it in its plane
    std::uint32_t other = no_face;       ///< one of those that cut it
};

/// A piece of a face, and the sides of it that are left.
struct Piece {
    Polygon corners;
    std::uint32_t cell = 0; ///< of the face's grid
    bool whole = true;      ///< all of that cell
    bool front = true;
    bool back = true;
    bool covered = false; ///< no side is left, because faces lie over it in its plane
    /// A one-sided face lies over it in its plane that looks the other way, and its own face is one-sided.
    bool faced = false;

    [[nodiscard]] bool is_left() const { return front || back; }
};

/// A face that is cut, or looked at for what is covered of it.
struct CutFace {
    Contacts contacts;
    std::vector<Piece> pieces;
    std::uint32_t covered_by = no_face; ///< a face in its plane
    bool split = false;                 ///< into more than its cells
    bool buried = false;                ///< parts of it see backs alone
};

} // namespace hemi
