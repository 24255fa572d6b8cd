#include "engine/rays/sobol.hpp"

namespace hemi {

namespace {

/// A primitive polynomial over GF(2), its inner coefficients as bits of `inner`, and the first direction
/// numbers.
struct Dimension {
    std::uint32_t degree;
    std::uint32_t inner;
    std::array<std::uint32_t, 3> first;
};
constexpr std::array<Dimension, 3> dimensions{{{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}}};

using Directions = std::array<std::array<std::uint32_t, 32>, 4>;

constexpr Directions make_directions() {
    Directions directions{};
    for (std::uint32_t bit = 0; bit < 32; ++bit) {
        directions[0][bit] = 1u << (31 - bit);
    }
    for (std::size_t d = 0; d < dimensions.size(); ++d) {
        const Dimension& dimension = dimensions[d];
        auto& v = directions[d + 1];
        for (std::uint32_t bit = 0; bit < 32; ++bit) {
            if (bit < dimension.degree) {
                v[bit] = dimension.first[bit] << (31 - bit);
                continue;
            }
            const std::uint32_t before = v[bit - dimension.degree];
            v[bit] = before ^ (before >> dimension.degree);
            for (std::uint32_t k = 1; k < dimension.degree; ++k) {
                if (((dimension.inner >> (dimension.degree - 1 - k)) & 1u) != 0) {
                    v[bit] ^= v[bit - k];
                }
            }
        }
    }
    return directions;
}

constexpr Directions directions = make_directions();

} // namespace

std::array<std::uint32_t, 4> sobol_point(std::uint32_t index) {
    std::array<std::uint32_t, 4> point{};
    for (std::uint32_t bit = 0; index != 0; ++bit, index >>= 1) {
        if ((index & 1u) != 0) {
            for (std::size_t d = 0; d < point.size(); ++d) {
                point[d] ^= directions[d][bit];
            }
        }
    }
    return point;
}

} // namespace hemi
