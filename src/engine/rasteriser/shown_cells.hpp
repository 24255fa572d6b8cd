#pragma once

#include "engine/rasteriser/projection.hpp"

namespace hemi {

/// What the texels of a polygon show.
struct Shown {
    std::uint32_t first_id = 0;
    std::uint32_t id_count = 1;
    bool cells = false; ///< ids by cell, as the shaders derive them
    Affine u, v;        ///< times 1 / depth; relative to base cells
    float base_u = 0.0f, base_v = 0.0f;
    float grid_u = 1.0f, grid_v = 1.0f;
    bool split = false;
    bool bilinear = false;
    float twist_u = 0.0f, twist_v = 0.0f;
};

/// What a polygon of several cells shows on a face.
/// @param grid     of RasterScene::grid_polygons
/// @param inverse  1 / depth of its plane
[[nodiscard]] Shown shown_cells(const RasterScene& scene, const Projection& projection, int face,
                                std::uint32_t grid, bool front, const Affine& inverse);

/// Counts cells from the one at the nearest corner of the box, where they are largest on the face.
/// @param box  left, right, low and high texel
void move_base(const Affine& inverse, Shown& shown, const std::array<int, 4>& box);

} // namespace hemi
