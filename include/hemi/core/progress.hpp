#pragma once

#include <cstddef>
#include <functional>

namespace hemi {

/// Called now and then from the thread that started the work, with `done` of `total` units finished.
/// Returning false asks the work to stop: it then throws Cancelled and leaves nothing behind.
using Progress = std::function<bool(std::size_t done, std::size_t total)>;

} // namespace hemi
