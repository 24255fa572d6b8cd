#pragma once

#include <chrono>

namespace hemi {

/// Wall time since it was made.
class Stopwatch {
public:
    /// Seconds since then.
    [[nodiscard]] double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

} // namespace hemi
