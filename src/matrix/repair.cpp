#include "hemi/matrix/repair.hpp"

#include "core/parallel_for.hpp"
#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "matrix/closure.hpp"
#include "matrix/pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace hemi {

namespace {

constexpr std::uint32_t block_rows = FormFactorMatrix::block_rows;

void check_settings(const RepairSettings& settings) {
    const auto check = [](const char* name, double value) {
        if (!(value > 0.0 && value < 1.0)) {
            throw InvalidArgument(fmt::format("{} {}; it must be above 0 and below 1", name, value));
        }
    };
    check("error of unoccluded factors", settings.unoccluded_error);
    check("tolerance of row sums", settings.tolerance);
}

RowImbalance row_error(const FormFactorMatrix& factors) {
    const std::span<const RowBlock> blocks = factors.blocks();
    std::vector<double> largest(blocks.size(), 0.0);
    std::vector<double> squares(blocks.size(), 0.0);
    std::vector<std::uint32_t> rows(blocks.size(), 0);
    constexpr std::size_t grain = 16;
    parallel_for(blocks.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            for (std::uint32_t local = 0; local < blocks[b].rows(); ++local) {
                const RowView row = factors.row(blocks[b].first_row + local);
                if (blocks[b].known[local] == 0 || row.blocked > buried_above) {
                    continue;
                }
                const double error = std::abs(row.sum() + row.environment + row.blocked - 1.0);
                largest[b] = std::max(largest[b], error);
                squares[b] += error * error;
                ++rows[b];
            }
        }
    });
    RowImbalance result;
    const std::uint32_t all_rows = std::accumulate(rows.begin(), rows.end(), 0u);
    if (all_rows > 0) {
        result.max = *std::max_element(largest.begin(), largest.end());
        result.rms = std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) / all_rows);
    }
    return result;
}

/// An entry that is not stored though its partner is.
struct Missing {
    std::uint32_t column = 0;
    std::uint8_t visibility = 0; ///< its partner's
};

/// All of them, by row.
class MissingEntries {
public:
    explicit MissingEntries(std::span<const RowBlock> blocks)
        : begin_(blocks.empty() ? 1 : blocks.back().first_row + blocks.back().rows() + 1, 0) {
        const std::vector<std::uint32_t> cuts = slice_rows(blocks);
        std::vector<std::vector<Found>> found(cuts.size() - 1);
        const auto code = [&](std::uint32_t i, std::uint64_t k) {
            const RowBlock& block = block_of(blocks, i);
            return block.visibility.empty() ? std::uint8_t{0} : block.visibility[k];
        };
        parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t s = begin; s < end; ++s) {
                visit_pairs(blocks, cuts[s], cuts[s + 1],
                            [&](std::uint32_t i, std::uint64_t k_ij, std::uint32_t j, std::uint64_t k_ji) {
                                if (k_ij == not_stored) {
                                    found[s].push_back({i, {j, code(j, k_ji)}});
                                } else if (k_ji == not_stored) {
                                    found[s].push_back({j, {i, code(i, k_ij)}});
                                }
                            });
            }
        });
        for (const auto& of_slice : found) {
            for (const Found& one : of_slice) {
                ++begin_[one.row + 1];
            }
        }
        std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
        entries_.resize(begin_.back());
        std::vector<std::uint64_t> next(begin_.begin(), begin_.end() - 1);
        for (const auto& of_slice : found) {
            for (const Found& one : of_slice) {
                entries_[next[one.row]++] = one.entry;
            }
        }
        for (std::size_t i = 0; i + 1 < begin_.size(); ++i) {
            std::sort(entries_.begin() + static_cast<std::ptrdiff_t>(begin_[i]),
                      entries_.begin() + static_cast<std::ptrdiff_t>(begin_[i + 1]),
                      [](const Missing& a, const Missing& b) { return a.column < b.column; });
        }
    }

    [[nodiscard]] std::uint64_t count() const { return entries_.size(); }
    [[nodiscard]] std::span<const Missing> row(std::uint32_t i) const {
        return std::span(entries_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
    }

private:
    struct Found {
        std::uint32_t row = 0;
        Missing entry;
    };
    std::vector<std::uint64_t> begin_;
    std::vector<Missing> entries_;
};

/// The block with the missing entries of its rows among the others, as zeros.
RowBlock completed(const RowBlock& block, const MissingEntries& missing) {
    RowBlock result;
    result.first_row = block.first_row;
    result.environment = block.environment;
    result.blocked = block.blocked;
    result.known = block.known;
    result.begin.push_back(0);
    const bool with_visibility = !block.visibility.empty();
    const auto add = [&](std::uint32_t column, float value, std::uint8_t visibility) {
        result.columns.push_back(column);
        result.values.push_back(value);
        if (with_visibility) {
            result.visibility.push_back(visibility);
        }
    };
    for (std::uint32_t local = 0; local < block.rows(); ++local) {
        std::uint64_t k = block.begin[local];
        const auto copy_until = [&](std::uint32_t column) {
            for (; k < block.begin[local + 1] && block.columns[k] < column; ++k) {
                add(block.columns[k], block.values[k], with_visibility ? block.visibility[k] : 0);
            }
        };
        for (const Missing& entry : missing.row(block.first_row + local)) {
            copy_until(entry.column);
            add(entry.column, 0.0F, entry.visibility);
        }
        copy_until(std::numeric_limits<std::uint32_t>::max());
        result.begin.push_back(result.columns.size());
    }
    return result;
}

/// Stores every pair of known rows both ways. @return entries added
std::uint64_t complete_pattern(std::vector<RowBlock>& blocks) {
    const MissingEntries missing(blocks);
    if (missing.count() > 0) {
        parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t b = begin; b < end; ++b) {
                blocks[b] = completed(blocks[b], missing);
            }
        });
    }
    return missing.count();
}

/// Makes both directions of every pair the same exchange area.
void average_pairs(std::vector<RowBlock>& blocks, std::span<const double> areas) {
    const std::vector<std::uint32_t> cuts = slice_rows(blocks);
    parallel_for(cuts.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
            visit_pairs(std::span<const RowBlock>(blocks), cuts[s], cuts[s + 1],
                        [&](std::uint32_t i, std::uint64_t k_ij, std::uint32_t j, std::uint64_t k_ji) {
                            float& f_ij = blocks[i / block_rows].values[k_ij];
                            float& f_ji = blocks[j / block_rows].values[k_ji];
                            const double exchange = (static_cast<double>(f_ij) + static_cast<double>(f_ji)) /
                                                    (1.0 / areas[i] + 1.0 / areas[j]);
                            f_ij = static_cast<float>(exchange / areas[i]);
                            f_ji = static_cast<float>(exchange / areas[j]);
                        });
        }
    });
}

} // namespace

RepairReport repair(FormFactorMatrix& factors, std::span<const double> areas, Repair repair,
                    const RepairSettings& settings, const Progress& progress) {
    check_areas(factors, areas);
    check_settings(settings);
    RepairReport report;
    report.repair = repair;
    report.row_error_before = report.row_error_after = row_error(factors);
    if (factors.clusters() != nullptr) {
        if (repair != Repair::none) {
            throw InvalidArgument(
                fmt::format("repair {}: rows of clusters of sources balance already, and are "
                            "reciprocal only near each other; leave it out",
                            to_word(repair)),
                {"repair", "clusters"});
        }
        return report;
    }
    report.reciprocity_before = report.reciprocity_after = reciprocity(factors, areas);
    if (repair == Repair::none) {
        return report;
    }
    const bool with_visibility = factors.has_visibility();
    std::vector<RowBlock> blocks = factors.take_blocks();
    if (!is_reciprocal(report.reciprocity_before)) {
        report.added = complete_pattern(blocks);
        average_pairs(blocks, areas);
    }
    if (repair == Repair::closure) {
        Closure(blocks, areas, with_visibility, settings, progress).run(report);
    }
    parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            factors.set_block(std::move(blocks[b]));
        }
    });
    report.row_error_after = row_error(factors);
    report.reciprocity_after = reciprocity(factors, areas);
    return report;
}

} // namespace hemi
