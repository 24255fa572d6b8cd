#pragma once

#include "engine/hemicube/draw_list.hpp"
#include "hemi/core/geometry.hpp"

#include <cstdint>

namespace hemi {

/// Grid coordinates of a polygon (of a general quadrilateral: the coordinates in the frame of corners 0, 1
/// and 3) as an affine function of the position on its plane: u + gradient_u · (p - origin).
struct GridMap {
    Vec3 origin{0.0};
    Vec3 gradient_u{0.0}, gradient_v{0.0};
    double u = 0.0, v = 0.0; ///< at the origin
};

[[nodiscard]] GridMap make_grid_map(const DrawList& list, std::uint32_t polygon);

} // namespace hemi
