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

/// Corners whose values do not come from the patches that meet there.
struct GivenCorners {
    enum class Kind : std::uint8_t {
        mean,    ///< over the patches, as all others
        given,   ///< the value here
        unknown, ///< takes what its neighbours have, as the corners of covered patches
    };
    std::vector<Kind> kinds;   ///< of corner k of patch i at [i·4 + k]; empty: all are means
    std::vector<float> values; ///< channel c at [(i·4 + k)·channels + c]
};

/// As the public corner_values, for callers that need the welded surfaces too, or have some values.
[[nodiscard]] std::vector<float> corner_values(const PatchMesh& mesh, const SmoothSurfaces& surfaces,
                                               std::uint32_t channels, std::span<const double> values,
                                               std::span<const double> blocked,
                                               const GivenCorners& given = {});

} // namespace hemi
