#pragma once

#include "viewer/look.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hemi::viewer {

/// One of the patches that a picked one exchanges most light with.
struct Partner {
    std::uint32_t patch;
    double factor; ///< F(picked, patch), or F(patch, picked) where columns are shown
    double share;  ///< of the light that arrives at the picked patch from all patches; 0 where none does
};

/// A picked patch, and whom it faces.
struct PickedPatch {
    std::uint32_t patch;
    std::vector<Partner> partners; ///< largest first, a few; empty without form factors
};

/// The `count` patches with the largest factor, or that send the most light.
/// @param column  factors are F(patch, picked), else F(picked, patch)
[[nodiscard]] std::vector<Partner> largest_partners(const ViewerInput& input, const Light& light,
                                                    std::uint32_t picked, bool column, bool by_light,
                                                    std::size_t count);

} // namespace hemi::viewer
