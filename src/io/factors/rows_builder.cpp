#include "io/factors/rows_builder.hpp"

#include <algorithm>

namespace hemi::io {

std::optional<std::uint32_t> RowsBuilder::end_row() {
    if (!std::is_sorted(entries_.begin(), entries_.end())) {
        std::sort(entries_.begin(), entries_.end());
    }
    const auto twice = std::adjacent_find(entries_.begin(), entries_.end(),
                                          [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twice != entries_.end()) {
        return twice->first;
    }
    for (const auto& [column, value] : entries_) {
        block_.columns.push_back(column);
        block_.values.push_back(value);
    }
    entries_.clear();
    block_.begin.push_back(block_.columns.size());
    block_.environment.push_back(0.0);
    block_.blocked.push_back(0.0);
    block_.known.push_back(1);
    ++row_;
    if (block_.rows() == FormFactorMatrix::block_rows || row_ == matrix_.size()) {
        matrix_.set_block(std::move(block_));
        begin_block();
    }
    return std::nullopt;
}

void RowsBuilder::begin_block() {
    block_ = RowBlock{};
    block_.first_row = row_;
    block_.begin = {0};
}

} // namespace hemi::io
