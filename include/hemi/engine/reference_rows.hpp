#pragma once

#include "hemi/core/progress.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Up to `count` of `patches`, ascending, spread over all of them at irregular distances.
[[nodiscard]] std::vector<std::uint32_t> reference_patches(std::span<const std::uint32_t> patches,
                                                           std::uint32_t count);

/// Visibility by other and better eyes than those of `settings`: four times as many, from 16 to 64, turned
/// otherwise; where those have 64 themselves, 49 in other places. Rotations alone do not see what one eye
/// point a patch gets wrong.
[[nodiscard]] HemicubeSettings reference_settings(const HemicubeSettings& settings);

/// Rows of reference that say enough for most scenes.
inline constexpr std::uint32_t usual_reference_rows = 32;

/// How many rows of reference cost about `share` of all `rows` of `settings`, within 12 to `most`, which is
/// no less (or `rows`).
[[nodiscard]] std::uint32_t reference_count(const HemicubeSettings& settings, std::size_t rows, double share,
                                            std::uint32_t most = usual_reference_rows);

/// Rows that others are judged by: exact exchange areas times visibility, seen from i alone. The other rows
/// stay unknown.
/// @param visibility  by reference_settings()
/// @param mesh        the one that `visibility` sees
/// @param patches     ascending, see reference_patches()
/// @param progress    called after every row; may be empty
[[nodiscard]] FormFactorMatrix compute_reference(VisibilityProvider& visibility, const PatchMesh& mesh,
                                                 std::span<const std::uint32_t> patches,
                                                 const Progress& progress = {});

} // namespace hemi
