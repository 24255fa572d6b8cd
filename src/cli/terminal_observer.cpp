#include "cli/terminal_observer.hpp"

#include "cli/signals.hpp"

#include <fmt/format.h>

#include <string>

namespace hemi::cli {

bool TerminalObserver::progress(Phase phase, std::size_t done, std::size_t total) {
    if (phase == Phase::error_estimate) { // over in a moment, and -v tells
        bar_.reset();
        return !interrupted();
    }
    if (!bar_ || phase_ != phase) {
        phase_ = phase;
        bar_.reset();
        bar_.emplace(terminal_, std::string(to_word(phase)), phase == Phase::radiosity ? "" : "rows");
    }
    const bool go_on = bar_->update(done, total);
    if (done >= total) {
        bar_.reset();
    }
    return go_on;
}

void TerminalObserver::warning(std::string_view message, std::string_view setting) {
    terminal_.warn(setting.empty() ? std::string(message) : fmt::format("{} (see --{})", message, setting));
}

void TerminalObserver::note(std::string_view message) {
    terminal_.note(message);
}

void TerminalObserver::detail(std::string_view message) {
    terminal_.detail(message);
}

} // namespace hemi::cli
