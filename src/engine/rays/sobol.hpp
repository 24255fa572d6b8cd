#pragma once

#include <array>
#include <cstdint>

namespace hemi {

/// Point `index` of the four-dimensional Sobol sequence, each coordinate as a fraction of 2^32.
///
/// 2^k consecutive points from a multiple of 2^k on have one point in every elementary interval that the
/// sequence resolves. XOR with a constant keeps that.
/// Source: I. M. Sobol, 1967; S. Joe, F. Y. Kuo, "Constructing Sobol Sequences with Better Two-Dimensional
/// Projections", SIAM J. Sci. Comput. 30, 2008 (direction numbers).
[[nodiscard]] std::array<std::uint32_t, 4> sobol_point(std::uint32_t index);

} // namespace hemi
