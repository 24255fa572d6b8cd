#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// How directions are weighed.
enum class DirectionMeasure {
    projected_solid_angle, ///< with the cosine to the normal, as a small area sends and receives
    solid_angle,           ///< all alike, as a small sphere receives
};

/// Weight of every texel of a hemicube: the share of the energy leaving the sample point, cosine-weighted
/// over the hemisphere, that passes through that texel. For small spheres, the share of the hemisphere's
/// solid angle instead.
///
/// Dimensionless, as integers in units of 1 / total, total = 2^32 - 1: exact integrals over the texel (not
/// midpoint values), rounded cumulatively so that they sum to exactly `total` at any resolution and any
/// order of summation gives the same bits. One of several sample points of a patch weighs its share of that.
/// Layout, as the engine's item buffers: top face `resolution` rows of `resolution` texels, then the four
/// sides, each `resolution / 2` rows of `resolution`, row 0 touching the plane of the patch.
/// Memory: 4 bytes for each of the 3·resolution·(resolution + 1) prefix sums.
/// Source: M. F. Cohen, D. P. Greenberg, "The Hemi-Cube", SIGGRAPH 1985; closed forms of the corner
/// integrals in delta_form_factors.cpp.
class DeltaFormFactors {
public:
    /// What all weights of a hemicube sum to: 2^32 - 1, which stands for 1.
    static constexpr std::uint32_t total = 0xFFFFFFFFu;

    /// @param resolution  texels along a full hemicube edge; even, 2 to 4096.
    /// @param measure     what the weights are shares of
    /// @throws InvalidArgument if `resolution` is odd or out of range.
    explicit DeltaFormFactors(std::uint32_t resolution,
                              DirectionMeasure measure = DirectionMeasure::projected_solid_angle);

    /// The weights of a sample point that stands for `share` of its patch, in (0, 1]: they sum to about
    /// share·total, never more.
    [[nodiscard]] DeltaFormFactors scaled(double share) const;

    /// Tests a resolution.
    /// @throws InvalidArgument if `resolution` is odd or out of range.
    static void check_resolution(std::uint32_t resolution);

    /// Texels along a full hemicube edge.
    [[nodiscard]] std::uint32_t resolution() const noexcept { return resolution_; }
    /// Sum of all weights.
    [[nodiscard]] std::uint32_t sum() const noexcept { return prefix_.back(); }
    /// Rows of texels of one hemicube: 3·resolution.
    [[nodiscard]] std::uint32_t rows() const noexcept { return 3 * resolution_; }

    /// Weight of texel (row, column).
    [[nodiscard]] std::uint32_t weight(std::uint32_t row, std::uint32_t column) const {
        const auto prefix = prefix_row(row);
        return prefix[column + 1] - prefix[column];
    }
    /// resolution + 1 prefix sums of a row: the weight of texels [a, b) is prefix[b] - prefix[a].
    [[nodiscard]] std::span<const std::uint32_t> prefix_row(std::uint32_t row) const {
        return {prefix_.data() + std::size_t{row} * (resolution_ + 1), resolution_ + 1};
    }

private:
    template <class Corners>
    void sum_up(const Corners& corners);

    std::uint32_t resolution_;
    std::vector<std::uint32_t> prefix_;
};

} // namespace hemi
