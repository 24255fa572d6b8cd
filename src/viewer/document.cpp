#include "viewer/document.hpp"

#include "display/picture_mesh.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"

#include <fmt/format.h>

#include <utility>

namespace hemi::viewer {

Document::Document(ViewerInput input, std::function<void()> wake)
    : input_(std::move(input)), wake_(std::move(wake)), surfaces_(*input_.mesh),
      materials_(input_.scene->materials), light_{input_.reflectance, input_.exitance, {}, {}},
      blocked_(input_.rows.blocked), exposure_(input_.picture.exposure),
      exposure_settled_(!input_.automatic_exposure) {
    show_light(input_.radiosity, input_.find_rows ? State::lamps : State::solved);
    if (input_.find_rows) {
        finder_.emplace(input_.find_rows, wake_);
    }
}

void Document::show_light(std::vector<double> radiosity, State state) {
    light_.radiosity = std::move(radiosity);
    light_.known.clear();
    if (state == State::lamps) {
        light_.known.assign(input_.mesh->size(), 0);
        for (std::size_t k = 0; k < light_.exitance.size(); ++k) {
            if (light_.exitance[k] > 0.0) {
                light_.known[k / input_.channels] = 1;
            }
        }
    }
    state_ = state;
    make_light_mesh();
}

/// After the radiosity has changed.
void Document::make_light_mesh() {
    std::vector<double> left_out = blocked_; // what is not known must not darken what is
    if (!light_.known.empty()) {
        left_out.resize(light_.known.size(), 0.0);
        for (std::uint32_t i = 0; i < left_out.size(); ++i) {
            left_out[i] = light_.knows(i) ? left_out[i] : 1.0;
        }
    }
    light_mesh_ =
        make_picture_mesh(*input_.mesh, surfaces_, input_.channels, light_.radiosity, left_out, input_.show);
    light_mesh_.environment = input_.environment;
    if (!exposure_settled_ && !(state_ == State::preview && gathered_ > 0)) {
        exposure_ = automatic_exposure(*input_.mesh, light_mesh_, left_out, input_.exitance, input_.channels);
        exposure_settled_ = state_ == State::solved;
    }
    changed_ = true;
}

bool Document::update(bool gathered) {
    if (finder_) {
        take_rows(gathered);
    }
    if (relighter_) {
        take_light();
    }
    return std::exchange(changed_, false);
}

double Document::gathered_share() const {
    return static_cast<double>(gathered_) / static_cast<double>(input_.mesh->size());
}

std::string Document::gathered_text() const {
    const bool preview = state_ == State::preview;
    if (gathered_ == 0) {
        return preview ? "this is the coarse preview" : "this is the light of the lamps alone";
    }
    const double percent = 100.0 * gathered_share();
    return preview ? fmt::format("preview, {:.0f} % of it sharper", percent)
                   : fmt::format("lamps' light at {:.0f} % of patches", percent);
}

/// Puts on the picture what rows that have come by now tell of their own patches.
void Document::show_gathered(const GatheredLight& gathered) {
    if (gathered.patches.empty()) {
        return;
    }
    blocked_.resize(input_.mesh->size(), 0.0);
    for (std::size_t k = 0; k < gathered.patches.size(); ++k) {
        const std::uint32_t i = gathered.patches[k];
        for (std::size_t c = 0; c < input_.channels; ++c) {
            light_.radiosity[i * std::size_t{input_.channels} + c] =
                gathered.radiosity[k * input_.channels + c];
        }
        blocked_[i] = gathered.blocked[k];
        if (!light_.known.empty()) {
            light_.known[i] = 1;
        }
    }
    gathered_ += gathered.patches.size();
    work_.light = "provisional: " + gathered_text();
    make_light_mesh();
}

void Document::take_rows(bool gathered) {
    const bool finished = finder_->finished();
    // Before the preview is looked for, since rows are told after it.
    const GatheredLight of_rows = gathered || finished ? finder_->take_gathered() : GatheredLight{};
    if (auto preview = finder_->take_preview()) {
        work_.light = "coarse preview";
        show_light(std::move(*preview), State::preview);
    }
    show_gathered(of_rows);
    work_.doing = finder_->status(work_.share);
    if (!finished) {
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
        work_.light = "stopped: " + gathered_text();
        return;
    }
    input_.rows = std::move(*found);
    blocked_ = input_.rows.blocked;
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
    const std::string steps =
        std::string(relit->solver == "cg" ? "iteration" : "sweep") + (relit->sweeps == 1 ? "" : "s");
    if (!relit->problem.empty()) {
        work_.light = "no solution: " + relit->problem;
        changed_ = true;
        return;
    }
    work_.light = relit->converged ? fmt::format("solved in {:.2f} s: {} {} to {:.1e}", relit->seconds,
                                                 relit->sweeps, steps, relit->residual)
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
            {},
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
