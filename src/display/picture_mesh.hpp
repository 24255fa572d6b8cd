#pragma once

#include "hemi/display/picture.hpp"

#include "display/smooth_surfaces.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace hemi {

/// As the public make_picture_mesh, for callers that make it of the same patches again and again.
[[nodiscard]] PictureMesh make_picture_mesh(const PatchMesh& mesh, const SmoothSurfaces& surfaces,
                                            std::uint32_t channels, std::span<const double> radiosity,
                                            std::span<const double> blocked,
                                            std::array<std::uint32_t, 3> show,
                                            std::span<const float> vertices = {});

} // namespace hemi
