#pragma once

#include "hemi/core/row_memory.hpp"
#include "hemi/matrix/packed_entries.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

class SourceClusters;

/// Visibility of a pair of patches as it is stored beside its factor: V = code / visibility_clear.
/// Only pairs of which no sample was hidden are clear; all others are kept below.
inline constexpr std::uint8_t visibility_clear = 255;

/// One row of F, seen but not owned. `columns` ascend; `values[k]` is F(i, columns[k]), the share of what
/// leaves patch i that arrives at patch columns[k]. Balance: sum of values + environment + blocked = 1.
struct RowView {
    std::span<const std::uint32_t> columns; ///< patches j, ascending
    std::span<const float> values;          ///< F(i, j)
    /// Where factors are F0·V, F0(i, j) the unoccluded factor: the code of V of every entry, else empty.
    std::span<const std::uint8_t> visibility = {};
    double environment = 0.0; ///< e_i, share that meets nothing
    double blocked = 0.0;     ///< b_i, share that meets back faces
    /// Keeps alive what was unpacked for this view, and its copies; null where the spans lie in the matrix.
    std::shared_ptr<const std::byte[]> unpacked = {};

    /// Sum of the values, in double, in column order.
    [[nodiscard]] double sum() const;
};

/// Consecutive rows of a sparse matrix that are stored, written and read together.
struct RowBlock {
    std::uint32_t first_row = 0;       ///< a multiple of FormFactorMatrix::block_rows
    std::vector<std::uint64_t> begin;  ///< rows + 1 offsets into columns and values, begin[0] = 0
    RowArray<std::uint32_t> columns;   ///< patch j per entry, ascending in a row
    RowArray<float> values;            ///< F(i, j) per entry
    RowArray<std::uint8_t> visibility; ///< code of V per entry; empty where V is not known
    std::vector<double> environment;   ///< e per row
    std::vector<double> blocked;       ///< b per row
    std::vector<std::uint8_t> known;   ///< per row: 0 where the row was not computed (it is then empty)

    /// Number of rows, known or not.
    [[nodiscard]] std::uint32_t rows() const noexcept { return static_cast<std::uint32_t>(known.size()); }
    /// Row first_row + local, valid while the block is.
    [[nodiscard]] RowView row(std::uint32_t local) const;
};

/// Form factors F(i, j) of N patches: compressed sparse rows (float32 values, 32-bit columns) in independent
/// blocks of `block_rows` rows, with the balance of every row in double.
///
/// In scenes of very many patches, far sources may stand together in clusters: columns from N on are the
/// nodes of SourceClusters. Such factors are neither square nor reciprocal, but the rows balance as others
/// do; what comes from clusters is PackedEntries. Memory: 8 bytes an entry (9 with visibility), 4 or 5 of a
/// cluster, or none where keep_rows_in() has a file for them, plus about 25 bytes a row, 65 with clusters.
class FormFactorMatrix {
public:
    /// Rows in every block but the last.
    static constexpr std::uint32_t block_rows = 64;

    /// A matrix whose rows are all unknown.
    /// @param size      N
    /// @param clusters  of its N patches that columns may be; null: columns are patches
    explicit FormFactorMatrix(std::uint32_t size, std::shared_ptr<const SourceClusters> clusters = nullptr);

    /// N, the number of patches.
    [[nodiscard]] std::uint32_t size() const noexcept { return size_; }
    /// Clusters that columns from N on stand for, or null.
    [[nodiscard]] const std::shared_ptr<const SourceClusters>& clusters() const noexcept { return clusters_; }
    /// Number of columns: N, and one for every cluster.
    [[nodiscard]] std::uint32_t columns() const noexcept { return columns_; }
    /// Row i, valid until its block is replaced; empty if it is not known. Where there are clusters it is
    /// unpacked: hold the view rather than ask again, and no span of it without it.
    [[nodiscard]] RowView row(std::uint32_t i) const;
    /// e_i of row i, for which nothing is unpacked; 0 if it is not known.
    [[nodiscard]] double environment(std::uint32_t i) const;
    /// b_i of row i, likewise.
    [[nodiscard]] double blocked(std::uint32_t i) const;
    /// Whether row i was computed; `solve` leaves out rows that the scene does not require.
    [[nodiscard]] bool known(std::uint32_t i) const;
    /// Whether every row was computed.
    [[nodiscard]] bool all_known() const;
    /// Whether there are entries, and a visibility for each of them.
    [[nodiscard]] bool has_visibility() const noexcept;
    /// Stored entries, all rows.
    [[nodiscard]] std::uint64_t entries() const noexcept;
    /// Bytes that the rows take, in memory or in a file.
    [[nodiscard]] std::uint64_t memory_bytes() const noexcept;

    /// All blocks, in the order of their rows. Where there are clusters, their entries are not in them.
    [[nodiscard]] std::span<const RowBlock> blocks() const noexcept { return blocks_; }
    /// A copy of block b, with the entries of clusters.
    [[nodiscard]] RowBlock block(std::size_t b) const;
    /// Replaces the block that starts at `block.first_row`.
    /// @throws InvalidArgument if it does not fit the matrix: wrong first row or row count, offsets that do
    ///   not ascend, columns out of range or not ascending, values that are not finite or negative, 2 or more
    ///   for a cluster, a visibility of another length than the values.
    void set_block(RowBlock block);
    /// The same, of a matrix with clusters, of which the entries are packed.
    /// @param block     without these entries
    /// @param clusters  theirs, one for each row
    /// @throws InvalidArgument as above, and if there are not as many as rows
    void set_block(RowBlock block, std::vector<PackedEntries> clusters);
    /// All blocks, with the entries of clusters, to be changed and set again; until then every row is
    /// unknown.
    [[nodiscard]] std::vector<RowBlock> take_blocks();
    /// Stored entries of block b.
    [[nodiscard]] std::uint64_t entries(std::size_t b) const noexcept;

private:
    void put(std::vector<PackedEntries> clusters, std::uint32_t first_row);

    std::uint32_t size_;
    std::uint32_t columns_;
    std::shared_ptr<const SourceClusters> clusters_;
    std::vector<RowBlock> blocks_;      ///< without entries of clusters
    std::vector<PackedEntries> packed_; ///< entries of clusters of every row, if there are clusters
};

} // namespace hemi
