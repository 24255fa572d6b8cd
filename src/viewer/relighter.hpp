#pragma once

#include "viewer/look.hpp"

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace hemi::viewer {

/// The light after materials have changed, from the form factors that are there.
struct Relit {
    Light light;
    std::uint32_t sweeps = 0;
    double seconds = 0.0;
    std::string problem; ///< why there is no solution; then `light` is as it was asked for, not solved
};

/// Solves beside the window, on a thread of its own, from the last solution on. A wish that comes before the
/// last is fulfilled replaces it.
class Relighter {
public:
    /// @param input  outlives this; its factors are there
    /// @param done   called on the other thread when take() has something
    Relighter(const ViewerInput& input, std::function<void()> done);
    /// Gives up what is under way.
    ~Relighter();
    Relighter(const Relighter&) = delete;
    Relighter& operator=(const Relighter&) = delete;

    /// @param wanted  its radiosity is where the sweeps begin
    void ask(Light wanted);
    /// Whether something was asked that was not taken.
    [[nodiscard]] bool busy() const;
    [[nodiscard]] std::optional<Relit> take();

private:
    void work(const std::stop_token& stop);
    [[nodiscard]] std::optional<Relit> solve(Light wanted, const std::stop_token& stop);

    const ViewerInput& input_;
    std::function<void()> done_;
    mutable std::mutex mutex_;
    std::condition_variable_any asked_;
    std::optional<Light> wanted_;
    std::optional<Relit> result_;
    bool working_ = false;
    std::jthread thread_; ///< last: it uses all of the above
};

} // namespace hemi::viewer
