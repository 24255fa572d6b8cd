#pragma once

#include "core/parallel_for.hpp"
#include "hemi/core/ranks.hpp"
#include "matrix/pairs.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

/// Entries that a row adds to a symmetric matrix.
enum class PairEntries {
    right_of_diagonal, ///< each stands for a pair: w_ij = w_ji exactly
    all                ///< each adds to w_ij and w_ji, whether or not there is one at (j, i)
};

/// Rows that lie in blocks, as PairProduct takes them.
class RowsOfBlocks {
public:
    /// @param blocks  must outlive this
    explicit RowsOfBlocks(std::span<const RowBlock> blocks) : blocks_(blocks) {}

    [[nodiscard]] RowView row(std::uint32_t i) const {
        return block_of(blocks_, i).row(i % FormFactorMatrix::block_rows);
    }

private:
    std::span<const RowBlock> blocks_;
};

/// Products of a symmetric matrix over pairs of patches with a field: y_i = sum_j w_ij z_j. Rows are summed
/// by slice and then in the order of slices: the same bits on any number of threads, and on any number of
/// ranks, which share the slices. Memory: up to 16 fields.
/// @tparam Rows  RowsOfBlocks or a FormFactorMatrix: row(i) is a RowView
template <class Rows>
class PairProduct {
public:
    /// @param rows     must outlive this
    /// @param cuts     slices of the rows, see slice_rows()
    /// @param columns  of the rows: as many as rows, or more, which then have no rows
    /// @param entries  that count
    /// @param stride   values a column, side by side: 1, 2 or a multiple of 4
    PairProduct(const Rows& rows, std::vector<std::uint32_t> cuts, std::uint32_t columns, PairEntries entries,
                std::size_t stride)
        : rows_(rows), columns_(columns), entries_(entries), stride_(stride), cuts_(std::move(cuts)) {
        for (std::size_t s = 0; s + 1 < cuts_.size(); ++s) {
            partial_.emplace_back((columns_ - first_column(s)) * stride_);
        }
    }

    /// @param weight_of  weight_of(view, row): a function of an entry's position in the row, the weight of
    ///   its pair over `scale(row)`
    /// @param z,y  columns·stride values
    template <class Scale, class WeightOf>
    void apply(const Scale& scale, const WeightOf& weight_of, const double* z, double* y) {
        const std::size_t first_slice = begin_of_rank(ranks().rank());
        const std::size_t own_slices = begin_of_rank(ranks().rank() + 1) - first_slice;
        parallel_for(own_slices, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t s = first_slice + begin; s < first_slice + end; ++s) {
                std::fill(partial_[s].begin(), partial_[s].end(), 0.0);
                for (std::uint32_t i = cuts_[s]; i < cuts_[s + 1]; ++i) {
                    const RowView row = rows_.row(i);
                    add_row(s, row, i, scale(i), weight_of(row, i), z);
                }
            }
        });
        exchange_slices();
        constexpr std::size_t grain = 8192;
        parallel_for(columns_ * stride_, grain, [&](std::size_t begin, std::size_t end) {
            std::fill(y + begin, y + end, 0.0);
            for (std::size_t s = 0; s < partial_.size(); ++s) {
                const std::size_t offset = first_column(s) * stride_;
                for (std::size_t k = std::max(begin, offset); k < end; ++k) {
                    y[k] += partial_[s][k - offset];
                }
            }
        });
    }

private:
    /// The first column that the rows of a slice add to.
    [[nodiscard]] std::size_t first_column(std::size_t slice) const {
        return entries_ == PairEntries::all ? 0 : cuts_[slice];
    }

    /// The first slice of a rank's share.
    [[nodiscard]] std::size_t begin_of_rank(std::uint32_t rank) const {
        return begin_of_share(ranks(), rank, partial_.size());
    }

    /// Gives all ranks the sums of all slices.
    void exchange_slices() {
        if (ranks().size() == 1) {
            return;
        }
        std::vector<double> own;
        for (std::size_t s = begin_of_rank(ranks().rank()); s < begin_of_rank(ranks().rank() + 1); ++s) {
            own.insert(own.end(), partial_[s].begin(), partial_[s].end());
        }
        const std::vector<double> all = gather_values(ranks(), std::span<const double>(own));
        auto next = all.begin();
        for (std::vector<double>& of_slice : partial_) {
            const auto end = next + static_cast<std::ptrdiff_t>(of_slice.size());
            std::copy(next, end, of_slice.begin());
            next = end;
        }
    }

    template <class Weight>
    void add_row(std::size_t slice, const RowView& row, std::uint32_t i, double scale, const Weight& weight,
                 const double* z) {
        const std::span<const std::uint32_t> columns = row.columns;
        const std::size_t begin =
            entries_ == PairEntries::all
                ? 0
                : static_cast<std::size_t>(std::upper_bound(columns.begin(), columns.end(), i) -
                                           columns.begin());
        double* const y = partial_[slice].data();
        const std::size_t first = first_column(slice);
        if (stride_ == 1) {
            add_entries<1>(columns, begin, i, scale, weight, z, y, first);
        } else if (stride_ == 2) {
            add_entries<2>(columns, begin, i, scale, weight, z, y, first);
        } else {
            for (std::size_t c = 0; c < stride_; c += 4) {
                add_entries<4>(columns, begin, i, scale, weight, z + c, y + c, first);
            }
        }
    }

    /// Both directions of the pairs of one row, for `width` neighbouring channels.
    template <std::size_t width, class Weight>
    void add_entries(std::span<const std::uint32_t> all_columns, std::size_t begin, std::uint32_t i,
                     double scale, const Weight& weight, const double* z, double* y,
                     std::size_t first) const {
        // Independent partial sums hide the latency of the additions; as many for every width, so that all
        // channels are summed alike.
        constexpr std::size_t lanes = 4;
        const std::uint32_t* const columns = all_columns.data();
        const std::size_t end = all_columns.size();
        std::array<std::array<double, width>, lanes> sums{};
        std::array<double, width> from_i{};
        for (std::size_t c = 0; c < width; ++c) {
            from_i[c] = scale * z[i * stride_ + c];
        }
        const auto add = [&](std::size_t k, std::array<double, width>& sum) {
            const double w = weight(k);
            const std::size_t j = columns[k];
            const double* const z_j = z + j * stride_;
            double* const y_j = y + (j - first) * stride_;
            for (std::size_t c = 0; c < width; ++c) {
                sum[c] += w * z_j[c];
                y_j[c] += w * from_i[c];
            }
        };
        std::size_t k = begin;
        for (; k + lanes <= end; k += lanes) {
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                add(k + lane, sums[lane]);
            }
        }
        for (std::size_t lane = 0; k < end; ++k, ++lane) {
            add(k, sums[lane]);
        }
        for (std::size_t c = 0; c < width; ++c) {
            y[(i - first) * stride_ + c] += scale * ((sums[0][c] + sums[1][c]) + (sums[2][c] + sums[3][c]));
        }
    }

    const Rows& rows_;
    std::uint32_t columns_;
    PairEntries entries_;
    std::size_t stride_;
    std::vector<std::uint32_t> cuts_;
    std::vector<std::vector<double>> partial_; // per slice, columns from its first one on
};

} // namespace hemi
