#pragma once

#include "hemi/matrix/repair.hpp"
#include "matrix/pair_product.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// The least-squares closure of reciprocal rows, in place. @see repair
class Closure {
public:
    /// @param blocks  all rows, every pair of known rows stored both ways
    Closure(std::vector<RowBlock>& blocks, std::span<const double> areas, bool with_visibility,
            const RepairSettings& settings, const Progress& progress);

    /// Adds what was done to the report. @throws Cancelled
    void run(RepairReport& report);

private:
    /// An entry on the diagonal: what a patch exchanges with its own images.
    struct Own {
        std::uint32_t row;
        std::uint64_t entry; ///< in its block
    };
    /// What one thread did.
    struct Tally {
        std::uint64_t at_zero = 0;
        std::uint64_t at_unoccluded = 0;
        double largest_change = 0.0;
    };

    void find_gaps();
    void find_diagonal();
    std::uint32_t find_multipliers(double tolerance);
    /// Says how far the whole is when no row misses its target by more than `gap`. @throws Cancelled
    void tell(double gap);
    /// Puts pairs that the multipliers drive out of their bounds there. @return what was held
    Tally hold_at_bounds();
    Tally write();

    void multiply(const std::vector<double>& z, std::vector<double>& y);
    [[nodiscard]] double relative_gap(const std::vector<double>& gap) const;
    [[nodiscard]] double exchange(std::uint32_t i, const RowBlock& block, std::uint64_t k,
                                  double multipliers) const;
    [[nodiscard]] double limit(std::uint32_t i, const RowBlock& block, std::uint64_t k) const;
    template <class Visit>
    void for_slices(const Visit& visit);

    std::vector<RowBlock>& blocks_;
    std::span<const double> areas_;
    bool with_visibility_;
    const RepairSettings& settings_;
    const Progress& progress_;
    double first_gap_ = 0.0; // that there was before anything was done
    std::size_t told_ = 0;   // per cent
    bool all_known_ = true;
    std::vector<std::uint32_t> cuts_;
    RowsOfBlocks rows_;
    PairProduct<RowsOfBlocks> pairs_;
    std::vector<Own> own_;               // ascending
    std::array<double, 256> variance_{}; // of a pair over its x², by the code of its visibility
    std::vector<double> gap_;            // target less sum of x, per row
    std::vector<double> diagonal_;       // sum of w; 0 where a row sets no target
    std::vector<double> multiplier_;     // l
};

} // namespace hemi
