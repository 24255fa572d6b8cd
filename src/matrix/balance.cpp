#include "hemi/matrix/balance.hpp"

#include "core/parallel_for.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/ranks.hpp"
#include "hemi/matrix/product.hpp"
#include "matrix/pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace hemi {

namespace {

constexpr double relevant_factor = 1e-4;

/// Gathers what differs between F(i, j) and F(j, i), pair by pair. Travels between ranks as it is.
class ReciprocityTally {
public:
    void add(std::span<const double> areas, std::uint32_t i, double f_ij, std::uint32_t j, double f_ji) {
        const double exchange_ij = areas[i] * f_ij;
        const double exchange_ji = areas[j] * f_ji;
        const double gap = std::abs(exchange_ij - exchange_ji);
        const double gap_i = gap / areas[i];
        const double gap_j = gap / areas[j];
        squares_ += 0.5 * (gap_i * gap_i + gap_j * gap_j);
        ++result_.pairs;
        if (std::max(gap_i, gap_j) > result_.max) {
            result_.max = std::max(gap_i, gap_j);
            result_.worst_i = gap_i >= gap_j ? i : j;
            result_.worst_j = gap_i >= gap_j ? j : i;
        }
        const double relative = gap > 0.0 ? gap / std::max(exchange_ij, exchange_ji) : 0.0;
        result_.relative_max = std::max(result_.relative_max, relative);
        if (std::max(f_ij, f_ji) > relevant_factor) {
            relative_squares_ += relative * relative;
            ++relevant_;
        }
    }

    void add(const ReciprocityTally& other) {
        squares_ += other.squares_;
        relative_squares_ += other.relative_squares_;
        relevant_ += other.relevant_;
        result_.pairs += other.result_.pairs;
        result_.relative_max = std::max(result_.relative_max, other.result_.relative_max);
        if (other.result_.max > result_.max) {
            result_.max = other.result_.max;
            result_.worst_i = other.result_.worst_i;
            result_.worst_j = other.result_.worst_j;
        }
    }

    [[nodiscard]] Reciprocity result() const {
        Reciprocity result = result_;
        if (result.pairs > 0) {
            result.rms = std::sqrt(squares_ / static_cast<double>(result.pairs));
        }
        if (relevant_ > 0) {
            result.relative_rms = std::sqrt(relative_squares_ / static_cast<double>(relevant_));
        }
        return result;
    }

private:
    Reciprocity result_;
    double squares_ = 0.0;
    double relative_squares_ = 0.0;
    std::uint64_t relevant_ = 0;
};

} // namespace

RowSums row_sums(const FormFactorMatrix& factors) {
    RowSums sums;
    sums.min = std::numeric_limits<double>::infinity();
    sums.max = -std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        if (!factors.known(i)) {
            continue;
        }
        const RowView row = factors.row(i);
        const double sum = row.sum();
        sums.min = std::min(sums.min, sum);
        sums.max = std::max(sums.max, sum);
        sums.mean += sum;
        sums.environment_max = std::max(sums.environment_max, row.environment);
        sums.blocked_max = std::max(sums.blocked_max, row.blocked);
        if (row.blocked <= buried_above) {
            sums.balance_error_max =
                std::max(sums.balance_error_max, std::abs(sum + row.environment + row.blocked - 1.0));
        }
        ++sums.known;
        sums.leaking += row.environment > 0.0 ? 1 : 0;
        sums.covered += row.blocked > buried_above ? 1 : 0;
        sums.partly_blocked += row.blocked > 0.0 && row.blocked <= buried_above ? 1 : 0;
    }
    if (sums.known == 0) {
        return {};
    }
    sums.mean /= sums.known;
    return sums;
}

Reciprocity reciprocity(const FormFactorMatrix& factors, std::span<const double> areas) {
    check_areas(factors, areas);
    if (factors.clusters() != nullptr) {
        throw InvalidArgument("rows of clusters of sources are one-way: they have no pairs to compare");
    }
    const std::span<const RowBlock> blocks = factors.blocks();
    const std::vector<std::uint32_t> cuts = slice_rows(blocks);
    const std::size_t first = begin_of_share(ranks(), ranks().rank(), cuts.size() - 1);
    std::vector<ReciprocityTally> tallies(begin_of_share(ranks(), ranks().rank() + 1, cuts.size() - 1) -
                                          first);
    const auto value = [&](std::uint32_t i, std::uint64_t k) {
        return k == not_stored ? 0.0 : static_cast<double>(block_of(blocks, i).values[k]);
    };
    parallel_for(tallies.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
            ReciprocityTally tally;
            visit_pairs(blocks, cuts[first + s], cuts[first + s + 1],
                        [&](std::uint32_t i, std::uint64_t k_ij, std::uint32_t j, std::uint64_t k_ji) {
                            tally.add(areas, i, value(i, k_ij), j, value(j, k_ji));
                        });
            tallies[s] = tally;
        }
    });
    if (ranks().size() > 1) {
        tallies = gather_values(ranks(), std::span<const ReciprocityTally>(tallies));
    }
    ReciprocityTally all;
    for (const ReciprocityTally& tally : tallies) {
        all.add(tally);
    }
    return all.result();
}

bool is_reciprocal(const Reciprocity& reciprocity) {
    // Half a unit in the last place either way.
    return reciprocity.relative_max <= 1.01 * static_cast<double>(std::numeric_limits<float>::epsilon());
}

GroupFactors group_factors(const FormFactorMatrix& factors, std::span<const double> areas,
                           std::span<const std::uint32_t> group_of, std::uint32_t groups) {
    constexpr std::uint32_t max_groups = 16384;
    if (groups > max_groups) {
        throw InvalidArgument(fmt::format("a table of {} groups; at most {}, which is {} factors", groups,
                                          max_groups, std::uint64_t{max_groups} * max_groups));
    }
    check_areas(factors, areas);
    if (group_of.size() != factors.size()) {
        throw InvalidArgument(fmt::format("{} patches with a group for {} rows of form factors",
                                          group_of.size(), factors.size()));
    }
    for (std::size_t i = 0; i < group_of.size(); ++i) {
        if (group_of[i] >= groups) {
            throw InvalidArgument(fmt::format("patch {}: group {} of {}", i, group_of[i], groups));
        }
    }

    GroupFactors result;
    result.groups = groups;
    result.areas.assign(groups, 0.0);
    result.factors.assign(std::size_t{groups} * groups, 0.0);
    result.environment.assign(groups, 0.0);
    result.blocked.assign(groups, 0.0);
    std::vector<double> row_of_groups(groups);
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        if (!factors.known(i)) {
            throw InvalidArgument(fmt::format("row {} of the form factors is unknown; sums over groups need "
                                              "all rows",
                                              i));
        }
        const RowView row = factors.row(i);
        std::fill(row_of_groups.begin(), row_of_groups.end(), 0.0);
        visit_sources(factors, row,
                      [&](std::uint32_t j, double factor) { row_of_groups[group_of[j]] += factor; });
        const std::uint32_t g = group_of[i];
        double* const factors_of_group = result.factors.data() + std::size_t{g} * groups;
        for (std::uint32_t h = 0; h < groups; ++h) {
            factors_of_group[h] += areas[i] * row_of_groups[h];
        }
        result.areas[g] += areas[i];
        result.environment[g] += areas[i] * row.environment;
        result.blocked[g] += areas[i] * row.blocked;
    }
    for (std::uint32_t g = 0; g < groups; ++g) {
        if (result.areas[g] == 0.0) {
            result.blocked[g] = 1.0; // as the row of a covered patch
            continue;
        }
        for (std::uint32_t h = 0; h < groups; ++h) {
            result.factors[std::size_t{g} * groups + h] /= result.areas[g];
        }
        result.environment[g] /= result.areas[g];
        result.blocked[g] /= result.areas[g];
    }
    return result;
}

} // namespace hemi
