#pragma once

#include "engine/visibility_weighted/pair_combination.hpp"
#include "hemi/core/progress.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/scene/image_mesh.hpp"

namespace hemi {

/// Drops entries that are zero after all.
void drop_zeros(RowBlock& block);

/// F(i, j) = X0(i, j) V(i, j) / A_i for all pairs of the table, X0(i, j) = A_i F0(i, j) being the unoccluded
/// exchange area, and the balance of every row. Last phase of compute_visibility_weighted(), which says what
/// the balance is.
/// @param pairs      V of all pairs
/// @param images     of the scene that `pairs` are of; factors of a patch and all images of another are added
/// up
/// @param rule       of F0
/// @param enclosure  as the scene says
/// @param progress   called after every block of rows; may be empty
/// @throws Cancelled
[[nodiscard]] FormFactorMatrix assemble_factors(const PairTable& pairs, const ImageMesh& images,
                                                ExchangeRule rule, Enclosure enclosure,
                                                const Progress& progress);

} // namespace hemi
