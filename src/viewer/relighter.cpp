#include "viewer/relighter.hpp"

#include "hemi/core/error.hpp"
#include "hemi/solver/solver.hpp"

#include <chrono>
#include <utility>

namespace hemi::viewer {

Relighter::Relighter(const ViewerInput& input, std::function<void()> done)
    : input_(input), done_(std::move(done)), thread_([this](const std::stop_token& stop) { work(stop); }) {}

Relighter::~Relighter() = default;

void Relighter::ask(Light wanted) {
    {
        const std::lock_guard lock(mutex_);
        wanted_ = std::move(wanted);
        result_.reset();
    }
    asked_.notify_one();
}

bool Relighter::busy() const {
    const std::lock_guard lock(mutex_);
    return working_ || wanted_ || result_;
}

std::optional<Relit> Relighter::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(result_, std::nullopt);
}

void Relighter::work(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (asked_.wait(lock, stop, [this] { return wanted_.has_value(); })) {
        Light wanted = *std::exchange(wanted_, std::nullopt);
        working_ = true;
        lock.unlock();
        std::optional<Relit> found = solve(std::move(wanted), stop);
        lock.lock();
        working_ = false;
        if (found && !wanted_) {
            result_ = std::move(found);
            lock.unlock();
            done_();
            lock.lock();
        }
    }
}

std::optional<Relit> Relighter::solve(Light wanted, const std::stop_token& stop) {
    const auto start = std::chrono::steady_clock::now();
    Relit relit;
    try {
        const RadiosityProblem problem{input_.factors.get(), input_.channels,           wanted.reflectance,
                                       wanted.exitance,      input_.scene->environment, input_.mesh->areas()};
        SolverSettings settings = input_.solver;
        settings.start = wanted.radiosity;
        RadiositySolution solution = solve_radiosity(problem, settings, [&](std::uint32_t, double) {
            const std::lock_guard lock(mutex_);
            return !stop.stop_requested() && !wanted_;
        });
        relit.sweeps = solution.sweeps;
        wanted.radiosity = std::move(solution.radiosity);
    } catch (const Cancelled&) {
        return std::nullopt;
    } catch (const std::exception& error) {
        relit.problem = error.what();
    }
    relit.light = std::move(wanted);
    relit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return relit;
}

} // namespace hemi::viewer
