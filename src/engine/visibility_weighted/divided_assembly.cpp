#include "engine/visibility_weighted/divided_assembly.hpp"

#include "core/parallel_for.hpp"
#include "engine/visibility_weighted/factor_assembly.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/ranks.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

namespace {

/// A pair that a rank gives to the others, of a row that they know.
struct SharedPair {
    double exchange_area;
    std::uint32_t column;
    std::uint32_t visibility;
};

constexpr std::uint32_t block_rows = FormFactorMatrix::block_rows;

/// The pairs of a rank's own rows with the patches behind them, and with those before that have no row.
std::vector<std::vector<SharedPair>> own_pairs(const PairTable& table, const ExchangeAreas& exchange_areas) {
    std::vector<std::vector<SharedPair>> rows(table.own.count());
    parallel_for(rows.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t i = table.index.patches()[table.own[k]];
            const std::vector<PairVisibility>& visibility = table.visibility[table.own[k]];
            for (std::uint32_t j = 0; j < table.index.size(); ++j) {
                const bool of_other = j < i && table.index.row_of(j) != RowIndex::no_row;
                if (j == i || of_other || visibility[j].is_hidden()) {
                    continue;
                }
                rows[k].push_back({exchange_areas(std::min(i, j), std::max(i, j)) * visibility[j].value(), j,
                                   visibility[j].stored()});
            }
        }
    });
    return rows;
}

/// Puts the pairs of all ranks into both rows of each.
class SharedFiller {
public:
    /// All must outlive this.
    /// @param own  see own_pairs()
    SharedFiller(const PairTable& table, const PatchMesh& mesh,
                 const std::vector<std::vector<SharedPair>>& own)
        : table_(table), areas_(mesh.areas()), matrix_(mesh.size()), blocks_(matrix_.take_blocks()) {
        find_rows(own);
        make_room(own);
    }

    /// Takes the next pairs of all ranks: of the first rank's first row, and so on.
    void exchange(std::span<const SharedPair> own) {
        const std::vector<std::vector<std::byte>> all = ranks().gather(std::as_bytes(own));
        parallel_for(all.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t rank = begin; rank < end; ++rank) {
                take(rank, {reinterpret_cast<const SharedPair*>(all[rank].data()),
                            all[rank].size() / sizeof(SharedPair)});
            }
        });
    }

    /// Pairs of the rank that has most.
    [[nodiscard]] std::uint64_t most() const { return *std::max_element(pairs_.begin(), pairs_.end()); }

    [[nodiscard]] FormFactorMatrix finish() {
        parallel_for(blocks_.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t b = begin; b < end; ++b) {
                if (table_.index.rows() < table_.index.size()) {
                    sort_rows(blocks_[b]);
                }
                drop_zeros(blocks_[b]);
                matrix_.set_block(std::move(blocks_[b]));
            }
        });
        return std::move(matrix_);
    }

private:
    /// How many pairs every rank has, and which rows.
    void find_rows(const std::vector<std::vector<SharedPair>>& own) {
        const std::uint64_t count =
            std::accumulate(own.begin(), own.end(), std::uint64_t{0},
                            [](std::uint64_t sum, const auto& row) { return sum + row.size(); });
        pairs_ = gather_values(ranks(), std::span(&count, 1));
        const auto rows = static_cast<std::uint32_t>(table_.index.rows());
        for (std::uint32_t rank = 0; rank < ranks().size(); ++rank) {
            rows_.emplace_back(rows, rank, ranks().size());
        }
        next_row_.assign(rows_.size(), 0);
    }

    void make_room(const std::vector<std::vector<SharedPair>>& own) {
        const std::uint32_t size = table_.index.size();
        const std::uint32_t count = ranks().size();
        std::vector<std::uint32_t> counts(table_.index.rows(), 0); // of each own row
        // Of each part of the own rows and each patch: pairs that are entries of the patch's row, too.
        std::vector<std::uint32_t> behind(2 * std::size_t{size}, 0);
        for (std::size_t k = 0; k < own.size(); ++k) {
            const std::uint32_t row = table_.own[k];
            const std::uint32_t i = table_.index.patches()[row];
            const std::size_t part = row < table_.own.first().end ? 0 : 1;
            counts[row] = static_cast<std::uint32_t>(own[k].size());
            for (const SharedPair& pair : own[k]) {
                behind[part * size + pair.column] += is_twofold(i, pair.column) ? 1 : 0;
            }
        }
        const std::vector<std::uint32_t> all_counts =
            gather_values(ranks(), std::span<const std::uint32_t>(counts));
        left_.assign(table_.index.rows(), 0);
        for (std::size_t k = 0; k < all_counts.size(); ++k) {
            left_[k % left_.size()] += all_counts[k];
        }
        const std::vector<std::uint32_t> all_behind =
            gather_values(ranks(), std::span<const std::uint32_t>(behind));
        below_.assign(all_behind.size(), 0);
        next_.assign(table_.index.rows(), 0);
        for (RowBlock& block : blocks_) {
            for (std::uint32_t local = 0; local < block.rows(); ++local) {
                const std::uint32_t i = block.first_row + local;
                std::uint64_t at = block.begin[local];
                for (std::uint32_t part = 0; part < 2 * count; ++part) { // in the order of their rows
                    const std::size_t entry = part_of(std::min(part, 2 * count - 1 - part), part >= count, i);
                    below_[entry] = at;
                    at += all_behind[entry];
                }
                const std::uint32_t k = table_.index.row_of(i);
                if (k != RowIndex::no_row) {
                    next_[k] = at;
                    at += left_[k];
                    block.known[local] = 1;
                    block.environment[local] = table_.environment[k];
                    block.blocked[local] = table_.blocked[k];
                }
                block.begin[local + 1] = at;
            }
            block.columns.resize(block.begin.back());
            block.values.resize(block.begin.back());
            block.visibility.resize(block.begin.back());
        }
    }

    /// Where below_ has what a rank's first or second part of rows puts into the row of a patch.
    [[nodiscard]] std::size_t part_of(std::size_t rank, bool second, std::uint32_t patch) const {
        return (2 * rank + (second ? 1 : 0)) * table_.index.size() + patch;
    }

    /// Whether a pair that comes with row i is an entry of row j as well.
    [[nodiscard]] bool is_twofold(std::uint32_t i, std::uint32_t j) const {
        return j > i && table_.index.row_of(j) != RowIndex::no_row;
    }

    /// The next pairs of one rank. Ranks touch different entries.
    void take(std::size_t rank, std::span<const SharedPair> pairs) {
        const OwnRows& rows = rows_[rank];
        for (const SharedPair& pair : pairs) {
            while (left_[rows[next_row_[rank]]] == 0) {
                ++next_row_[rank];
            }
            const std::uint32_t k = rows[next_row_[rank]];
            --left_[k];
            const std::uint32_t i = table_.index.patches()[k];
            put(i, next_[k]++, pair.column, pair);
            if (is_twofold(i, pair.column)) {
                put(pair.column, below_[part_of(rank, k >= rows.first().end, pair.column)]++, i, pair);
            }
        }
    }

    void put(std::uint32_t row, std::uint64_t at, std::uint32_t column, const SharedPair& pair) {
        RowBlock& block = blocks_[row / block_rows];
        block.columns[at] = column;
        block.values[at] = static_cast<float>(pair.exchange_area / areas_[row]);
        block.visibility[at] = static_cast<std::uint8_t>(pair.visibility);
    }

    /// Patches without a row come with those behind them, and belong before.
    static void sort_rows(RowBlock& block) {
        std::vector<std::uint64_t> order;
        for (std::uint32_t local = 0; local < block.rows(); ++local) {
            const std::uint64_t begin = block.begin[local];
            order.resize(block.begin[local + 1] - begin);
            std::iota(order.begin(), order.end(), begin);
            std::sort(order.begin(), order.end(),
                      [&](std::uint64_t a, std::uint64_t b) { return block.columns[a] < block.columns[b]; });
            reorder(block.columns, order, begin);
            reorder(block.values, order, begin);
            reorder(block.visibility, order, begin);
        }
    }

    template <class T>
    static void reorder(RowArray<T>& values, const std::vector<std::uint64_t>& order, std::uint64_t begin) {
        std::vector<T> ordered;
        ordered.reserve(order.size());
        for (const std::uint64_t k : order) {
            ordered.push_back(values[k]);
        }
        std::copy(ordered.begin(), ordered.end(), values.begin() + static_cast<std::ptrdiff_t>(begin));
    }

    const PairTable& table_;
    std::span<const double> areas_;
    FormFactorMatrix matrix_;
    std::vector<RowBlock> blocks_;
    std::vector<std::uint64_t> pairs_;  ///< of each rank
    std::vector<OwnRows> rows_;         ///< of each rank
    std::vector<std::size_t> next_row_; ///< of each rank: of whose pairs some are still to come
    std::vector<std::uint32_t> left_;   ///< of each row: pairs that are still to come
    std::vector<std::uint64_t> next_;   ///< of each row: where the next of them goes, in its block
    std::vector<std::uint64_t> below_;  ///< where the next entry before the diagonal goes, see part_of()
};

} // namespace

FormFactorMatrix assemble_divided(const PairTable& table, const PatchMesh& mesh,
                                  const ExchangeAreas& exchange_areas, const Progress& progress) {
    constexpr std::size_t pairs_at_once = std::size_t{1} << 20;
    const std::vector<std::vector<SharedPair>> rows = own_pairs(table, exchange_areas);
    SharedFiller filler(table, mesh, rows);
    const std::uint64_t exchanges = (filler.most() + pairs_at_once - 1) / pairs_at_once;
    std::size_t row = 0;
    std::size_t pair = 0;
    std::vector<SharedPair> batch;
    for (std::uint64_t done = 0; done < exchanges; ++done) {
        batch.clear();
        while (batch.size() < pairs_at_once && row < rows.size()) {
            const std::size_t part = std::min(pairs_at_once - batch.size(), rows[row].size() - pair);
            const auto first = rows[row].begin() + static_cast<std::ptrdiff_t>(pair);
            batch.insert(batch.end(), first, first + static_cast<std::ptrdiff_t>(part));
            pair += part;
            if (pair == rows[row].size()) {
                ++row;
                pair = 0;
            }
        }
        filler.exchange(batch);
        if (progress && !progress(done + 1, exchanges)) {
            throw Cancelled();
        }
    }
    return filler.finish();
}

} // namespace hemi
