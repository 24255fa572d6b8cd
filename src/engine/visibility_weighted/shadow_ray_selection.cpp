#include "engine/visibility_weighted/shadow_ray_selection.hpp"

#include "hemi/core/ranks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace hemi {

namespace {

/// A V this near to 0 or 1 is left alone: a third of the step that even 64 rays, the most that a preset
/// traces, can tell (1/64).
constexpr double near_certain = 0.005;
/// Rays and texels are weighed by their numbers: with this many texels a ray or more, rays would make up a
/// fifth or less of the result, and are not worth their time.
constexpr double max_texels_per_ray = 4.0;

/// Where no texel covers a pair its V is assumed; even odds have the largest variance.
constexpr double unknown_visibility = 0.5;
/// … and count as half a texel: less than any sample, without dividing by 0.
constexpr double min_texels = 0.5;
/// Of the height of a patch's highest corner above the other's plane: the mean height, for a patch that
/// stands on that plane. For pairs near an edge, whose centres say little.
constexpr double mean_of_highest = 0.5;

/// Pairs that get no rays have together at most this share of the variance of all uncertain pairs: what rays
/// cannot improve then is at most the root of it, 22 %, of the rms error that there was. Chosen, not fitted.
constexpr double left_out_share = 0.05;
/// Rows that the smallest variance worth rays is found from: it need only be right to a power of two.
constexpr std::size_t sampled_rows = 64;
/// Variances are sorted into powers of two from here to 2^0, which none exceeds; smaller ones count as this.
/// 2^-160 is the variance of a factor of about 1e-24, and too small to matter.
constexpr int min_exponent = -160;

} // namespace

ShadowRaySelection::ShadowRaySelection(const PatchMesh& mesh, const FacingTest& facing,
                                       std::span<const std::uint32_t> patches, const OwnRows& own,
                                       std::uint32_t rays, const Estimate& estimate)
    : mesh_(mesh), facing_(facing), rays_(rays), min_variance_(find_min_variance(patches, own, estimate)) {}

/// Whether a pair is partly hidden, and few texels say how much.
bool ShadowRaySelection::is_uncertain(const PairEstimate& pair) const {
    const double visibility = pair.visibility.value();
    const bool certain = visibility < near_certain || visibility > 1.0 - near_certain;
    return (pair.texels == 0.0 || !certain) && pair.texels < max_texels_per_ray * rays_;
}

/// The variance of the larger of F(i, j) and F(j, i), up to a factor that all pairs have: F0² V (1 - V) over
/// the number of texels, that of a share found from so many independent trials.
double ShadowRaySelection::variance(const PairEstimate& pair, std::uint32_t i, std::uint32_t j) const {
    const Vec3 way = mesh_.centres()[j] - mesh_.centres()[i];
    const double squared = glm::dot(way, way);
    // F0 about, from centre to centre: cos · cos · A / r², with r·cos the height above the other's plane.
    const double here = std::max(glm::dot(way, mesh_.normal(i)), mean_of_highest * facing_.height(i, j));
    const double there = std::max(-glm::dot(way, mesh_.normal(j)), mean_of_highest * facing_.height(j, i));
    const double larger = std::max(mesh_.areas()[i], mesh_.areas()[j]);
    const double factor = std::min(1.0, here * there * larger / (squared * squared));
    const double visibility = pair.texels == 0.0 ? unknown_visibility : pair.visibility.value();
    return factor * factor * visibility * (1.0 - visibility) / std::max(pair.texels, min_texels);
}

double ShadowRaySelection::find_min_variance(std::span<const std::uint32_t> patches, const OwnRows& own,
                                             const Estimate& estimate) const {
    constexpr std::size_t exponents = 1 - min_exponent;
    const std::size_t rows = std::min(sampled_rows, patches.size());
    std::vector<double> of_rows(rows * exponents, 0.0); // by sampled row, then by exponent
    for (std::size_t sample = 0; sample < rows; ++sample) {
        const std::size_t k = (2 * sample + 1) * patches.size() / (2 * rows);
        if (!own.contains(k)) {
            continue;
        }
        double* const sums = of_rows.data() + sample * exponents;
        for (std::uint32_t j = 0; j < mesh_.size(); ++j) {
            const PairEstimate pair = estimate(k, j);
            if (const double one = is_uncertain(pair) ? variance(pair, patches[k], j) : 0.0; one > 0.0) {
                sums[std::clamp(std::ilogb(one), min_exponent, 0) - min_exponent] += one;
            }
        }
    }
    if (own.divided()) { // a row is 0 but in one rank
        const std::vector<double> all = gather_values(ranks(), std::span<const double>(of_rows));
        std::fill(of_rows.begin(), of_rows.end(), 0.0);
        for (std::size_t k = 0; k < all.size(); ++k) {
            of_rows[k % of_rows.size()] += all[k];
        }
    }
    std::array<double, exponents> sums{};
    for (std::size_t k = 0; k < of_rows.size(); ++k) {
        sums[k % exponents] += of_rows[k];
    }
    const double total = std::accumulate(sums.begin(), sums.end(), 0.0);
    if (!(total > 0.0)) {
        return 0.0; // the sample has no uncertain pair: rays for all others
    }
    double below = 0.0;
    int exponent = min_exponent;
    for (; exponent < 0 &&
           below + sums[static_cast<std::size_t>(exponent - min_exponent)] <= left_out_share * total;
         ++exponent) {
        below += sums[static_cast<std::size_t>(exponent - min_exponent)];
    }
    return std::ldexp(1.0, exponent);
}

} // namespace hemi
