#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>

namespace hemi {

/// Form factors of single patches: what comes from a cluster is shared out among its patches by their
/// weights. Row balance stays; visibilities are not kept, as clusters have none of single patches.
/// @param factors     with clusters; without, the result is the same matrix
/// @param max_memory  bytes that the result may take
/// @throws OutOfMemory if it would take more, before anything is made
[[nodiscard]] FormFactorMatrix expand_clusters(const FormFactorMatrix& factors, std::uint64_t max_memory);

} // namespace hemi
