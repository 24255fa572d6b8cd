#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// Rows of F as unordered pairs of patches: x_ij = A_i F(i, j) = A_j F(j, i) is one number.
namespace hemi {

/// @throws InvalidArgument unless there is one area for every row, above 0, or 0 of an empty one.
void check_areas(const FormFactorMatrix& factors, std::span<const double> areas);

[[nodiscard]] inline const RowBlock& block_of(std::span<const RowBlock> blocks, std::uint32_t i) {
    return blocks[i / FormFactorMatrix::block_rows];
}
[[nodiscard]] inline bool is_known(std::span<const RowBlock> blocks, std::uint32_t i) {
    return block_of(blocks, i).known[i % FormFactorMatrix::block_rows] != 0;
}

/// Position in its block of the first entry of row `local` whose column is not below `column`.
[[nodiscard]] inline std::uint64_t first_from(const RowBlock& block, std::uint32_t local,
                                              std::uint32_t column) {
    const std::uint32_t* const columns = block.columns.data();
    return static_cast<std::uint64_t>(
        std::lower_bound(columns + block.begin[local], columns + block.begin[local + 1], column) - columns);
}

/// Calls `visit(k)` for entries of row i left of the diagonal that lead to unknown rows: their pairs are
/// stored nowhere else.
template <class Visit>
void visit_unknown_left(std::span<const RowBlock> blocks, std::uint32_t i, const Visit& visit) {
    const RowBlock& block = block_of(blocks, i);
    const std::uint64_t end = first_from(block, i % FormFactorMatrix::block_rows, i);
    for (std::uint64_t k = block.begin[i % FormFactorMatrix::block_rows]; k < end; ++k) {
        if (!is_known(blocks, block.columns[k])) {
            visit(k);
        }
    }
}

/// Where rows are cut for threads: slice s is rows [cuts[s], cuts[s + 1]), whole blocks with about equal
/// numbers of entries. Depends on the matrix alone, so that sums over slices do not depend on the machine.
[[nodiscard]] std::vector<std::uint32_t> slice_rows(std::span<const RowBlock> blocks);
/// The same, of all entries, those of clusters too.
[[nodiscard]] std::vector<std::uint32_t> slice_rows(const FormFactorMatrix& factors);

/// Stands for an entry that is not stored.
inline constexpr std::uint64_t not_stored = ~std::uint64_t{0};

/// Calls `visit(i, k_ij, j, k_ji)` once for every pair i < j of known rows with first <= i < last of which at
/// least one direction is stored; k are positions in the columns of the row's block, or not_stored.
/// The diagonal and entries that lead to unknown rows are left out.
template <class Visit>
void visit_pairs(std::span<const RowBlock> blocks, std::uint32_t first, std::uint32_t last,
                 const Visit& visit) {
    constexpr std::uint32_t block_rows = FormFactorMatrix::block_rows;
    // Rows i are taken by the tile, few enough for the caches. Row j's entries in the columns of a tile lie
    // side by side; each of them moves the cursor of its row i on to column j.
    constexpr std::uint32_t tile_rows = 256;
    if (first >= last) {
        return;
    }
    const std::uint32_t size = blocks.back().first_row + blocks.back().rows();
    std::vector<std::uint64_t> left(size - first); // next entry of row j left of its diagonal
    for (std::uint32_t j = first; j < size; ++j) {
        left[j - first] = first_from(block_of(blocks, j), j % block_rows, first);
    }
    // Least column of these entries in each block: tiles pass over blocks that have none of theirs, so that
    // sparse matrices of many rows take no longer than their entries. At first every block is looked at.
    constexpr std::uint32_t none = ~std::uint32_t{0};
    std::vector<std::uint32_t> next_column(blocks.size(), 0);
    std::array<std::uint64_t, tile_rows> right{}; // next entry of row i right of its diagonal
    for (std::uint32_t tile = first; tile < last; tile += std::min(tile_rows, last - tile)) {
        const std::uint32_t tile_end = tile + std::min(tile_rows, last - tile);
        for (std::uint32_t i = tile; i < tile_end; ++i) {
            right[i - tile] = first_from(block_of(blocks, i), i % block_rows, i + 1);
        }
        // What the cursor passes has no partner. @return whether it stands at column j then
        const auto pass_until = [&](std::uint32_t i, std::uint32_t j) {
            const RowBlock& block = block_of(blocks, i);
            const std::uint64_t end = block.begin[i % block_rows + 1];
            std::uint64_t& k = right[i - tile];
            for (; k < end && block.columns[k] < j; ++k) {
                if (is_known(blocks, block.columns[k])) {
                    visit(i, k, block.columns[k], not_stored);
                }
            }
            return k < end && block.columns[k] == j;
        };
        for (std::size_t b = (tile + 1) / block_rows; b < blocks.size(); ++b) {
            if (next_column[b] >= tile_end) {
                continue;
            }
            const RowBlock& block = blocks[b];
            std::uint32_t least = none;
            for (std::uint32_t j = std::max(tile + 1, block.first_row); j < block.first_row + block.rows();
                 ++j) {
                const std::uint64_t end = block.begin[j % block_rows + 1];
                const std::uint32_t column_end = std::min(tile_end, j);
                std::uint64_t& k = left[j - first];
                for (; k < end && block.columns[k] < column_end; ++k) {
                    const std::uint32_t i = block.columns[k];
                    if (is_known(blocks, i)) {
                        const bool partner = pass_until(i, j);
                        visit(i, partner ? right[i - tile]++ : not_stored, j, k);
                    }
                }
                if (k < end && block.columns[k] < j) {
                    least = std::min(least, block.columns[k]);
                }
            }
            next_column[b] = least;
        }
        for (std::uint32_t i = tile; i < tile_end; ++i) {
            (void)pass_until(i, size);
        }
    }
}

} // namespace hemi
