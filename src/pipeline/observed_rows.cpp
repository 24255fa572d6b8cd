#include "pipeline/observed_rows.hpp"

#include "engine/raw_row.hpp"

#include <algorithm>
#include <iterator>

namespace hemi {

template <class Row>
ObservedRows<Row>::ObservedRows(BasicRowProvider<Row>& provider, Observer& observer,
                                RowCheckpoint* checkpoint, io::CheckpointKey key)
    : provider_(provider), observer_(observer), checkpoint_(checkpoint), key_(std::move(key)) {}

template <class Row>
void ObservedRows<Row>::rows(std::span<const std::uint32_t> patches, const Sink& sink) {
    const Sink shown = [&](std::uint32_t patch, const Row& row) {
        observer_.row(patch, row);
        sink(patch, row);
    };
    if (checkpoint_ == nullptr) {
        provider_.rows(patches, shown);
        return;
    }
    const std::vector<std::uint32_t> missing = resume(patches, shown);
    if (!missing.empty()) {
        provider_.rows(missing, [&](std::uint32_t patch, const Row& row) {
            keep(patch, row, missing);
            shown(patch, row);
        });
    }
}

template <class Row>
std::vector<std::uint32_t> ObservedRows<Row>::resume(std::span<const std::uint32_t> patches,
                                                     const Sink& sink) {
    std::vector<bool> there(size(), false);
    key_["renderer"] = renderer(); // others give other bits
    const auto take = [&](std::uint32_t patch, const RawRow& row, bool /*mark*/) {
        if (!std::binary_search(patches.begin(), patches.end(), patch)) {
            return; // other materials reflect than did
        }
        there[patch] = true;
        ++checkpoint_->reused_;
        sink(patch, row_from_raw<Row>(row));
    };
    checkpoint_->file_->start(key_, FormFactorMatrix(size()), take);
    checkpoint_->tell_reused(patches.size(), observer_);
    std::vector<std::uint32_t> missing;
    std::copy_if(patches.begin(), patches.end(), std::back_inserter(missing),
                 [&there](std::uint32_t patch) { return !there[patch]; });
    return missing;
}

template <class Row>
void ObservedRows<Row>::keep(std::uint32_t patch, const Row& row, std::span<const std::uint32_t> patches) {
    const std::uint32_t first = patch - patch % FormFactorMatrix::block_rows;
    const std::uint32_t count = std::min(FormFactorMatrix::block_rows, size() - first);
    OpenBlock& block =
        open_.try_emplace(first, first, count, rows_of_block(patches, first), expected_entries_)
            .first->second;
    block.add(patch, raw_row(row));
    if (!block.complete()) {
        return;
    }
    const RowBlock finished = block.finish();
    expected_entries_ = finished.columns.size() + finished.columns.size() / 16;
    open_.erase(first);
    checkpoint_->append(finished, {}, observer_);
}

template class ObservedRows<RowView>;
template class ObservedRows<VisibilityRow>;

} // namespace hemi
