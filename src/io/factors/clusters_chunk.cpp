#include "io/factors/clusters_chunk.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace hemi::io {

void write_clusters(ChunkWriter& writer, const SourceClusters& clusters) {
    std::vector<double> weights(clusters.size());
    for (std::uint32_t k = 0; k < clusters.nodes().size(); ++k) {
        const SourceClusters::Node& node = clusters.nodes()[k];
        if (node.child == 0) {
            weights[clusters.order()[node.begin]] = clusters.weight(k);
        }
    }
    writer.chunk("TREE",
                 {std::as_bytes(clusters.order()), std::as_bytes(clusters.nodes()), bytes_of(weights)});
}

std::uint64_t cluster_nodes(std::uint32_t patches) {
    return patches == 0 ? 0 : 2 * std::uint64_t{patches} - 1;
}

std::shared_ptr<const SourceClusters> read_clusters(Payload payload, std::uint32_t patches) {
    auto order = payload.take_array<std::uint32_t>(patches);
    auto nodes = payload.take_array<SourceClusters::Node>(cluster_nodes(patches));
    const auto weights = payload.take_array<double>(patches);
    payload.expect_end();
    for (std::size_t patch = 0; patch < weights.size(); ++patch) {
        if (!(weights[patch] >= 0.0) || !std::isfinite(weights[patch])) {
            payload.fail(fmt::format("the weight of patch {} is {}; must be finite and not negative", patch,
                                     weights[patch]));
        }
    }
    try {
        return std::make_shared<const SourceClusters>(std::move(order), std::move(nodes), weights);
    } catch (const InvalidArgument& error) {
        payload.fail(error.what());
    }
}

} // namespace hemi::io
