#pragma once

#include "hemi/core/progress.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <span>

namespace hemi {

/// What compute_visibility_weighted() needs for rows, see estimate_visibility_weighted().
struct VisibilityWeightedEstimate {
    double entries_per_row = 0.0;   ///< mean over the sample: patches that are not wholly hidden
    std::uint64_t memory_bytes = 0; ///< of the table of pairs and the matrix, with 20 % on top of the latter
    double seconds = 0.0;           ///< for the visibility of all rows, at the sample's speed
};

/// Bytes that compute_visibility_weighted() needs.
/// @param entries_per_row  mean of the patches that are not wholly hidden
/// @param rows             that are wanted
/// @param size             N
[[nodiscard]] std::uint64_t visibility_weighted_memory(double entries_per_row, std::uint64_t rows,
                                                       std::uint32_t size);

/// What compute_visibility_weighted() needs for the rows of `patches`, from up to `samples` of them spread
/// evenly.
/// @param visibility  see make_visibility_engine()
/// @param patches     ascending
/// @param samples     rows that are computed, and thrown away
[[nodiscard]] VisibilityWeightedEstimate estimate_visibility_weighted(VisibilityProvider& visibility,
                                                                      std::span<const std::uint32_t> patches,
                                                                      std::uint32_t samples = 64);

/// What changes the rows, besides what changes their visibility.
struct VisibilityWeightedSettings {
    ExchangeRule rule = ExchangeRule::standard; ///< of F0
    /// Shadow rays between the two patches of every pair that is partly hidden and whose visibility rests on
    /// less than four times as many texels (counted up to 256); rays and texels are weighted by their
    /// numbers. Pairs that matter least get none: those that together have up to a twentieth of the variance
    /// of all such pairs, by a sample of the rows. 0: no rays at all.
    std::uint32_t shadow_rays = 0;

    bool operator==(const VisibilityWeightedSettings&) const = default; ///< member by member
};

/// Form factors of `patches` as F(i, j) = F0(i, j)·V(i, j).
///
/// F0(i, j) is the factor of the two polygons without occlusion, from their exchange area
/// X0(i, j) = A_i F0(i, j) = A_j F0(j, i) (ExchangeAreas), computed once a pair. V(i, j) = V(j, i) is the
/// visible share of the delta form factors of the texels that the patches cover in each other's hemicubes,
/// both directions weighted by their numbers of texels, refined by shadow rays where it is between 0 and 1.
/// So the factors of pairs that see all of each other carry F0's error alone, and A_i F(i, j) = A_j F(j, i)
/// up to the rounding to float. Every entry has its visibility beside it.
///
/// Balance: where a row sees nothing of the environment, e is 0 and b what was measured, and the sum is what
/// comes out, for repair() to close. Where it does, e is what the sum and b leave of 1, since F0 knows that
/// better than hemicubes do; but in a closed scene e stays what was measured, a leak, as far as the sum
/// allows it. With Enclosure::automatic rows of patches inside a closed body of faces have e = 0, and the
/// scene is closed if no other row leaves more of 1 than the error of F0 (known by the exact rule for the
/// four rows that leave most), and texels measure at most 1e-4 where something is hidden, so that the sum
/// does not say.
///
/// Memory: for every pair of one of `patches` with any patch 4 bytes until pairs are combined, then 2; and
/// the matrix.
/// Source: M. F. Cohen, D. P. Greenberg, "The Hemi-Cube", SIGGRAPH 1985; D. R. Baum, H. E. Rushmeier, J. M.
/// Winget, "Improving Radiosity Solutions Through the Use of Analytically Determined Form-Factors",
/// SIGGRAPH 1989; derivation in visibility_weighted.cpp.
/// @param visibility      of the same mesh, see make_visibility_engine()
/// @param mesh            N patches
/// @param patches         rows that are wanted, ascending; the others stay unknown
/// @param settings        rule of F0, shadow rays
/// @param enclosure       as the scene says
/// @param rows_done       called after every row of visibility; may be empty
/// @param pairs_combined  called after every 64 rows whose visibility was combined; may be empty
/// @param pairs_done      called after every 64 rows of factors; may be empty
/// @throws Cancelled when one of them returns false.
[[nodiscard]] FormFactorMatrix compute_visibility_weighted(
    VisibilityProvider& visibility, const PatchMesh& mesh, std::span<const std::uint32_t> patches,
    const VisibilityWeightedSettings& settings, Enclosure enclosure, const Progress& rows_done = {},
    const Progress& pairs_combined = {}, const Progress& pairs_done = {});

} // namespace hemi
