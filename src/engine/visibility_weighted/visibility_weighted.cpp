// Form factors as analytic factors times visibility.
//
// With K(x, y) = cos(x) cos(y) / (pi r²) the kernel of the double area integral and v(x, y) 1 where x and y
// see each other, else 0,
//
//     A_i F(i, j) = integral of K v over both patches,    A_i F0(i, j) = integral of K over both patches,
//
// so that F(i, j) = F0(i, j) V(i, j) with V the mean of v weighted by K. F0, the unoccluded factor, has semi-
// analytic forms (ExchangeAreas). V is what hemicubes are good at: a hemicube at a point x of patch i splits
// the inner integral into delta form factors, integrals of K over the texels; with
//
//     V(i, j) = (sum of delta form factors of the texels that show j) / (sum over all texels that j covers),
//
// visible and covered counted on the same texels, the errors of the hemicube as an integrator cancel: where
// nothing is hidden V is exactly 1, however few the texels, and F is F0. K is symmetric, so V(i, j) and V(j,
// i) are two estimates of one number; they are pooled, and A_i F(i, j) = A_j F(j, i) holds exactly. In a room
// of 160 patches with a block in it, 4 hemicubes of 32² texels a patch give factors with an rms error
// of 5.5e-5, where one hemicube of as many texels, as an integrator, gives 1.3e-3.
//
// In large scenes patches are smaller than texels, and V is a share of few texels. Therefore
// - each direction is pooled over patches of the same surface until it has 2 texels (VisibilityAccumulator),
//   or over coplanar neighbours in the mesh (CoplanarNeighbours);
// - pairs that are partly hidden, for few texels, get shadow rays, if their factors matter
//   (ShadowRaySelection).
// In a room of 10,000 patches with 4 x 32² texels a patch the rms error of V over all pairs that face each
// other was 0.19 from a patch's own texels, 0.044 pooled, and 0.012 with 16 shadow rays.
//
// Source: M. F. Cohen, D. P. Greenberg, "The Hemi-Cube", SIGGRAPH 1985, for delta form factors and
// visibility; D. R. Baum, H. E. Rushmeier, J. M. Winget, "Improving Radiosity Solutions Through the Use of
// Analytically Determined Form-Factors", SIGGRAPH 1989, for analytic factors where the hemicube's assumptions
// do not hold. Visible over covered delta form factors, both directions pooled, is the measure of V of this
// project.
//
// Of a scene with symmetry the other patch is any patch or image of one. The pair of i and image g of j lies
// as the pair of j and the image of i by the way back does, and these two are combined; factors of j's images
// are added up. So A_i F(i, j) = A_j F(j, i), and F(i, i) is what i sees of its own images.
//
// Three phases, each of which takes what the one before returns: sample_visibility(), combine_pairs(),
// assemble_factors().

#include "hemi/engine/visibility_weighted.hpp"

#include "engine/row_sample.hpp"
#include "engine/visibility_weighted/factor_assembly.hpp"
#include "engine/visibility_weighted/pair_combination.hpp"
#include "engine/visibility_weighted/visibility_table.hpp"
#include "hemi/core/ranks.hpp"
#include "hemi/core/row_memory.hpp"

#include <algorithm>
#include <utility>

namespace hemi {

std::uint64_t visibility_weighted_memory(double entries_per_row, std::uint64_t rows, std::uint32_t size) {
    const auto count = static_cast<double>(rows);
    const double matrix = (rows_are_in_file() ? 0.0 : entries_per_row * count) *
                              (sizeof(std::uint32_t) + sizeof(float) + sizeof(std::uint8_t)) +
                          static_cast<double>(FormFactorMatrix(size).memory_bytes());
    const double pairs = count * size;
    if (ranks().size() == 1) {
        const double tables = pairs * (sizeof(VisibilitySample) + sizeof(PairVisibility));
        return static_cast<std::uint64_t>(memory_margin * matrix + tables);
    }
    // Each rank has samples of both directions, then its share of the entries once more.
    const double tables = pairs * (2 * sizeof(VisibilitySample) + sizeof(PairVisibility));
    const double entries = 8.0 * entries_per_row * count;
    return static_cast<std::uint64_t>(memory_margin * matrix + (tables + entries) / ranks().size());
}

VisibilityWeightedEstimate estimate_visibility_weighted(VisibilityProvider& visibility,
                                                        std::span<const std::uint32_t> patches,
                                                        std::uint32_t samples) {
    const RowSample sample = sample_rows(visibility, patches, samples, [](const VisibilityRow& row) {
        return static_cast<std::uint64_t>(
            std::count_if(row.shares.begin(), row.shares.end(), [](float share) { return share > 0.0f; }));
    });
    return {sample.entries_per_row,
            visibility_weighted_memory(sample.entries_per_row, patches.size(), visibility.size()),
            sample.seconds_per_row * static_cast<double>(patches.size())};
}

FormFactorMatrix compute_visibility_weighted(VisibilityProvider& visibility, const PatchMesh& mesh,
                                             std::span<const std::uint32_t> patches,
                                             const VisibilityWeightedSettings& settings, Enclosure enclosure,
                                             const Progress& rows_done, const Progress& pairs_combined,
                                             const Progress& pairs_done) {
    const ImageMesh images(mesh);
    const bool divided = ranks().size() > 1 && !images.any(); // ways back by images would be other ranks'
    VisibilityTable samples =
        sample_visibility(visibility, patches, images.mesh().size(), divided, rows_done);
    const PairTable pairs = combine_pairs(std::move(samples), images, settings.shadow_rays, pairs_combined);
    return assemble_factors(pairs, images, settings.rule, enclosure, pairs_done);
}

} // namespace hemi
