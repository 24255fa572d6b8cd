#include "cli/terminal_observer.hpp"

#include "cli/signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace hemi::cli {

std::string TerminalObserver::title(Phase phase) const {
    const auto at = std::find(plan_.begin(), plan_.end(), phase);
    return at == plan_.end() ? std::string(to_word(phase))
                             : fmt::format("{}/{} {}", at - plan_.begin() + 1, plan_.size(), to_word(phase));
}

bool TerminalObserver::progress(Phase phase, std::size_t done, std::size_t total) {
    if (phase == Phase::error_estimate) { // over in a moment, and -v tells
        bar_.reset();
        return !interrupted();
    }
    if (!bar_ || phase_ != phase) {
        phase_ = phase;
        bar_.reset();
        const bool counts =
            phase != Phase::closure && phase != Phase::radiosity && phase != Phase::patch_size;
        bar_.emplace(terminal_, title(phase), counts ? "rows" : "");
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
