#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Patches with a known row that sees nothing at all and that are pressed face to face against another
/// surface (see patches_in_contact) by the body that they are of, or by the other side of their own sheet,
/// ascending. What lies back to back with a wall, a lamp outside of a room, is none of them.
[[nodiscard]] std::vector<std::uint32_t> find_touching_faces(const FormFactorMatrix& factors,
                                                             const PatchMesh& mesh);

/// In a closed scene, turns the environment share of the rows in `contacts` into a blocked share: they are
/// covered, not leaking. The raw rows cannot tell: the bottom of a box on a floor and the lower side of a
/// sheet in the open are the same to them. Open scenes are left alone. With Enclosure::automatic a scene
/// counts as closed if nothing but such patches sees the environment.
void mark_touching_faces_buried(FormFactorMatrix& factors, std::span<const std::uint32_t> contacts,
                                Enclosure enclosure);

} // namespace hemi
