#pragma once

#include <cstddef>
#include <functional>

namespace hemi {

/// Calls `body(begin, end)` for ranges of up to `grain` that cover [0, count), on one thread per core. Ranges
/// are handed out in ascending order; bodies must not touch each other's results. Returns when all are done;
/// the first exception of a body stops the rest and is passed on.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

} // namespace hemi
