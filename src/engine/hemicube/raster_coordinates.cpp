#include "engine/hemicube/raster_coordinates.hpp"

#include <algorithm>
#include <cmath>

namespace hemi {

RasterCoordinates::RasterCoordinates(const DrawList& list) {
    Bounds bounds;
    for (const Vec3& vertex : list.vertices) {
        bounds.add(vertex);
    }
    if (!list.vertices.empty()) {
        origin = bounds.centre();
        const Vec3 extent = bounds.upper - bounds.lower;
        const double largest = 0.5 * std::max({extent.x, extent.y, extent.z});
        scale = largest > 0.0 ? std::ldexp(1.0, -std::ilogb(largest) - 1) : 1.0;
    }
}

SplitPosition RasterCoordinates::split(const Vec3& position) const {
    const Vec3 raster = of(position);
    SplitPosition result{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double value = raster[static_cast<int>(axis)];
        result.high[axis] = static_cast<float>(value);
        result.low[axis] = static_cast<float>(value - static_cast<double>(result.high[axis]));
    }
    return result;
}

} // namespace hemi
