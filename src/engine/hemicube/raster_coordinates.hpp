#pragma once

#include "engine/hemicube/draw_list.hpp"
#include "hemi/core/geometry.hpp"

#include <array>

namespace hemi {

/// A position as the sum of two floats, x, y, z each.
struct SplitPosition {
    std::array<float, 3> high, low;
};

/// Raster coordinates, (p - origin)·scale, of magnitude 1 and less. Positions are kept as sums of two floats,
/// so that their difference to a sample point has the relative precision of a float however close the two
/// are.
struct RasterCoordinates {
    /// Those of what a draw list draws.
    explicit RasterCoordinates(const DrawList& list);

    [[nodiscard]] Vec3 of(const Vec3& position) const { return (position - origin) * scale; }
    [[nodiscard]] SplitPosition split(const Vec3& position) const;

    Vec3 origin{0.0};
    double scale = 1.0; ///< a power of two
};

} // namespace hemi
