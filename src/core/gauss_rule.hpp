#pragma once

#include <cstddef>
#include <span>

namespace hemi {

/// Points and weights of a Gauss-Legendre rule on [-1, 1], points ascending; the weights sum to 2.
/// Polynomials up to degree 2n - 1 are integrated exactly.
struct GaussRule {
    std::span<const double> points;
    std::span<const double> weights;
};

inline constexpr std::size_t gauss_rule_max = 32;

/// The rule of `n` points, 1 to gauss_rule_max.
[[nodiscard]] GaussRule gauss_rule(std::size_t n);

} // namespace hemi
