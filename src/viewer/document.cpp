#include "viewer/document.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"

#include <fmt/format.h>

#include <utility>

namespace hemi::viewer {

Document::Document(ViewerInput input, std::function<void()> wake)
    : input_(std::move(input)), wake_(std::move(wake)),
      materials_(input_.scene->materials), light_{input_.reflectance, input_.exitance, {}},
      exposure_(input_.picture.exposure), exposure_settled_(!input_.automatic_exposure) {
    show_light(input_.radiosity, input_.find_rows ? State::lamps : State::solved);
    if (input_.find_rows) {
        finder_.emplace(input_.find_rows, wake_);
    }
}

/// After the radiosity has changed.
void Document::show_light(std::vector<double> radiosity, State state) {
    light_.radiosity = std::move(radiosity);
    state_ = state;
    light_mesh_ =
        make_picture_mesh(*input_.mesh, input_.channels, light_.radiosity, input_.rows.blocked, input_.show);
    light_mesh_.environment = input_.environment;
    if (!exposure_settled_) {
        exposure_ = automatic_exposure(*input_.mesh, light_mesh_, input_.rows.blocked, input_.exitance,
                                       input_.channels);
        exposure_settled_ = state == State::solved;
    }
    changed_ = true;
}

bool Document::update() {
    if (finder_) {
        take_rows();
    }
    if (relighter_) {
        take_light();
    }
    return std::exchange(changed_, false);
}

void Document::take_rows() {
    if (auto preview = finder_->take_preview()) {
        work_.light = "coarse preview";
        show_light(std::move(*preview), State::preview);
    }
    work_.doing = finder_->status(work_.share);
    if (!finder_->finished()) {
        return;
    }
    std::optional<FoundRows> found;
    try {
        found = finder_->take();
    } catch (...) {
        finder_.reset();
        work_.doing.clear();
        work_.light = "not solved";
        throw;
    }
    finder_.reset();
    work_.doing.clear();
    changed_ = true;
    if (!found) {
        stop_if_interrupted();
        work_.light = state_ == State::preview ? "stopped: this is the coarse preview"
                                               : "stopped: this is the light of the lamps alone";
        return;
    }
    input_.rows = std::move(*found);
    usual_factor_ = usual_largest_factor(*input_.rows.factors);
    relighter_.emplace(input_, wake_);
    relighter_->ask(of_materials());
}

void Document::take_light() {
    std::optional<Relit> relit = relighter_->take();
    work_.waits = relighter_->waits();
    if (!relit) {
        return;
    }
    work_.residuals = relighter_->residuals();
    if (!relit->problem.empty()) {
        work_.light = "no solution: " + relit->problem;
        changed_ = true;
        return;
    }
    work_.light = relit->converged
                      ? fmt::format("solved in {:.2f} s: {} {} to {:.1e}", relit->seconds, relit->sweeps,
                                    relit->solver == "cg" ? "iterations" : "sweeps", relit->residual)
                      : fmt::format("sweep {}: residual {:.1e}", relit->sweeps, relit->residual);
    light_.reflectance = relit->light.reflectance;
    light_.exitance = relit->light.exitance;
    input_.radiosity_error = relit->error ? relit->error->patches : std::vector<double>();
    show_light(relit->light.radiosity, relit->converged ? State::solved : State::converging);
    solved_.reset();
    if (relit->converged) {
        solved_ = std::move(relit);
    }
}

bool Document::busy() const {
    return finder_ || (relighter_ && relighter_->busy());
}

void Document::cancel() {
    if (finder_) {
        finder_->cancel();
    }
}

Light Document::of_materials() const {
    return {of_patches(materials_, *input_.mesh, &Material::reflectance),
            of_patches(materials_, *input_.mesh, &Material::exitance),
            {}};
}

void Document::set_materials(const std::vector<Material>& materials) {
    if (materials == materials_ || !relighter_) {
        return;
    }
    materials_ = materials;
    Light wanted = of_materials();
    wanted.radiosity = light_.radiosity;
    relighter_->ask(std::move(wanted));
}

void Document::start_over() {
    if (!relighter_) {
        return;
    }
    Light wanted = of_materials();
    light_.reflectance = wanted.reflectance;
    light_.exitance = wanted.exitance;
    relighter_->ask(std::move(wanted), true);
    work_.residuals.clear();
    work_.waits = true;
    work_.light = "the lamps alone: no sweep yet";
    solved_.reset();
    input_.radiosity_error.clear();
    show_light(light_.exitance, State::lamps);
    wake_();
}

void Document::step() {
    if (!relighter_) {
        return;
    }
    if (!relighter_->waits()) {
        start_over();
    }
    relighter_->step();
}

void Document::run_on() {
    if (relighter_) {
        relighter_->run_on();
    }
}

const char* Document::why_not_save() const {
    if (!input_.save_result) {
        return "a stored solution is stored already";
    }
    return solved_ ? nullptr : "the light is not solved yet";
}

void Document::save_result(const std::filesystem::path& path) {
    if (const char* reason = why_not_save()) {
        throw InvalidArgument(fmt::format("saving the result: {}", reason));
    }
    input_.save_result(path, {materials_, light_.radiosity, solved_->error, solved_->solver, solved_->sweeps,
                              solved_->residual});
}

} // namespace hemi::viewer
