#pragma once

#include "scene/cut_face.hpp"
#include "scene/surroundings.hpp"

#include <span>
#include <vector>

namespace hemi {

/// A side of a piece that sees no opening, and what it sees: backs and sides of pieces.
struct EnclosedSide {
    PieceSide side;
    double area = 0.0;
    Sight sight;
};

/// Which sides are in cavities of bodies: the foot of a box on a floor with a sheet through it.
///
/// Sides that see one another belong to one cavity. It is closed where none of them sees anything but backs
/// and one another. A closed one is a body's where, by area, at least 2 of 5 directions leave a body that
/// they did not enter, and an eighth of them at least meets backs: of a room of sheets within the shell of a
/// house nothing is left out. In place of that eighth, half may meet backs or faces that are in part outside
/// of all cavities. For the eighth, what meets faces that are in part outside of all cavities does
/// not count: through a house, walls do not pass.
/// @param sides  all that see no opening
/// @param faces  with all pieces, by PieceSide::face
[[nodiscard]] std::vector<PieceSide> sides_in_bodies(std::span<const EnclosedSide> sides,
                                                     std::span<const CutFace> faces);

} // namespace hemi
