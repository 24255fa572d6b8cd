#pragma once

#include "hemi/scene/scene.hpp"

#include <cstdint>
#include <vector>

namespace hemi {

/// Where a face has no other like it.
inline constexpr std::uint32_t no_duplicate = 0xFFFFFFFFu;

/// Of every surface the next one in the list that is the same: corners in the same places to the last bit,
/// from whichever of them it begins, the same side in front, or both two-sided. Material and group do not
/// count. Time: N log N.
[[nodiscard]] std::vector<std::uint32_t> next_duplicates(const Scene& scene);

} // namespace hemi
