#include "viewer/document.hpp"

#include "hemi/io/result_file.hpp"
#include "hemi/pipeline/picture.hpp"

#include "display/picture_mesh.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/pipeline/daylight.hpp"
#include "viewer/mesh_refiner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

namespace hemi::viewer {

Document::Document(ViewerInput input, std::shared_ptr<FactorCache> cache, std::function<void()> wake)
    : input_(std::move(input)), wake_(std::move(wake)),
      surfaces_(*input_.mesh), wanted_{input_.scene->materials,
                                       input_.heat ? input_.heat->conditions : std::vector<HeatCondition>(),
                                       input_.environment()},
      light_(of_materials()), blocked_(input_.solution.back_face_share), exposure_(input_.picture.exposure),
      exposure_settled_(!input_.automatic_exposure) {
    const bool solved = !input_.factor_settings || !input_.of_solution.empty();
    show_light(input_.solution.radiosity,
               !solved             ? State::lamps
               : input_.refinement ? State::converging
                                   : State::solved,
               input_.solution.vertex_radiosity);
    work_.light = input_.of_solution;
    if (input_.refinement && !input_.refiner) {
        input_.refiner = std::make_shared<MeshRefiner>(input_, wake_);
    } else if (input_.factors) {
        begin_with_factors(solved);
    } else if (input_.factor_settings && !input_.refinement) {
        finder_.emplace(input_, std::move(cache), wake_);
    }
}

/// @param solved  by them
void Document::begin_with_factors(bool solved) {
    show_factors(std::exchange(input_.factors, nullptr));
    relighter_.emplace(input_, wake_);
    if (!solved) {
        relighter_->ask(of_materials());
        return;
    }
    solved_.emplace();
    solved_->light = light_;
    solved_->converged = true;
    solved_->solution = input_.solution;
}

void Document::show_light(std::vector<double> radiosity, State state, std::vector<float> vertices) {
    light_.radiosity = std::move(radiosity);
    light_.vertices = std::move(vertices);
    light_.known.clear();
    if (state == State::lamps) {
        light_.known.assign(input_.mesh->size(), 0);
        for (std::size_t k = 0; k < light_.exitance.size(); ++k) {
            if (light_.exitance[k] > 0.0) {
                light_.known[k / input_.channels()] = 1;
            }
        }
    }
    state_ = state;
    make_light_mesh();
}

bool Document::stays_dark() const {
    const auto is_zero = [](double value) { return value == 0.0; };
    const Scene& scene = *input_.scene;
    return is_dark(light_.radiosity, light_.environment) &&
           (state_ == State::solved ||
            (std::all_of(light_.exitance.begin(), light_.exitance.end(), is_zero) && !scene.sun &&
             !scene.sky));
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
    evenly_lit_ = stays_dark();
    light_mesh_ = evenly_lit_ ? make_picture_mesh(*input_.mesh, surfaces_, input_.channels(),
                                                  even_light(*input_.mesh, light_.reflectance,
                                                             input_.channels(), input_.scene->up),
                                                  input_.solution.back_face_share, input_.show)
                              : make_picture_mesh(*input_.mesh, surfaces_, input_.channels(),
                                                  light_.radiosity, left_out, input_.show, light_.vertices);
    light_note_.clear();
    if (evenly_lit_ || state_ == State::solved) {
        const Lit now = lit(false);
        light_note_ = hemi::light_note(now.scene, now.solution);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        light_mesh_.environment[k] = static_cast<float>(light_.environment[input_.show[k]]);
    }
    if (!exposure_settled_ && !(state_ == State::preview && gathered_ > 0)) {
        exposure_ = automatic_exposure(*input_.mesh, light_mesh_,
                                       evenly_lit_ ? std::span<const double>(input_.solution.back_face_share)
                                                   : std::span<const double>(left_out),
                                       input_.solution.exitance, input_.channels());
        exposure_settled_ = state_ == State::solved && !evenly_lit_;
    }
    changed_ = true;
}

bool Document::update(bool gathered) {
    if (input_.refiner) {
        look_at_refiner();
    }
    if (finder_) {
        take_rows(gathered);
    }
    if (relighter_) {
        take_light();
    }
    return std::exchange(changed_, false);
}

void Document::look_at_refiner() {
    const bool finished = input_.refiner->finished();
    work_.doing = finished ? "" : input_.refiner->status(work_.share);
    if (finished && input_.refinement && state_ == State::converging) {
        work_.light = "stopped: " + input_.of_solution;
    }
}

std::optional<ViewerInput> Document::take_refined() {
    if (!input_.refiner) {
        return std::nullopt;
    }
    std::optional<ViewerInput> next = input_.refiner->take();
    if (next) {
        next->refiner = input_.refiner;
    }
    return next;
}

const SmoothSurfaces& Document::surfaces_across() const {
    if (!surfaces_across_) {
        surfaces_across_.emplace(*input_.mesh, true);
    }
    return *surfaces_across_;
}

void Document::look_for_findings() {
    if (!findings_ && !finding_search_ && input_.factors) {
        finding_search_ =
            std::make_unique<FindingSearch>(input_.factors, input_.mesh, input_.max_row_error, wake_);
    }
}

bool Document::take_findings() {
    if (!finding_search_ || !finding_search_->finished()) {
        return false;
    }
    findings_ = finding_search_->take();
    finding_search_.reset();
    return true;
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
        for (std::size_t c = 0; c < input_.channels(); ++c) {
            light_.radiosity[i * std::size_t{input_.channels()} + c] =
                gathered.radiosity[k * input_.channels() + c];
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

/// Form factors are there: what they say of rows, and of the hemicubes' scale.
void Document::show_factors(std::shared_ptr<const FormFactors> factors) {
    const FormFactorMatrix& matrix = factors->matrix;
    Solution& solution = input_.solution;
    solution.row_sum.clear();
    solution.environment_share.clear();
    solution.back_face_share.clear();
    for (std::uint32_t i = 0; i < matrix.size(); ++i) {
        const RowView row = matrix.row(i);
        solution.row_sum.push_back(row.sum());
        solution.environment_share.push_back(row.environment);
        solution.back_face_share.push_back(row.blocked);
    }
    solution.renderer = factors->provenance.renderer;
    solution.factor_error = factors->error;
    blocked_ = solution.back_face_share;
    usual_factor_ = usual_largest_factor(matrix);
    solution.direct = direct_irradiance(*input_.scene, *input_.mesh, matrix);
    input_.factors = std::move(factors);
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
    std::shared_ptr<const FormFactors> found;
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
    show_factors(std::move(found));
    relighter_.emplace(input_, wake_);
    relighter_->ask(of_materials());
}

void Document::take_light() {
    std::optional<SolveUpdate> update = relighter_->take();
    work_.waits = relighter_->waits();
    if (!update) {
        return;
    }
    work_.residuals = relighter_->residuals();
    const Solution& solution = update->solution;
    const std::string steps =
        std::string(solution.method == SolverMethod::conjugate_gradient ? "iteration" : "sweep") +
        (solution.sweeps == 1 ? "" : "s");
    if (!update->problem.empty()) {
        work_.light = "no solution: " + update->problem;
        changed_ = true;
        return;
    }
    work_.light = update->converged
                      ? fmt::format("solved in {:.2f} s: {} {} to {:.1e}", solution.seconds, solution.sweeps,
                                    steps, solution.residual)
                      : fmt::format("sweep {}: residual {:.1e}", solution.sweeps, solution.residual);
    light_.reflectance = update->light.reflectance;
    light_.exitance = update->light.exitance;
    light_.environment = update->light.environment;
    input_.solution.error = solution.error;
    input_.solution.patch_size_error.reset(); // it was of another light
    if (update->heat && update->heat != heat_) {
        const std::string problem_before = heat_ ? heat_->problem : "";
        heat_ = update->heat;
        input_.solution.temperature = heat_->solution.temperature;
        input_.solution.net_flux = heat_->solution.net_flux;
        if (!heat_->problem.empty() && heat_->problem != problem_before && input_.observer) {
            input_.observer->warning(fmt::format("no temperatures: {}", heat_->problem), "");
        }
    }
    show_light(update->light.radiosity, update->converged ? State::solved : State::converging,
               update->light.vertices);
    solved_.reset();
    if (update->converged) {
        solved_ = std::move(update);
    }
}

bool Document::busy() const {
    return finder_ || finding_search_ || (input_.refiner && input_.refiner->busy()) ||
           (relighter_ && relighter_->busy());
}

void Document::cancel() {
    if (finder_) {
        finder_->cancel();
    }
    if (input_.refiner) {
        input_.refiner->cancel();
    }
}

Light Document::of_materials() const {
    Light light{patch_values(*input_.mesh, wanted_.materials, &Material::reflectance),
                patch_values(*input_.mesh, wanted_.materials, &Material::exitance),
                {},
                {},
                {},
                wanted_.conditions,
                wanted_.environment};
    if (input_.heat) {
        radiate_by_conditions(input_, light);
    }
    return light;
}

void Document::set_materials(const MaterialHistory::State& wanted) {
    if (wanted == wanted_ || !relighter_) {
        return;
    }
    wanted_ = wanted;
    relighter_->ask(of_materials());
}

void Document::start_over() {
    if (!relighter_) {
        return;
    }
    Light wanted = of_materials();
    light_.reflectance = wanted.reflectance;
    light_.exitance = wanted.exitance;
    light_.environment = wanted.environment;
    relighter_->ask(std::move(wanted), true);
    work_.residuals.clear();
    work_.waits = true;
    work_.light = "the lamps alone: no sweep yet";
    solved_.reset();
    input_.solution.error.reset();
    input_.solution.patch_size_error.reset();
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

const char* Document::unsavable_reason() const {
    if (!input_.factor_settings) {
        return "a stored solution is stored already";
    }
    if (has_other_temperatures()) {
        return "temperatures are no longer those of the scene, whose materials a result holds";
    }
    return solved_ ? nullptr : "the light is not solved yet";
}

Lit Document::lit(bool irradiance) const {
    Lit lit{*input_.scene, input_.solution};
    lit.scene.materials = wanted_.materials;
    lit.scene.environment = light_.environment;
    lit.solution.radiosity = light_.radiosity;
    lit.solution.exitance = light_.exitance;
    lit.solution.vertex_radiosity = light_.vertices;
    if (irradiance && input_.factors != nullptr) {
        lit.solution.irradiance =
            hemi::irradiance({&input_.factors->matrix, input_.channels(), light_.reflectance, light_.exitance,
                              lit.scene.environment, input_.mesh->areas(), lit.solution.direct},
                             light_.radiosity);
    }
    return lit;
}

void Document::save_result(const std::filesystem::path& path) {
    if (const char* reason = unsavable_reason()) {
        throw InvalidArgument(fmt::format("saving the result: {}", reason));
    }
    auto [scene, solution] = lit(true);
    const Solution& found = solved_->solution;
    solution.method = found.method;
    solution.sweeps = found.sweeps;
    solution.residual = found.residual;
    solution.error = found.error;
    io::write_hres(path, {std::move(scene), input_.subdivision, std::move(solution), input_.surfaces_as_read,
                          input_.parts});
}

} // namespace hemi::viewer
