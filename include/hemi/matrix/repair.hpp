#pragma once

#include "hemi/core/names.hpp"
#include "hemi/core/progress.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <span>

namespace hemi {

/// What is made true of the rows. x_ij = A_i F(i, j) is the exchange area of a pair.
enum class Repair {
    none, ///< nothing: the rows as they were computed
    /// A_i F(i, j) = A_j F(j, i): x = (F(i, j) + F(j, i)) / (1/A_i + 1/A_j), which trusts the row of the
    /// smaller patch; a factor that is not stored counts 0. Row sums are what comes of it.
    reciprocity,
    /// Reciprocity, and sum_j F(i, j) = 1 - e_i - b_i in all known rows that are not covered: the least
    /// change sum (x - x0)²/w that does it, w being the variance of x0; no x below 0, none above its
    /// unoccluded value where something hides part of it.
    closure,
};

/// Words of Repair.
template <>
struct Names<Repair> {
    /// Every value with its word.
    static constexpr NamedValue<Repair> table[] = {
        {Repair::none, "none"}, {Repair::reciprocity, "reciprocity"}, {Repair::closure, "closure"}};
};

/// How far rows are repaired.
struct RepairSettings {
    /// Relative error of the unoccluded factor F0(i, j) where factors are F0·V: 1e-3 by the standard rule,
    /// 3e-5 by the exact one. Pairs that see each other clearly may move by about this, and partly hidden
    /// ones may exceed F0 by it.
    double unoccluded_error = 1e-3;
    double tolerance = 1e-9;             ///< of a row sum, before it is rounded to floats
    std::uint32_t max_passes = 20;       ///< with more and more pairs held at their bounds
    std::uint32_t max_iterations = 2000; ///< of conjugate gradients, a pass
};

/// |sum_j F(i, j) + e_i + b_i - 1| over the rows that are known and not covered.
struct RowImbalance {
    double max = 0.0; ///< the largest
    double rms = 0.0; ///< root of the mean square
};

/// What a repair did.
struct RepairReport {
    Repair repair = Repair::none;    ///< what was asked for
    RowImbalance row_error_before;   ///< how far rows were from balance
    RowImbalance row_error_after;    ///< how far they are now
    Reciprocity reciprocity_before;  ///< how far pairs were apart
    Reciprocity reciprocity_after;   ///< how far they are now
    std::uint64_t added = 0;         ///< entries that only the other direction had stored
    std::uint32_t iterations = 0;    ///< of conjugate gradients, in all passes
    std::uint32_t passes = 0;        ///< with the pairs at their bounds held there since
    std::uint64_t at_zero = 0;       ///< pairs held at 0
    std::uint64_t at_unoccluded = 0; ///< pairs held at their unoccluded value
    double largest_change = 0.0;     ///< of a pair that was not 0, relative, by closure
};

/// Repairs rows in place.
///
/// Factors with visibility, F = F0·V with F0(i, j) the unoccluded factor, start from x0 = X0·V, X0 = A_i
/// F0(i, j) being the unoccluded exchange area, and have w = X0² [V (1 - V) + r²] with r the relative error
/// of F0 and without V (1 - V) where the pair is clear. Plain rows are made reciprocal first and have w =
/// x0². With row targets t and x = x0 + w_ij (l_i + l_j) the multipliers solve (diag(W 1) + W) l = t - (row
/// sums of x0), by conjugate gradients with a diagonal preconditioner. Pairs beyond a bound are put there and
/// held, and the rest is solved again. Where targets contradict each other (two facing plates of different
/// targets) the rows come as close as they can. Covered rows (b > buried_above) and unknown rows set no
/// target; unknown rows stay empty, and pairs with them are in the known row only. The diagonal,
/// what patches exchange with their own images, is of pairs like others. Rows that are reciprocal to the
/// rounding of floats are afterwards, too. Memory: O(N), 1 bit an entry where something is held at X0, and
/// the entries that are added. The result is the same on any number of threads. Source: least-squares
/// enforcement as in R. P. Taylor, R. Luck, "Comparison of reciprocity and closure enforcement methods for
/// radiation view factors", J. Thermophysics and Heat Transfer 9, 1995.
/// @param factors   N rows, changed in place
/// @param areas     N areas
/// @param repair    what is made true; none only measures
/// @param settings  tolerances and limits
/// @param progress  of closure, an estimate in per cent
/// @throws InvalidArgument for areas or settings that do not fit, and for all but `none` where far sources
/// are
///   in clusters; Cancelled, after which there are no rows
RepairReport repair(FormFactorMatrix& factors, std::span<const double> areas, Repair repair,
                    const RepairSettings& settings = {}, const Progress& progress = {});

} // namespace hemi
