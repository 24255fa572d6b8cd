#pragma once

#include <cstdint>
#include <vector>

namespace hemi {

/// Point of a quadrature rule on [0, 1].
struct GaussPoint {
    double at = 0.5;
    double weight = 1.0; ///< the weights of a rule sum to 1
};

/// Gauss–Legendre rule of `count` points, ascending; exact for polynomials up to degree 2·count - 1.
[[nodiscard]] std::vector<GaussPoint> gauss_legendre(std::uint32_t count);

} // namespace hemi
