#include "viewer/relighter.hpp"

#include "hemi/core/error.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/solver/solver.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

namespace hemi::viewer {

namespace {

using Clock = std::chrono::steady_clock;

/// Light on the way to the solution is shown no more often than this.
constexpr std::chrono::milliseconds interval{80};
/// And from this residual on: before, the light that is shown is nearer to what will be.
constexpr double near_solution = 0.01;

} // namespace

/// Stops what is no longer wanted; what it warns of was told when the file was read.
class Relighter::Wanted final : public Observer {
public:
    explicit Wanted(std::function<bool()> wanted) : wanted_(std::move(wanted)) {}
    bool progress(Phase, std::size_t, std::size_t) override { return wanted_(); }

private:
    std::function<bool()> wanted_;
};

Relighter::Wanted Relighter::still_wanted(const std::stop_token& stop) {
    return Wanted([this, &stop] {
        const std::lock_guard lock(mutex_);
        return !stop.stop_requested() && !wanted_;
    });
}

Relighter::Relighter(const ViewerInput& input, std::function<void()> done)
    : input_(input), done_(std::move(done)), thread_([this](const std::stop_token& stop) { work(stop); }) {}

Relighter::~Relighter() = default;

void Relighter::ask(Light wanted, bool stepwise) {
    {
        const std::lock_guard lock(mutex_);
        wanted_ = Wish{std::move(wanted), stepwise};
        result_.reset();
        residuals_.clear();
        stepwise_ = stepwise;
        steps_ = 0;
    }
    asked_.notify_one();
}

void Relighter::step() {
    {
        const std::lock_guard lock(mutex_);
        ++steps_;
    }
    asked_.notify_one();
}

void Relighter::run_on() {
    {
        const std::lock_guard lock(mutex_);
        stepwise_ = false;
    }
    asked_.notify_one();
}

bool Relighter::busy() const {
    const std::lock_guard lock(mutex_);
    return result_ || ((working_ || wanted_) && !(waiting_ && stepwise_ && steps_ == 0));
}

bool Relighter::waits() const {
    const std::lock_guard lock(mutex_);
    return (working_ || wanted_) && stepwise_;
}

std::optional<SolveUpdate> Relighter::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(result_, std::nullopt);
}

std::vector<double> Relighter::residuals() const {
    const std::lock_guard lock(mutex_);
    return residuals_;
}

void Relighter::work(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (asked_.wait(lock, stop, [this] { return wanted_.has_value(); })) {
        Wish wish = *std::exchange(wanted_, std::nullopt);
        working_ = true;
        lock.unlock();
        try {
            solve(std::move(wish), stop);
        } catch (const Cancelled&) { // another wish has come
        }
        lock.lock();
        working_ = false;
        stepwise_ = wanted_ && wanted_->stepwise;
    }
}

void Relighter::publish(SolveUpdate update) {
    {
        const std::lock_guard lock(mutex_);
        if (wanted_) {
            return;
        }
        result_ = std::move(update);
    }
    done_();
}

void Relighter::wait_for_step(std::unique_lock<std::mutex>& lock, const std::stop_token& stop) {
    waiting_ = true;
    asked_.wait(lock, stop, [this] { return wanted_ || !stepwise_ || steps_ > 0; });
    waiting_ = false;
    if (stop.stop_requested() || wanted_) {
        throw Cancelled();
    }
    steps_ -= steps_ > 0 ? 1 : 0;
}

void Relighter::gather(SolveUpdate& update, const std::stop_token& stop) {
    try {
        try_to_gather(update, stop);
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& error) {
        gather_.reset();
        if (input_.observer) {
            input_.observer->warning(fmt::format("vertices have means over patches: {}", error.what()), "");
        }
    }
}

void Relighter::try_to_gather(SolveUpdate& update, const std::stop_token& stop) {
    Solution solution;
    solution.channels = input_.channels();
    solution.radiosity = update.light.radiosity;
    solution.exitance = update.light.exitance;
    solution.back_face_share = input_.solution.back_face_share;
    solution.direct = input_.solution.direct;
    if (!input_.factor_settings ||
        !should_gather(input_.gather, *input_.factor_settings, *input_.mesh, solution)) {
        return;
    }
    const PatchValues values{solution.channels,        update.light.reflectance, update.light.exitance,
                             update.light.environment, solution.direct,          input_.scene->sun,
                             input_.scene->sky,        input_.scene->up};
    if (!gather_) {
        gather_.emplace(*input_.mesh, solution.back_face_share, all_patches(input_.mesh->size()));
    }
    if (gather_->has_rows()) {
        update.light.vertices = gather_->gather(values, solution.radiosity);
        return;
    }
    Wanted wanted = still_wanted(stop);
    update.light.vertices =
        gather_->compute(values, solution.radiosity, *input_.factor_settings, input_.scene->enclosure,
                         input_.factors->matrix.memory_bytes(), wanted);
}

void Relighter::solve(Wish wish, const std::stop_token& stop) {
    SolveUpdate update;
    update.light = std::move(wish.light);
    Clock::time_point began = Clock::now();
    try {
        const RadiosityProblem problem{
            &input_.factors->matrix,  input_.channels(),    update.light.reflectance, update.light.exitance,
            update.light.environment, input_.mesh->areas(), input_.solution.direct};
        SolverSettings settings = input_.solver;
        if (wish.stepwise && settings.method == SolverMethod::automatic) {
            settings.method = SolverMethod::gauss_seidel;
        }
        Clock::time_point shown = began;
        settings.watch = [&](std::uint32_t sweep, double residual, const auto& radiosity) {
            const Clock::time_point now = Clock::now();
            std::unique_lock lock(mutex_);
            if (stop.stop_requested() || wanted_) {
                throw Cancelled();
            }
            residuals_.push_back(residual);
            const bool waits = stepwise_ && steps_ == 0;
            const bool shows = wish.stepwise || residual < near_solution;
            if (waits || (shows && now - shown >= interval)) {
                shown = now;
                lock.unlock();
                SolveUpdate so_far;
                so_far.light = update.light;
                so_far.solution.method = settings.method;
                so_far.solution.sweeps = sweep;
                so_far.solution.residual = residual;
                so_far.solution.seconds = std::chrono::duration<double>(now - began).count();
                so_far.light.radiosity = radiosity();
                publish(std::move(so_far));
                lock.lock();
            }
            wait_for_step(lock, stop);
            return true;
        };
        if (wish.stepwise) {
            std::unique_lock lock(mutex_);
            wait_for_step(lock, stop);
        }
        began = Clock::now();
        update.solution = solve_radiosity(problem, settings);
        update.converged = true;
        update.light.radiosity = std::exchange(update.solution.radiosity, {});
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& error) {
        update.problem = error.what();
    }
    update.solution.seconds = std::chrono::duration<double>(Clock::now() - began).count();
    if (update.converged && gather_ && gather_->has_rows()) {
        gather(update, stop);
    }
    publish(update);
    const FormFactors& factors = *input_.factors;
    if (update.converged && factors.error) {
        update.solution.error = estimate_radiosity_error(
            factors.matrix, factors.reference, input_.mesh->areas(), input_.channels(),
            update.light.reflectance, update.light.exitance, update.light.radiosity);
        publish(update);
    }
    if (update.converged && input_.heat) {
        Wanted wanted = still_wanted(stop);
        update.heat = std::make_shared<const Heat>(find_heat(input_, update.light, wanted));
        publish(update);
    }
    if (update.converged && update.light.vertices.empty()) {
        gather(update, stop);
        if (!update.light.vertices.empty()) {
            publish(std::move(update));
        }
    }
}

} // namespace hemi::viewer
