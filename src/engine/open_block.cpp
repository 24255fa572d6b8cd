#include "engine/open_block.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hemi {

OpenBlock::OpenBlock(std::uint32_t first_row, std::uint32_t rows, std::span<const std::uint32_t> wanted,
                     std::size_t expected_entries)
    : wanted_(wanted) {
    block_.columns.reserve(expected_entries);
    block_.values.reserve(expected_entries);
    block_.first_row = first_row;
    block_.begin.assign(std::size_t{rows} + 1, 0);
    block_.environment.assign(rows, 0.0);
    block_.blocked.assign(rows, 0.0);
    block_.known.assign(rows, 0);
}

void OpenBlock::add(std::uint32_t patch, const RowView& row) {
    if (complete() || wanted_[received_] != patch) {
        throw Error(fmt::format("row {} of the form factors came twice, out of order or unasked", patch));
    }
    const std::uint32_t local = patch - block_.first_row;
    fill_offsets(local + 1);
    block_.columns.insert(block_.columns.end(), row.columns.begin(), row.columns.end());
    block_.values.insert(block_.values.end(), row.values.begin(), row.values.end());
    block_.visibility.insert(block_.visibility.end(), row.visibility.begin(), row.visibility.end());
    block_.begin[local + 1] = block_.columns.size();
    block_.environment[local] = row.environment;
    block_.blocked[local] = row.blocked;
    block_.known[local] = 1;
    filled_ = local + 2;
    ++received_;
}

RowBlock OpenBlock::finish() {
    fill_offsets(block_.begin.size());
    // A little room at the end was never touched, and so takes no memory; much may have been.
    if (block_.columns.capacity() - block_.columns.size() > block_.columns.size() / 8) {
        block_.columns.shrink_to_fit();
        block_.values.shrink_to_fit();
    }
    return std::move(block_);
}

void OpenBlock::fill_offsets(std::size_t end) {
    for (; filled_ < end; ++filled_) {
        block_.begin[filled_] = block_.columns.size();
    }
}

std::span<const std::uint32_t> rows_of_block(std::span<const std::uint32_t> patches,
                                             std::uint32_t first_row) {
    const auto begin = std::lower_bound(patches.begin(), patches.end(), first_row);
    const auto end = std::find_if(begin, patches.end(), [first_row](std::uint32_t patch) {
        return patch - first_row >= FormFactorMatrix::block_rows;
    });
    return {begin, end};
}

} // namespace hemi
