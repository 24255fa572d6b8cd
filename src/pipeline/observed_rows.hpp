#pragma once

#include "engine/open_block.hpp"
#include "hemi/pipeline/checkpoint.hpp"
#include "hemi/pipeline/observer.hpp"
#include "io/factors/checkpoint_file.hpp"

#include <cstddef>
#include <map>
#include <span>
#include <vector>

namespace hemi {

/// Rows of a provider, shown to an observer; those that a checkpoint holds come from there, and all others
/// are kept in it.
/// @tparam Row  RowView or VisibilityRow
template <class Row>
class ObservedRows : public BasicRowProvider<Row> {
public:
    using Sink = typename BasicRowProvider<Row>::Sink;

    /// @param checkpoint  may be null; `key` says what its rows must have been made with
    ObservedRows(BasicRowProvider<Row>& provider, Observer& observer, RowCheckpoint* checkpoint,
                 io::CheckpointKey key);

    [[nodiscard]] std::uint32_t size() const override { return provider_.size(); }
    [[nodiscard]] std::string renderer() const override { return provider_.renderer(); }
    [[nodiscard]] std::uint64_t hemicubes() const override { return provider_.hemicubes(); }
    void rows(std::span<const std::uint32_t> patches, const Sink& sink) override;

private:
    /// Gives the rows of the checkpoint to `sink`. @return those of `patches` that it does not hold
    std::vector<std::uint32_t> resume(std::span<const std::uint32_t> patches, const Sink& sink);
    /// Adds a row to its block, and the block to the checkpoint once it is complete.
    void keep(std::uint32_t patch, const Row& row, std::span<const std::uint32_t> patches);

    BasicRowProvider<Row>& provider_;
    Observer& observer_;
    RowCheckpoint* checkpoint_;
    io::CheckpointKey key_;
    std::map<std::uint32_t, OpenBlock> open_;
    std::size_t expected_entries_ = 0; ///< of a block: what the last one had, and a little more
};

} // namespace hemi
