#pragma once

#include "hemi/engine/clustered_rows.hpp"
#include "hemi/pipeline/checkpoint.hpp"
#include "hemi/pipeline/observer.hpp"
#include "io/factors/checkpoint_file.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace hemi {

/// Rows of clusters in a checkpoint.
class KeptClusteredRows : public ClusteredRowKeeper {
public:
    /// @param checkpoint  must outlive this, as `observer`, which is told what was taken from it, and warned
    /// @param key  says what its rows must have been made with
    KeptClusteredRows(RowCheckpoint& checkpoint, io::CheckpointKey key, Observer& observer);

    void resume(const std::shared_ptr<const SourceClusters>& clusters, std::span<const std::uint32_t> wanted,
                const EachRow& each) override;
    void keep(const RowBlock& rows, std::span<const std::uint8_t> hides) override;

private:
    RowCheckpoint& checkpoint_;
    io::CheckpointKey key_;
    Observer& observer_;
};

} // namespace hemi
