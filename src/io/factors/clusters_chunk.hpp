#pragma once

#include "hemi/matrix/source_clusters.hpp"
#include "io/formats/chunk_file.hpp"

#include <cstdint>
#include <memory>

/// SourceClusters as one chunk, `TREE`: order (32 bits a patch), nodes (begin, end, child: 32 bits each),
/// weights (double a patch).
namespace hemi::io {

void write_clusters(ChunkWriter& writer, const SourceClusters& clusters);

/// Number of nodes of a tree down to single patches.
[[nodiscard]] std::uint64_t cluster_nodes(std::uint32_t patches);

/// Takes the whole payload.
/// @param patches  how many there are, above 0
/// @throws InputError unless it is a tree of all patches and weights are finite and not negative
[[nodiscard]] std::shared_ptr<const SourceClusters> read_clusters(Payload payload, std::uint32_t patches);

} // namespace hemi::io
