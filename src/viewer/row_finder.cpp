#include "viewer/row_finder.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <chrono>
#include <span>
#include <utility>

namespace hemi::viewer {

RowFinder::RowFinder(std::function<FoundRows(const RowListener&)> find, std::function<void()> changed)
    : find_(std::move(find)), changed_(std::move(changed)),
      thread_([this](const std::stop_token& stop) { work(stop); }) {}

RowFinder::~RowFinder() = default;

std::string RowFinder::status(double& share) const {
    if (thread_.get_stop_token().stop_requested()) {
        return "stopping";
    }
    const std::lock_guard lock(mutex_);
    const Progress& now = progress_;
    share = now.total > 0 ? static_cast<double>(now.done) / static_cast<double>(now.total) : 0.0;
    std::string text = now.title.empty() ? "starting" : now.title;
    if (!now.unit.empty() && now.seconds > 0.5) {
        text += fmt::format(", {:.0f} {}/s", static_cast<double>(now.done) / now.seconds, now.unit);
    }
    return text;
}

void RowFinder::cancel() {
    thread_.request_stop();
}

bool RowFinder::finished() const {
    const std::lock_guard lock(mutex_);
    return finished_;
}

std::optional<std::vector<double>> RowFinder::take_preview() {
    const std::lock_guard lock(mutex_);
    return std::exchange(preview_, std::nullopt);
}

GatheredLight RowFinder::take_gathered() {
    const std::lock_guard lock(mutex_);
    return std::exchange(gathered_, {});
}

std::optional<FoundRows> RowFinder::take() {
    const std::lock_guard lock(mutex_);
    if (problem_) {
        std::rethrow_exception(std::exchange(problem_, nullptr));
    }
    return std::exchange(result_, std::nullopt);
}

void RowFinder::work(const std::stop_token& stop) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::milliseconds interval{100};
    Clock::time_point began;
    Clock::time_point told;
    const SolveProgress progress = [&](std::string_view title, std::string_view unit, std::size_t done,
                                       std::size_t total) {
        const Clock::time_point now = Clock::now();
        bool tell = now - told >= interval;
        {
            const std::lock_guard lock(mutex_);
            if (progress_.title != title) {
                began = now;
                tell = true;
            }
            progress_ = {std::string(title), std::string(unit), done, total,
                         std::chrono::duration<double>(now - began).count()};
        }
        if (tell) {
            told = now;
            changed_();
        }
        return !stop.stop_requested();
    };
    const auto preview = [&](std::vector<double> radiosity) {
        {
            const std::lock_guard lock(mutex_);
            preview_ = std::move(radiosity);
        }
        changed_();
    };
    // Told together with the progress.
    const auto gathered = [&](std::uint32_t patch, std::span<const double> radiosity, double blocked) {
        const std::lock_guard lock(mutex_);
        gathered_.patches.push_back(patch);
        gathered_.radiosity.insert(gathered_.radiosity.end(), radiosity.begin(), radiosity.end());
        gathered_.blocked.push_back(blocked);
    };
    std::optional<FoundRows> found;
    std::exception_ptr problem;
    try {
        found = find_({progress, preview, gathered});
    } catch (const Cancelled&) { // as was asked for
    } catch (...) {
        problem = std::current_exception();
    }
    {
        const std::lock_guard lock(mutex_);
        result_ = std::move(found);
        problem_ = std::move(problem); // the last hold on it on this thread
        finished_ = true;
    }
    changed_();
}

} // namespace hemi::viewer
