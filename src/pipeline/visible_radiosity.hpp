#pragma once

#include "display/smooth_surfaces.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Radiosity of what can be seen of the patches. Where something stands on a patch, its own radiosity is the
/// mean with the part below, which gets no light; where hardly anything is left of it, the rest is as bright
/// as its surroundings.
/// @param near       patches that have a surface near in front of them, see find_near_surfaces()
/// @param channels   of the radiosity
/// @param radiosity  B, N·channels
/// @param exitance   E, N·channels
/// @param blocked    b_i of every patch, or empty
[[nodiscard]] std::vector<double> visible_radiosity(const PatchMesh& mesh, const SmoothSurfaces& surfaces,
                                                    std::span<const std::uint32_t> near,
                                                    std::uint32_t channels, std::span<const double> radiosity,
                                                    std::span<const double> exitance,
                                                    std::span<const double> blocked);

/// Patches that have a surface near in front of them, ascending.
[[nodiscard]] std::vector<std::uint32_t> patches_near_surfaces(const PatchMesh& mesh);

} // namespace hemi
