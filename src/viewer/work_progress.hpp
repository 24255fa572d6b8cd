#pragma once

#include "hemi/pipeline/observer.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::viewer {

/// How far work on another thread is, for the window; used from both threads.
class WorkProgress {
public:
    /// What the work will consist of, in this order, as far as that is known.
    void plan(std::vector<Phase> phases);
    /// @param done  as Observer::progress has it
    /// @return whether so much time has passed, or so much has changed, that the window should be told
    bool set(Phase phase, std::size_t done, std::size_t total);
    /// What is being done, which stage of how many that is, how fast, and how long it takes from now.
    /// @param share  becomes the part of it that is done
    [[nodiscard]] std::string text(double& share) const;

private:
    using Clock = std::chrono::steady_clock;

    mutable std::mutex mutex_;
    std::vector<Phase> plan_;
    std::string title_;
    std::string unit_; ///< plural; empty: nothing is counted
    std::size_t done_ = 0;
    std::size_t total_ = 0;
    double seconds_ = 0.0; ///< since this title began
    Clock::time_point began_;
    Clock::time_point told_;
};

/// What work on a thread beside the window tells: its progress to the window, its words to who opened it.
class WorkObserver : public Observer {
public:
    /// @param words    gets warnings, notes and details; may be null
    /// @param changed  called when there is something new to be had
    WorkObserver(WorkProgress& progress, const std::stop_token& stop, Observer* words,
                 const std::function<void()>& changed)
        : progress_(progress), stop_(stop), words_(words), changed_(changed) {}

    bool progress(Phase phase, std::size_t done, std::size_t total) override;
    void warning(std::string_view message, std::string_view setting) override;
    void note(std::string_view message) override;
    void detail(std::string_view message) override;

protected:
    void tell() const { changed_(); }

private:
    WorkProgress& progress_;
    const std::stop_token& stop_;
    Observer* words_;
    const std::function<void()>& changed_;
};

} // namespace hemi::viewer
