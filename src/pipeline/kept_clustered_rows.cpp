#include "pipeline/kept_clustered_rows.hpp"

#include "hemi/matrix/source_clusters.hpp"

#include <algorithm>
#include <utility>

namespace hemi {

KeptClusteredRows::KeptClusteredRows(RowCheckpoint& checkpoint, io::CheckpointKey key, Observer& observer)
    : checkpoint_(checkpoint), key_(std::move(key)), observer_(observer) {}

void KeptClusteredRows::resume(const std::shared_ptr<const SourceClusters>& clusters,
                               std::span<const std::uint32_t> wanted, const EachRow& each) {
    checkpoint_.file_->start(key_, FormFactorMatrix(clusters->size(), clusters),
                             [&](std::uint32_t patch, const RowView& row, bool hides) {
                                 if (std::binary_search(wanted.begin(), wanted.end(), patch)) {
                                     ++checkpoint_.reused_;
                                     each(patch, row, hides);
                                 }
                             });
    checkpoint_.tell_reused(wanted.size(), observer_);
}

void KeptClusteredRows::keep(const RowBlock& rows, std::span<const std::uint8_t> hides) {
    checkpoint_.append(rows, hides, observer_);
}

} // namespace hemi
