#include "viewer/mesh_refiner.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/pipeline/refinement.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace hemi::viewer {

namespace {

std::string step_words(const Refinement::Step& step) {
    return plural(step.patches, "patch", "patches") +
           (std::isfinite(step.error) ? fmt::format(", error {:.2g} %", 100.0 * step.error) : "");
}

} // namespace

/// Hears of the work on the refiner's thread, and passes it on to the window's.
class MeshRefiner::Listener : public WorkObserver {
public:
    Listener(MeshRefiner& refiner, const std::stop_token& stop)
        : WorkObserver(refiner.progress_, stop, refiner.coarse_.observer.get(), refiner.changed_),
          refiner_(refiner) {}

    void refined(const Refinement& so_far) override {
        ViewerInput input = refiner_.coarse_;
        input.adopt(input, so_far.mesh);
        input.solution = so_far.solution;
        input.of_solution = "on the way: " + step_words(so_far.steps.back());
        refiner_.publish(std::move(input));
    }

private:
    MeshRefiner& refiner_;
};

MeshRefiner::MeshRefiner(const ViewerInput& coarse, std::function<void()> changed)
    : coarse_(coarse), changed_(std::move(changed)),
      thread_([this](const std::stop_token& stop) { work(stop); }) {}

MeshRefiner::~MeshRefiner() = default;

std::string MeshRefiner::status(double& share) const {
    return thread_.get_stop_token().stop_requested() ? "stopping" : progress_.text(share);
}

void MeshRefiner::cancel() {
    thread_.request_stop();
}

bool MeshRefiner::finished() const {
    const std::lock_guard lock(mutex_);
    return finished_;
}

bool MeshRefiner::busy() const {
    const std::lock_guard lock(mutex_);
    return !finished_ || newest_ || problem_;
}

std::optional<ViewerInput> MeshRefiner::take() {
    const std::lock_guard lock(mutex_);
    if (problem_) {
        std::rethrow_exception(std::exchange(problem_, nullptr));
    }
    return std::exchange(newest_, std::nullopt);
}

void MeshRefiner::publish(ViewerInput input) {
    {
        const std::lock_guard lock(mutex_);
        newest_ = std::move(input);
    }
    changed_();
}

void MeshRefiner::work(const std::stop_token& stop) {
    Listener listener(*this, stop);
    std::exception_ptr problem;
    try {
        Refinement found = solve_refined(*coarse_.scene, *coarse_.mesh, *coarse_.factor_settings,
                                         coarse_.solver, *coarse_.refinement, false, listener);
        ViewerInput input = coarse_;
        input.adopt(input, std::move(found.mesh));
        input.refinement.reset();
        input.solution = std::move(found.solution);
        input.of_solution = step_words(found.steps.back());
        if (!found.stopped.empty() && coarse_.refinement->error) {
            input.of_solution +=
                fmt::format("; {:.2g} % is not met: {}", 100.0 * *coarse_.refinement->error, found.stopped);
        }
        input.factors = std::make_shared<const FormFactors>(std::move(found.factors));
        publish(std::move(input));
    } catch (const Cancelled&) { // as was asked for
    } catch (...) {
        problem = std::current_exception();
    }
    {
        const std::lock_guard lock(mutex_);
        problem_ = std::move(problem); // the last hold on it on this thread
        finished_ = true;
    }
    changed_();
}

} // namespace hemi::viewer
