#pragma once

#include "viewer/viewer.hpp"

#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace hemi::viewer {

/// Runs ViewerInput::solve on a thread of its own, and tells how far it is.
class LiveSolver {
public:
    /// @param changed  called on the other thread when status() or finished() has something new
    LiveSolver(std::function<Solved(const SolveProgress&)> solve, std::function<void()> changed);
    /// Stops what is under way, and waits until it has.
    ~LiveSolver();
    LiveSolver(const LiveSolver&) = delete;
    LiveSolver& operator=(const LiveSolver&) = delete;

    /// What is being done, and how fast.
    /// @param share  becomes the part of it that is done
    [[nodiscard]] std::string status(double& share) const;
    void cancel();

    /// The result, once; afterwards, and where there is none, nothing.
    /// @throws what the solution threw, but Cancelled
    [[nodiscard]] std::optional<Solved> take();
    [[nodiscard]] bool finished() const;

private:
    struct Progress {
        std::string title;
        std::string unit;
        std::size_t done = 0;
        std::size_t total = 0;
        double seconds = 0.0; ///< since this title began
    };

    void work(const std::stop_token& stop);

    std::function<Solved(const SolveProgress&)> solve_;
    std::function<void()> changed_;
    mutable std::mutex mutex_;
    Progress progress_;
    std::optional<Solved> result_;
    std::exception_ptr problem_;
    bool finished_ = false;
    std::jthread thread_; ///< last: it uses all of the above
};

} // namespace hemi::viewer
