#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace hemi {

/// Which of N patches have a row, and where: rows are numbered 0, 1 … in the order of their patches.
class RowIndex {
public:
    static constexpr std::uint32_t no_row = std::numeric_limits<std::uint32_t>::max();

    /// @param patches  that have a row, ascending; must outlive this
    /// @param size     N
    RowIndex(std::span<const std::uint32_t> patches, std::uint32_t size)
        : patches_(patches), row_of_(size, no_row) {
        for (std::uint32_t row = 0; row < patches.size(); ++row) {
            row_of_[patches[row]] = row;
        }
    }

    /// N, the number of patches.
    [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(row_of_.size()); }
    /// The patches that have a row, ascending.
    [[nodiscard]] std::span<const std::uint32_t> patches() const noexcept { return patches_; }
    /// How many these are.
    [[nodiscard]] std::size_t rows() const noexcept { return patches_.size(); }
    /// Row of a patch, or no_row.
    [[nodiscard]] std::uint32_t row_of(std::uint32_t patch) const { return row_of_[patch]; }

private:
    std::span<const std::uint32_t> patches_;
    std::vector<std::uint32_t> row_of_;
};

/// Rows, numbered as by RowIndex, whose pairs with the patches behind them this rank combines. Where ranks
/// share the rows, each has one part before the middle and one as far behind it, so that all have as many
/// rows, and as many pairs.
class OwnRows {
public:
    /// Rows that follow each other.
    struct Part {
        std::uint32_t first = 0;
        std::uint32_t end = 0; ///< one past the last
    };

    /// All rows.
    explicit OwnRows(std::uint32_t rows) : first_{0, rows} {}
    /// Those of rank `rank` of `ranks`.
    OwnRows(std::uint32_t rows, std::uint32_t rank, std::uint32_t ranks)
        : first_(part(rows, rank, ranks)), second_(part(rows, 2 * ranks - 1 - rank, ranks)), divided_(true) {}

    /// Part `k` of twice as many as there are ranks; rank r has the parts r and 2·ranks - 1 - r.
    [[nodiscard]] static Part part(std::uint32_t rows, std::uint32_t k, std::uint32_t ranks) {
        const auto begin = [&](std::uint32_t of) {
            return static_cast<std::uint32_t>(std::uint64_t{rows} * of / (2 * std::uint64_t{ranks}));
        };
        return {begin(k), begin(k + 1)};
    }

    [[nodiscard]] const Part& first() const noexcept { return first_; }
    [[nodiscard]] const Part& second() const noexcept { return second_; }
    /// Whether there are ranks that share all rows.
    [[nodiscard]] bool divided() const noexcept { return divided_; }
    [[nodiscard]] std::size_t count() const noexcept {
        return std::size_t{first_.end} - first_.first + second_.end - second_.first;
    }
    [[nodiscard]] bool contains(std::size_t row) const noexcept {
        return (row >= first_.first && row < first_.end) || (row >= second_.first && row < second_.end);
    }
    /// The k-th of them.
    [[nodiscard]] std::uint32_t operator[](std::size_t k) const noexcept {
        const std::uint32_t before = first_.end - first_.first;
        const auto at = static_cast<std::uint32_t>(k);
        return at < before ? first_.first + at : second_.first + (at - before);
    }

private:
    Part first_;
    Part second_;
    bool divided_ = false;
};

} // namespace hemi
