#include "pipeline/answers.hpp"

#include "hemi/core/text.hpp"
#include "hemi/pipeline/coarse_mesh.hpp"
#include "hemi/pipeline/cost.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/pipeline/refinement.hpp"
#include "hemi/pipeline/vertex_gather.hpp"
#include "pipeline/cut_mesh.hpp"
#include "pipeline/failure.hpp"
#include "pipeline/patch_locator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <string>

namespace hemi {

namespace {

// Shares of the budget: for the reference at most, for one solution on uniform patches (the second for the
// exact preset), for one refinement, for all solutions together, and for what else is measured.
constexpr double reference_share = 0.35;
constexpr double solution_share = 0.25;
constexpr double exact_solution_share = 0.1;
constexpr double refinement_share = 0.15;
constexpr double solutions_share = 0.45;
constexpr double others_share = 0.15;

constexpr std::uint32_t least_patches = 100; // of coarser meshes: fewer are of no use to anybody
constexpr int most_coarser = 3;
constexpr int most_finer = 2;
// A mesh of another size is worth a try where it has so many times the patches.
constexpr double least_growth = 1.5;

// How the time of a solution grows with the number of patches, N to this power: rows take between N and N²,
// pairs N²; presets give the fewer patches more sample points.
constexpr double least_growth_of_time = 1.0;
constexpr double most_growth_of_time = 1.8;
constexpr double usual_growth_of_time = 1.2;
constexpr double reference_over_standard = 0.8;
constexpr double reference_point_over_vertex = 1.5;
constexpr double bytes_a_pair = 4.0;
constexpr double bytes_an_entry = 9.0;

// On the scene's own patches; of these the first ones on others, where they tell enough.
constexpr std::array<Preset, 3> presets{Preset::fast, Preset::standard, Preset::exact};
constexpr std::size_t presets_on_other_patches = 2;
constexpr std::array<double, 4> error_targets{0.04, 0.02, 0.01, 0.005};

/// Of a preset's time to that of the standard one, about: only where it was not measured yet.
double relative_cost(Preset preset) {
    return preset == Preset::exact ? 3.0 : preset == Preset::standard ? 1.0 : 0.6;
}

/// Below this number of patches the time hardly depends on it: presets take more sample points for fewer, and
/// there are threads to start.
double at_least_few(double patches) {
    constexpr double few = 400.0;
    return std::max(patches, few);
}

/// To three digits, as a person would write it: the number that is read from these.
double rounded(double value) {
    const std::string text = fmt::format("{:.3g}", value);
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

bool is_dark(const Scene& scene) {
    const auto shines = [](const std::vector<double>& values) {
        return std::any_of(values.begin(), values.end(), [](double value) { return value > 0.0; });
    };
    return !shines(scene.environment) &&
           std::none_of(scene.materials.begin(), scene.materials.end(),
                        [&](const Material& material) { return shines(material.exitance); });
}

const std::string own_label = "solutions on the scene's own patches";

std::string size_label(double patch_size) {
    return fmt::format("patches of {:g}", patch_size);
}

} // namespace

Answers::Answers(const Subject& subject, double budget, Observer& observer)
    : subject_(subject), budget_(budget), observer_(observer) {
    if (subject.subdivision.patch_size) {
        own_patch_size_ = *subject.subdivision.patch_size;
    } else if (subject.scene.patch_size && !subject.subdivision.patches_per_face) {
        own_patch_size_ = *subject.scene.patch_size;
    } else {
        own_patch_size_ = rounded(mean_patch_size(subject.mesh));
    }
}

std::string Answers::obstacle() const {
    if (subject_.scene.sun || subject_.scene.sky) {
        return "light of sun and sky has no reference to be compared with";
    }
    if (is_dark(subject_.scene)) {
        return "nothing in the scene gives light";
    }
    if (reflecting_patches(subject_.scene, subject_.mesh).empty()) {
        return "nothing in the scene reflects light";
    }
    return "";
}

double Answers::predicted(Preset preset, double patches) const {
    const auto own = timed_.find(preset);
    if (own == timed_.end() && timed_.empty()) {
        return 0.0;
    }
    const auto& [known, times] = own != timed_.end() ? *own : *timed_.begin();
    const Timed& last = times.back();
    double growth = usual_growth_of_time;
    if (times.size() > 1) {
        const Timed& before = times[times.size() - 2];
        const double ratio = at_least_few(last.patches) / at_least_few(before.patches);
        if (ratio > least_growth) {
            growth = std::clamp(std::log(last.seconds / before.seconds) / std::log(ratio),
                                least_growth_of_time, most_growth_of_time);
        }
    }
    return last.seconds * relative_cost(preset) / relative_cost(known) *
           std::pow(at_least_few(patches) / at_least_few(last.patches), growth);
}

double Answers::reference_seconds(double patches) const {
    return reference_over_standard * predicted(Preset::standard, patches) +
           reference_point_over_vertex * seconds_a_vertex_ * reference_points();
}

double Answers::reference_seconds() {
    return solved_.empty() ? 0.0 : reference_seconds(reference_mesh().size());
}

std::uint32_t Answers::reference_points() const {
    constexpr double points_a_second = 40.0; // of the budget
    constexpr double least_points = 512.0;
    constexpr double most_points = 4096.0;
    return static_cast<std::uint32_t>(std::clamp(points_a_second * budget_, least_points, most_points));
}

bool Answers::fits_memory(double patches) const {
    return patches * patches * (bytes_a_pair + bytes_an_entry * entries_a_pair_) <
           static_cast<double>(memory_limit(subject_.base));
}

Answers::Limit Answers::limit_of_judging(double patches) const {
    return !fits_memory(2.0 * patches)                                    ? Limit::reference_memory
           : reference_seconds(2.0 * patches) > reference_share * budget_ ? Limit::reference_time
                                                                          : Limit::none;
}

std::string Answers::text(Limit limit) {
    switch (limit) {
    case Limit::solution_time:
        return "a solution would take too long";
    case Limit::reference_time:
        return "a finer reference would take too long";
    case Limit::reference_memory:
        return "a finer reference does not fit into the memory";
    default:
        return "";
    }
}

std::vector<std::pair<double, PatchMesh>> Answers::coarser_meshes() const {
    std::vector<std::pair<double, PatchMesh>> meshes;
    double next = subject_.mesh.size();
    double size = own_patch_size_;
    for (int k = 0; k < most_coarser; ++k) {
        size *= 2.0;
        PatchMesh mesh = cut_mesh(subject_.scene, {size, {}, {}}, subject_.with_imprint);
        if (mesh.size() < least_patches || least_growth * mesh.size() > next) {
            break;
        }
        next = mesh.size();
        meshes.emplace_back(size, std::move(mesh));
    }
    std::reverse(meshes.begin(), meshes.end());
    return meshes;
}

std::vector<Preset> Answers::affordable(const PatchMesh& mesh, bool own) {
    const double patches = mesh.size();
    if (timed_.empty()) { // rows alone, which is most of it
        FactorSettings settings = subject_.base;
        settings.preset = Preset::standard;
        timed_[Preset::standard] = {{mesh.size(), measure_cost(mesh, settings).seconds}};
    }
    std::vector<Preset> result;
    limit_ = limit_of_judging(patches);
    if (limit_ != Limit::none) {
        return result;
    }
    double seconds = watch_.seconds();
    for (const Preset preset : std::span(presets).first(own ? presets.size() : presets_on_other_patches)) {
        const double more = predicted(preset, patches);
        const double share = preset == Preset::exact ? exact_solution_share : solution_share;
        if (more <= share * budget_ && seconds + more <= solutions_share * budget_) {
            result.push_back(preset);
            seconds += more;
        }
    }
    limit_ = result.empty() ? Limit::solution_time : Limit::none;
    return result;
}

bool Answers::solve_size(double patch_size, const PatchMesh& mesh, const std::vector<Preset>& affordable) {
    Reference rows;
    if (const auto why = failure(
            [&] { rows = find_reference(mesh, all_patches(mesh.size()), subject_.base, 0.0, observer_); })) {
        omit(size_label(patch_size), *why);
        return false;
    }
    const std::size_t before = solved_.size();
    for (const Preset preset : affordable) {
        Candidate candidate = hemicube_candidate(subject_.base, preset, mesh.size());
        candidate.settings.estimate_error = false;
        const std::string label = size_label(patch_size) + ", " + candidate.label();
        observer_.detail(label);
        const Stopwatch watch;
        FormFactors factors;
        if (const auto why = failure([&] {
                factors = compute_form_factors(subject_.scene, mesh, candidate.settings, observer_);
            })) {
            omit(label, *why);
            continue;
        }
        const double seconds = watch.seconds();
        add(candidate, patch_size, mesh, factors, seconds,
            estimate_factor_error(factors.matrix, rows.rows).row_rms);
    }
    return solved_.size() > before;
}

void Answers::solve_uniform(const TryOwn& try_own) {
    const auto note_finest = [this](double size, std::uint32_t patches) {
        finest_size_ = size;
        finest_patches_ = patches;
    };
    for (const auto& [size, mesh] : coarser_meshes()) {
        const auto chosen = affordable(mesh, false);
        if (chosen.empty()) {
            omit(size_label(size), text(limit_));
            return;
        }
        if (solve_size(size, mesh, chosen)) {
            note_finest(size, mesh.size());
        }
    }
    const auto chosen = affordable(subject_.mesh, true);
    if (chosen.empty()) {
        omit(own_label, text(limit_));
        return;
    }
    judges_own_ = true;
    note_finest(own_patch_size_, subject_.mesh.size());
    std::for_each(chosen.begin(), chosen.end(), try_own);
    double size = own_patch_size_;
    for (int k = 0; k < most_finer; ++k) {
        size *= 0.5;
        const PatchMesh mesh = cut_mesh(subject_.scene, {size, {}, {}}, subject_.with_imprint);
        const auto finer = affordable(mesh, false);
        if (finer.empty()) {
            limit_ = Limit::none; // what is left out there needs no reason
            return;
        }
        if (solve_size(size, mesh, finer)) {
            note_finest(size, mesh.size());
        }
    }
}

void Answers::add_own(const Candidate& candidate, const FormFactors& factors, double seconds,
                      double row_error) {
    // Shadow rays alone change much less than the size of the patches does.
    if (judges_own_ && !candidate.settings.shadow_rays) {
        add(candidate, {}, subject_.mesh, factors, seconds, row_error);
    }
}

void Answers::add(const Candidate& candidate, std::optional<double> patch_size, const PatchMesh& mesh,
                  const FormFactors& factors, double seconds, double row_error) {
    const Stopwatch watch;
    Solution solution;
    double seconds_of_gather = 0.0;
    // Rows may sum up to more than 1 where nothing closes them, and then no solution is found.
    if (const auto why = failure([&] {
            solution = solve_radiosity(subject_.scene, mesh, factors, {}, observer_, false);
            const Stopwatch gather_watch;
            gather_at_vertices(subject_.scene, mesh, candidate.settings, Gather::automatic, solution,
                               observer_);
            seconds_of_gather = gather_watch.seconds();
        })) {
        omit((patch_size ? size_label(*patch_size) : own_label) + ", " + candidate.label(), *why);
        return;
    }
    seconds += watch.seconds();
    if (!solution.vertex_radiosity.empty()) {
        const VertexGather gathered(mesh, solution.back_face_share, reflecting_patches(subject_.scene, mesh));
        seconds_a_vertex_ = seconds_of_gather / at_least_few(static_cast<double>(gathered.points().size()));
    }
    Trade::Answer answer;
    answer.candidate = candidate;
    answer.patch_size = patch_size;
    answer.patches = mesh.size();
    answer.seconds = seconds;
    answer.memory = pair_table_bytes(candidate, mesh.size(), mesh.size()) + factors.matrix.memory_bytes();
    answer.gathered = !solution.vertex_radiosity.empty();
    answer.row_error = row_error;
    if (candidate.is_preset()) {
        auto& times = timed_[candidate.settings.preset];
        if (!times.empty() && times.back().patches == mesh.size()) { // what was only a guess
            times.pop_back();
        }
        times.push_back({mesh.size(), answer.seconds});
        entries_a_pair_ = static_cast<double>(factors.matrix.entries()) / mesh.size() / mesh.size();
    }
    solved_.push_back({std::move(answer), mesh, std::move(solution)});
}

void Answers::refine() {
    if (solved_.empty()) {
        return;
    }
    Candidate candidate =
        hemicube_candidate(subject_.base, Preset::standard, static_cast<std::uint32_t>(finest_patches_));
    candidate.settings.estimate_error = true;
    std::optional<PatchMesh> coarse;
    double last = 0.0;
    double reached = 1.0;
    for (const double target : error_targets) {
        if (reached <= target) { // the same patches would do
            continue;
        }
        const std::string label = fmt::format("patches refined to {:g} %", 100.0 * target);
        const double limit = std::min(refinement_share * budget_, (1.0 - others_share) * budget_ -
                                                                      reference_seconds() - watch_.seconds());
        if (2.0 * last > limit) {
            omit(label, "there was no time for it");
            return;
        }
        RefinementGoal goal;
        goal.error = target;
        goal.seconds = limit;
        observer_.detail(label);
        const Stopwatch watch;
        std::optional<Refinement> found;
        if (const auto why = failure([&] {
                if (!coarse) {
                    coarse = coarse_mesh(subject_.scene, subject_.with_imprint).mesh;
                }
                found =
                    solve_refined(subject_.scene, *coarse, candidate.settings, {}, goal, false, observer_);
            })) {
            omit(label, *why);
            return;
        }
        last = watch.seconds();
        if (!found->stopped.empty()) {
            omit(label, found->stopped);
            return;
        }
        reached = found->steps.back().error;
        Trade::Answer answer;
        answer.candidate = candidate;
        answer.error_target = target;
        answer.patches = found->mesh.size();
        answer.seconds = last;
        const std::size_t fresh = found->steps.back().rows;
        // The matrix before a step and after it, or raw and prepared.
        answer.memory =
            pair_table_bytes(candidate, answer.patches, fresh) + 2 * found->factors.matrix.memory_bytes();
        answer.gathered = !found->solution.vertex_radiosity.empty();
        answer.row_error = found->factors.error ? found->factors.error->row_rms : 0.0;
        solved_.push_back({std::move(answer), std::move(found->mesh), std::move(found->solution)});
    }
}

const PatchMesh& Answers::reference_mesh() {
    if (!reference_mesh_) {
        // Half the size of the finest patches where there is time for it, else half their area.
        PatchMesh half = cut_mesh(subject_.scene, {0.5 * finest_size_, {}, {}}, subject_.with_imprint);
        const bool too_fine =
            reference_seconds(half.size()) > reference_share * budget_ || !fits_memory(half.size());
        reference_mesh_ = too_fine ? cut_mesh(subject_.scene, {std::sqrt(0.5) * finest_size_, {}, {}},
                                              subject_.with_imprint)
                                   : std::move(half);
    }
    // Nowhere coarser than any of them.
    constexpr double rounding = 1.01;
    for (; not_finer_ < solved_.size(); ++not_finer_) {
        const Solved& solved = solved_[not_finer_];
        for (bool coarser = true; coarser;) {
            const PatchLocator locator(*reference_mesh_);
            std::vector<std::uint32_t> split;
            for (std::uint32_t i = 0; i < solved.mesh.size(); ++i) {
                const auto patch = locator.find({solved.mesh.centres()[i], solved.mesh.normal(i), 0});
                if (patch && reference_mesh_->areas()[*patch] > rounding * solved.mesh.areas()[i]) {
                    split.push_back(*patch);
                }
            }
            std::sort(split.begin(), split.end());
            split.erase(std::unique(split.begin(), split.end()), split.end());
            coarser = !split.empty();
            if (coarser) {
                reference_mesh_ = reference_mesh_->split(split, Cut::by_shape).mesh;
            }
        }
    }
    return *reference_mesh_;
}

void Answers::judge(Trade& trade) {
    if (solved_.empty()) {
        trade.unanswered = limit_ == Limit::reference_memory
                               ? "there was no memory for a reference: give more with --max-memory"
                           : limit_ == Limit::none
                               ? "no solution was found"
                               : "there was no time for a reference: give more with --budget";
    } else {
        const Solved* finest = &solved_.front();
        for (const Solved& solved : solved_) {
            finest =
                !solved.answer.error_target && solved.mesh.size() > finest->mesh.size() ? &solved : finest;
        }
        RadiosityReference reference;
        if (const auto why = failure([&] {
                reference = find_radiosity_reference(subject_.scene, reference_mesh(), finest->mesh,
                                                     subject_.base, reference_points(), observer_);
            })) {
            trade.unanswered = "no reference was found: " + *why;
        } else {
            judge_by(std::move(reference), trade);
        }
    }
    trade.omitted.insert(trade.omitted.end(), omitted_.begin(), omitted_.end());
}

void Answers::judge_by(RadiosityReference reference, Trade& trade) {
    if (std::none_of(reference.reflected.begin(), reference.reflected.end(),
                     [](double light) { return light > 0.0; })) {
        trade.unanswered = "no light comes to what reflects it";
        return;
    }
    for (Solved& solved : solved_) {
        Trade::Answer& answer = solved.answer;
        const auto error = answer.patches < reference.patches
                               ? judge_radiosity(solved.mesh, solved.solution, reference)
                               : std::nullopt;
        const std::string label =
            plural(answer.patches, "patch", "patches") + ", " + answer.candidate.label();
        if (!error) {
            omit(label, answer.patches < reference.patches ? "its patches have no lit point of the reference"
                                                           : "there was no time for a finer reference");
            continue;
        }
        answer.error = *error;
        observer_.detail(fmt::format("{}: {:.2g} %, standard error {:.2g} %", label,
                                     100.0 * error->vertices.rms, 100.0 * error->vertices.doubt));
        trade.answers.push_back(std::move(answer));
    }
    if (trade.answers.empty()) {
        trade.unanswered = "the reference can judge no solution, see below";
        return;
    }
    trade.answer_reference = std::move(reference);
}

} // namespace hemi
