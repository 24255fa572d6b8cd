#pragma once

#include "engine/visibility_weighted/pair_combination.hpp"
#include "hemi/core/progress.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/scene/patch_mesh.hpp"

namespace hemi {

/// assemble_factors() where ranks share the pairs: each finds the exchange areas of its own, and gives them
/// to all. Every rank gets the whole matrix. Memory: that, and 16 bytes a pair of this rank.
/// @throws Cancelled
[[nodiscard]] FormFactorMatrix assemble_divided(const PairTable& pairs, const PatchMesh& mesh,
                                                const ExchangeAreas& exchange_areas,
                                                const Progress& progress);

} // namespace hemi
