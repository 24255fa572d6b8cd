#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

namespace hemi {

/// What the hemicubes of one patch found of another, in two bytes, since there is one for every pair: the
/// visible share in 4095ths (12 bits), and how many texels it rests on as a power of two (4 bits).
/// The step of the share, 2.4e-4, is far below the noise of so few texels.
class VisibilitySample {
public:
    /// Nothing is known: the patch is out of view, or no texel covers it or its neighbours.
    VisibilitySample() = default;
    /// @param share   visible share, in [0, 1]
    /// @param texels  1 to 254, or visibility_clear, as in VisibilityRow
    VisibilitySample(float share, std::uint8_t texels) {
        const std::uint32_t parts = static_cast<std::uint32_t>(share_scale * share + 0.5F);
        const std::uint32_t strength =
            texels == visibility_clear
                ? clear
                : std::min<std::uint32_t>(static_cast<std::uint32_t>(std::bit_width(texels)), clear - 1);
        bits_ = static_cast<std::uint16_t>(parts | strength << share_bits);
    }

    [[nodiscard]] bool known() const { return bits_ >> share_bits != 0; }
    /// Whether no texel was hidden, of enough to say so.
    [[nodiscard]] bool is_clear() const { return bits_ >> share_bits == clear; }
    [[nodiscard]] double share() const { return (bits_ & share_mask) / static_cast<double>(share_scale); }
    /// Texels that the share rests on, rounded down to a power of two.
    [[nodiscard]] double weight() const {
        return is_clear() ? clear_weight : static_cast<double>(1u << (bits_ >> share_bits)) * 0.5;
    }

private:
    static constexpr std::uint32_t share_bits = 12;
    static constexpr std::uint32_t share_mask = (1u << share_bits) - 1;
    static constexpr float share_scale = static_cast<float>(share_mask);
    /// The strength that marks a clear sample; other strengths are at most 8, the width of 254.
    static constexpr std::uint32_t clear = 15;
    /// Texels that a clear sample counts for when the other end of the pair sees something hidden: the four
    /// bits that would say how many there were say that it is clear. Chosen, not fitted: a round number above
    /// the 12 texels that make a patch of a partly hidden polygon clear (visibility_accumulator.cpp).
    static constexpr double clear_weight = 32.0;

    std::uint16_t bits_ = 0;
};

/// Mean share of the patches that a row knows; 1 where it knows none.
[[nodiscard]] inline double mean_share(std::span<const VisibilitySample> row) {
    double sum = 0.0;
    std::size_t known = 0;
    for (const VisibilitySample sample : row) {
        sum += sample.known() ? sample.share() : 0.0;
        known += sample.known() ? 1 : 0;
    }
    return known == 0 ? 1.0 : sum / static_cast<double>(known);
}

} // namespace hemi
