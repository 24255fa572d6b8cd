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

} // namespace hemi
