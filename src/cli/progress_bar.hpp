#pragma once

#include "cli/terminal.hpp"

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>

namespace hemi::cli {

/// Shows on stderr how far the work is, and passes on that the user wants it to stop.
///
/// On a terminal one line is drawn again and again, and wiped at the end. Elsewhere a line appears per tenth
/// of the work, with -v or once the work has lasted ten seconds. Nothing with -q.
class ProgressBar {
public:
    /// @param title  what is done
    /// @param unit   what is counted (plural). Empty: `done` is an estimate; no rate is shown, and -v asks
    /// for
    ///   no lines.
    ProgressBar(const Terminal& terminal, std::string title, std::string unit);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// @return false once SIGINT or SIGTERM has arrived.
    bool update(std::size_t done, std::size_t total);

private:
    using Clock = std::chrono::steady_clock;

    void draw(std::size_t done, std::size_t total, Clock::time_point now);
    void print_tenth(std::size_t done, std::size_t total, Clock::time_point now);

    const Terminal& terminal_;
    std::string title_;
    std::string unit_;
    std::optional<std::size_t> before_; ///< done at the first report, which comes when a part is done
    Clock::time_point start_;
    Clock::time_point drawn_;
    std::size_t tenth_ = 0;
    bool visible_ = false;
};

} // namespace hemi::cli
