#pragma once

#include "hemi/core/buried.hpp"

#include "display/smooth_surfaces.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// A patch more than half of whose view meets back faces: its eye lies under or inside something.
[[nodiscard]] inline bool is_covered(std::span<const double> blocked, std::uint32_t patch) {
    return !blocked.empty() && blocked[patch] > buried_above;
}

/// As the public corner_values, for callers that need the welded surfaces too.
[[nodiscard]] std::vector<float> corner_values(const PatchMesh& mesh, const SmoothSurfaces& surfaces,
                                               std::uint32_t channels, std::span<const double> values,
                                               std::span<const double> blocked);

} // namespace hemi
