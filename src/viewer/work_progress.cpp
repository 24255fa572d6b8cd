#include "viewer/work_progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hemi::viewer {

void WorkProgress::plan(std::vector<Phase> phases) {
    const std::lock_guard lock(mutex_);
    plan_ = std::move(phases);
}

bool WorkProgress::set(Phase phase, std::size_t done, std::size_t total) {
    constexpr std::chrono::milliseconds interval{100};
    const Clock::time_point now = Clock::now();
    const bool counts = phase != Phase::closure && phase != Phase::radiosity && phase != Phase::preview &&
                        phase != Phase::error_estimate && phase != Phase::patch_size;
    const std::lock_guard lock(mutex_);
    const auto stage = std::find(plan_.begin(), plan_.end(), phase);
    const std::string title = stage == plan_.end() ? std::string(to_word(phase))
                                                   : fmt::format("{}/{} {}", stage - plan_.begin() + 1,
                                                                 plan_.size(), to_word(phase));
    bool tell = now - told_ >= interval;
    if (title_ != title) {
        began_ = now;
        tell = true;
    }
    title_ = title;
    unit_ = counts ? "rows" : "";
    done_ = done;
    total_ = total;
    seconds_ = std::chrono::duration<double>(now - began_).count();
    told_ = tell ? now : told_;
    return tell;
}

std::string WorkProgress::text(double& share) const {
    const std::lock_guard lock(mutex_);
    share = total_ > 0 ? static_cast<double>(done_) / static_cast<double>(total_) : 0.0;
    std::string text = title_.empty() ? "starting" : title_;
    if (!unit_.empty() && seconds_ > 0.5) {
        text += fmt::format(", {:.0f} {}/s", static_cast<double>(done_) / seconds_, unit_);
    }
    constexpr double enough = 0.02; // of the stage, to tell of the rest
    if (share > enough && seconds_ > 0.5) {
        const auto left = static_cast<long long>(std::ceil(seconds_ * (1.0 - share) / share));
        text += fmt::format(", {}:{:02} left", left / 60, left % 60);
    }
    return text;
}

bool WorkObserver::progress(Phase phase, std::size_t done, std::size_t total) {
    if (progress_.set(phase, done, total)) {
        tell();
    }
    return !stop_.stop_requested();
}

void WorkObserver::warning(std::string_view message, std::string_view setting) {
    if (words_ != nullptr) {
        words_->warning(message, setting);
    }
}

void WorkObserver::note(std::string_view message) {
    if (words_ != nullptr) {
        words_->note(message);
    }
}

void WorkObserver::detail(std::string_view message) {
    if (words_ != nullptr) {
        words_->detail(message);
    }
}

} // namespace hemi::viewer
