#pragma once

#include "hemi/pipeline/vertex_gather.hpp"
#include "viewer/heat.hpp"
#include "viewer/look.hpp"

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace hemi::viewer {

/// Light that was asked for: solved, or on the way there.
struct SolveUpdate {
    Light light;
    bool converged = false;
    Solution
        solution; ///< how the light was found; its radiosity is the light's. The error comes a little later
    std::string problem; ///< why there is no solution; then `light` is as it was asked for, not solved
    std::shared_ptr<const Heat> heat; ///< where the scene has some; a little later, too
};

/// Solves beside the window, on a thread of its own. A wish that comes before the last is fulfilled replaces
/// it. What the light is like after some sweeps is to be had as well; sweep by sweep, if that is asked for.
class Relighter {
public:
    /// @param input  outlives this; its factors are there
    /// @param done   called on the other thread when take() has something
    Relighter(const ViewerInput& input, std::function<void()> done);
    /// Gives up what is under way.
    ~Relighter();
    Relighter(const Relighter&) = delete;
    Relighter& operator=(const Relighter&) = delete;

    /// From the sources on, so that the same materials always give the same light.
    /// @param stepwise  wait for step() before every sweep; Gauss–Seidel unless another method was asked for
    void ask(Light wanted, bool stepwise = false);
    /// Lets it do one more sweep, or all that are left.
    void step();
    void run_on();

    /// Whether something was asked that was not taken, and goes on by itself.
    [[nodiscard]] bool busy() const;
    /// Whether it waits for step().
    [[nodiscard]] bool waits() const;
    /// The newest light.
    [[nodiscard]] std::optional<SolveUpdate> take();
    /// Residual after every sweep of the last wish.
    [[nodiscard]] std::vector<double> residuals() const;

private:
    struct Wish {
        Light light;
        bool stepwise = false;
    };

    class Wanted;

    void work(const std::stop_token& stop);
    [[nodiscard]] Wanted still_wanted(const std::stop_token& stop);
    void solve(Wish wish, const std::stop_token& stop);
    /// @throws Cancelled when the wish is no longer wanted
    void wait_for_step(std::unique_lock<std::mutex>& lock, const std::stop_token& stop);
    void publish(SolveUpdate update);
    /// Finds the radiosity at vertices: at once by rows that were kept, else by new ones, which take a while.
    /// @throws Cancelled when the light is no longer wanted
    void gather(SolveUpdate& update, const std::stop_token& stop);
    void try_to_gather(SolveUpdate& update, const std::stop_token& stop);

    const ViewerInput& input_;
    std::function<void()> done_;
    mutable std::mutex mutex_;
    std::condition_variable_any asked_;
    std::optional<Wish> wanted_;
    std::optional<SolveUpdate> result_;
    std::vector<double> residuals_;
    bool working_ = false;
    bool stepwise_ = false;              ///< what is under way waits for steps
    bool waiting_ = false;               ///< for one
    std::size_t steps_ = 0;              ///< allowed
    std::optional<VertexGather> gather_; ///< used on the other thread alone
    std::jthread thread_;                ///< last: it uses all of the above
};

} // namespace hemi::viewer
