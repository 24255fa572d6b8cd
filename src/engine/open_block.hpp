#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace hemi {

/// A block of a matrix of which some rows have come.
class OpenBlock {
public:
    /// @param wanted  rows of this block that will come, ascending; must outlive this
    /// @param expected_entries  room to begin with: growing step by step would touch fresh memory again and
    /// again
    OpenBlock(std::uint32_t first_row, std::uint32_t rows, std::span<const std::uint32_t> wanted,
              std::size_t expected_entries);

    /// @throws Error if another row is due.
    void add(std::uint32_t patch, const RowView& row);
    [[nodiscard]] bool complete() const { return received_ == wanted_.size(); }
    [[nodiscard]] RowBlock finish();

private:
    void fill_offsets(std::size_t end);

    RowBlock block_;
    std::span<const std::uint32_t> wanted_;
    std::size_t filled_ = 1; // offsets that are final
    std::size_t received_ = 0;
};

/// The rows of `patches`, ascending, that lie in the block starting at `first_row`.
[[nodiscard]] std::span<const std::uint32_t> rows_of_block(std::span<const std::uint32_t> patches,
                                                           std::uint32_t first_row);

} // namespace hemi
