#include "hemi/pipeline/refinement.hpp"

#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/row_memory.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/display/vertex_colours.hpp"
#include "hemi/engine/touching_faces.hpp"
#include "hemi/pipeline/patch_size_error.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "matrix/split_rows.hpp"
#include "pipeline/corner_interpolation.hpp"
#include "pipeline/group_importance.hpp"
#include "pipeline/image_count.hpp"
#include "pipeline/known_corners.hpp"
#include "pipeline/patch_splits.hpp"
#include "pipeline/vertex_bends.hpp"
#include "pipeline/visible_radiosity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>
#include <utility>

namespace hemi {

namespace {

/// Of the square of a patch's error, what its parts together still have: a smooth field's 1/16, the half that
/// is left along the edge of a shadow, and what is taken before a step has shown it.
constexpr double least_left_by_parts = 1.0 / 16.0;
constexpr double most_left_by_parts = 0.5;
constexpr double usually_left_by_parts = 0.25;
/// A step adds at least and at most such shares of the patches: fewer are not worth a step's solution and
/// estimate, more would follow an estimate from a mesh that is too coarse to see where the error is. It aims
/// a little below the goal, since estimates scatter.
struct Pace {
    double least;
    double most;
    double aim;
    double share; ///< of the error's square, whose patches are enough for a step
};
constexpr Pace by_samples{3.0 / 16.0, 1.0, 0.9, 1.0};
/// Where gathered vertices show where the error is: they cost less and scatter less.
constexpr Pace by_bends{0.1, 0.55, 0.97, 0.8};
/// Square of the error over that of the bends until a sample says it, at the end: there samples of rooms have
/// said 1.6 to 2.5, more than the square_error_of_bend of smooth light.
constexpr double usual_square_of_bend = 2.0;
/// Vertices that are not new are gathered again when the mesh has so many times more patches than when they
/// last were, and for the last mesh: they show too old a light.
constexpr double gather_again = 3.0;
/// Times the usual sample of patches for estimates near the goal and of the last mesh: refinement stops where
/// they say so, and would stop too early by a lucky one.
constexpr double effort_near_goal = 2.0;
/// While the error is so many times the goal, the next step does not come near it: a usual sample will do.
constexpr double far_from_goal = 2.0;
/// Steps after which a smaller error is looked for in vain may be the last; their estimates must be good.
constexpr std::size_t steps_of_small_samples = 3;
/// Patches are not cut into more than this share of the scene's diagonal: two surfaces that touch have
/// singular light there, at any size.
constexpr double least_size = 1e-3;
/// Bytes a pair of a new row and a patch while visibilities are combined, and an entry of a matrix.
constexpr double pair_bytes = 4.0;
constexpr double entry_bytes = 9.0;

/// Of the patches to the square of an error: of the vertices where that is the goal, else of the field.
struct Contributions {
    std::vector<double> parts;           ///< area times squared error, relative to what is reflected
    std::vector<std::uint32_t> channels; ///< where that is largest, which these are of
};
/// @param bends  see vertex_bends(); empty: not known
Contributions contributions(const PatchMesh& mesh, const Solution& solution, ErrorOf error_of,
                            std::span<const double> bends) {
    const std::uint32_t channels = solution.channels;
    std::vector<double> reflected(channels, 0.0);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        for (std::uint32_t c = 0; c < channels; ++c) {
            const std::size_t at = std::size_t{i} * channels + c;
            reflected[c] += mesh.areas()[i] * std::pow(solution.radiosity[at] - solution.exitance[at], 2.0);
        }
    }
    std::optional<CornerInterpolation> corners;
    if (bends.empty() && error_of != ErrorOf::vertices) {
        corners.emplace(mesh, corner_values(mesh, channels, solution.radiosity, solution.back_face_share),
                        channels);
    }
    Contributions result{std::vector<double>(mesh.size(), 0.0), std::vector<std::uint32_t>(mesh.size(), 0)};
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (solution.back_face_share[i] > buried_above) {
            continue;
        }
        for (std::uint32_t c = 0; c < channels; ++c) {
            const std::size_t at = std::size_t{i} * channels + c;
            const double square = !bends.empty() ? bends[at] * bends[at]
                                  : corners      ? corners->square(i, solution, c)
                                                 : std::pow(solution.patch_size_error->patches[at], 2.0);
            const double part = reflected[c] > 0.0 ? mesh.areas()[i] * square / reflected[c] : 0.0;
            if (part > result.parts[i]) {
                result.parts[i] = part;
                result.channels[i] = c;
            }
        }
    }
    return result;
}

/// Of the patch-size part of the goal's error and of all of it; not numbers where they are not known.
struct Errors {
    double patch_size = std::numeric_limits<double>::quiet_NaN();
    double all = std::numeric_limits<double>::quiet_NaN();
};
/// Of groups, the one that errs most counts.
Errors errors_of(const Solution& solution, ErrorOf error_of) {
    const PatchSizeError& of_size = *solution.patch_size_error;
    const std::optional<SolutionError> total = solution_error(solution);
    if (error_of == ErrorOf::field) {
        return {of_size.field.rms, total ? total->field.rms : of_size.field.rms};
    }
    if (error_of == ErrorOf::vertices) {
        return {of_size.vertices.rms, total ? total->vertices.rms : of_size.vertices.rms};
    }
    Errors worst;
    for (std::size_t g = 0; g < of_size.groups.size(); ++g) {
        const double of_group = of_size.groups[g].patch_size;
        const double all = total ? total->groups[g] : of_group;
        if (std::isfinite(all) && !(all <= worst.all)) {
            worst = {of_group, all};
        }
    }
    return worst;
}

class Refiner {
public:
    Refiner(const Scene& scene, const PatchMesh& coarse, const FactorSettings& settings,
            const SolverSettings& solver, const RefinementGoal& goal, bool with_irradiance,
            Observer& observer, RefinementRows rows)
        : scene_(scene), settings_(settings), solver_(solver), goal_(goal), with_irradiance_(with_irradiance),
          observer_(observer), rows_(std::move(rows)), result_{coarse, {}, {}, {}, {}, {}} {
        settings_.estimate_error = false; // of the rows, until the mesh is the last one
    }

    Refinement run() {
        Refinement::Step step = begin();
        for (;;) {
            solve();
            Errors errors = estimate(false);
            step.error = errors.all;
            result_.steps.push_back(step);
            observer_.detail(fmt::format("refinement: {}, error {:.2g} %",
                                         plural(step.patches, "patch", "patches"), 100.0 * step.error));
            observer_.refined(result_);
            const bool may_end = is_enough(errors) || !may_go_on() || !form_factors_allow(errors);
            if (may_end) {
                errors = finish();
                if (!goal_.error || is_met(errors) || !may_go_on() || !can_help(errors)) {
                    return end(errors);
                }
            }
            const std::vector<PatchSplit> chosen = choose(errors);
            if (chosen.empty()) {
                result_.stopped = fmt::format("no patch is left that is larger than {:.2g}",
                                              least_size * result_.mesh.bounds().diagonal());
            } else {
                step = split(chosen);
            }
            if (!result_.stopped.empty()) {
                return end(may_end ? errors : finish());
            }
        }
    }

private:
    static constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

    [[nodiscard]] const Pace& pace() const { return bends_.empty() ? by_samples : by_bends; }

    [[nodiscard]] bool is_met(const Errors& errors) const {
        return goal_.error && errors.all <= *goal_.error;
    }

    /// @param errors  as finish() found them
    Refinement end(const Errors& errors) {
        if (is_met(errors)) {
            result_.stopped.clear(); // whatever ended it
        }
        if (!goal_.error && result_.steps.size() == 1 && result_.mesh.size() > goal_.patches) {
            observer_.note(fmt::format("the mesh has {} already, more than {}",
                                       plural(result_.mesh.size(), "patch", "patches"), goal_.patches));
        }
        return std::move(result_);
    }

    /// Whether the errors of a step are small enough to make sure of them by finish(), which takes a while.
    [[nodiscard]] bool is_enough(const Errors& errors) const {
        if (goal_.error) {
            return errors.all <= (bends_.empty() ? 1.0 : pace().aim) * *goal_.error;
        }
        return result_.mesh.size() >= goal_.patches;
    }

    Refinement::Step begin() {
        if (!rows_.begin) {
            result_.raw = compute(result_.mesh, all_patches(result_.mesh.size()));
            keep();
            return {result_.mesh.size(), result_.mesh.size(), not_known};
        }
        result_.raw = *std::exchange(rows_.begin, std::nullopt);
        if (result_.raw.cuts.any()) {
            result_.mesh = result_.mesh.cut(result_.raw.cuts);
        }
        if (result_.raw.geometry_hash != result_.mesh.geometry_hash() || !result_.raw.matrix.all_known()) {
            throw InvalidArgument("refinement: rows to begin with must be those of all patches of the "
                                  "coarse mesh, or of one that was cut from it");
        }
        return {result_.mesh.size(), 0, not_known};
    }

    [[nodiscard]] FormFactors compute(const PatchMesh& mesh, std::span<const std::uint32_t> patches) {
        return compute_raw_form_factors(scene_, mesh, patches, settings_, observer_, rows_.checkpoint);
    }

    /// Stores the rows of a step, which are complete.
    void keep() {
        result_.raw.cuts = result_.mesh.cuts();
        if (rows_.store) {
            rows_.store(result_.mesh, result_.raw);
        }
        if (rows_.checkpoint != nullptr) { // whose rows are not lost before they are stored
            rows_.checkpoint->start_over();
        }
    }

    /// Whether limits allow another step; says why not.
    bool may_go_on() {
        if (goal_.error && goal_.patches > 0 && result_.mesh.size() >= goal_.patches) {
            const std::string patches = plural(result_.mesh.size(), "patch", "patches");
            result_.stopped = result_.steps.size() > 1 ? patches + " are as many as were asked for"
                                                       : "the mesh has " + patches + " already";
        } else if (goal_.error && is_stuck()) {
            result_.stopped =
                "smaller patches no longer make the error smaller: what is left comes from the form "
                "factors, which a better preset would improve";
        } else if (goal_.seconds > 0.0 && watch_.seconds() > goal_.seconds) {
            result_.stopped = fmt::format("the {} of the budget are over", seconds_text(goal_.seconds));
        }
        return result_.stopped.empty();
    }

    /// Whether the form factors, as far as they were judged, allow the goal to be met; says so where not.
    bool form_factors_allow(const Errors& errors) {
        return !goal_.error || !first_judged_ || can_help(errors);
    }

    /// Whether smaller patches alone can meet the goal; says so where they cannot.
    bool can_help(const Errors& errors) {
        const double others =
            std::sqrt(std::max(0.0, errors.all * errors.all - errors.patch_size * errors.patch_size));
        if (others >= pace().aim * *goal_.error) {
            result_.stopped =
                fmt::format("{:.2g} % come from the form factors, which leaves too little for the "
                            "patches' size; a better preset would improve them",
                            100.0 * others);
        }
        return result_.stopped.empty();
    }

    /// Whether two steps, or as many small ones as make twice the patches, have not brought the error below
    /// nine tenths of what it was before.
    [[nodiscard]] bool is_stuck() const {
        const auto steps = std::span(result_.steps).subspan(first_judged_.value_or(0));
        if (steps.size() < 4) {
            return false;
        }
        const auto least = [](auto begin, auto end) {
            return std::min_element(begin, end,
                                    [](const auto& a, const auto& b) { return a.error < b.error; })
                ->error;
        };
        auto recent = steps.end() - 2;
        while (!bends_.empty() && recent != steps.begin() && 2 * recent->patches > steps.back().patches) {
            --recent;
        }
        return recent != steps.begin() && least(recent, steps.end()) > 0.9 * least(steps.begin(), recent);
    }

    void solve() {
        const Solution before = std::move(result_.solution);
        result_.factors = result_.raw;
        prepare_form_factors(result_.factors, settings_.repair, observer_);
        result_.solution =
            solve_radiosity(scene_, result_.mesh, result_.factors, solver_, observer_, with_irradiance_);
        known_ = known_corners(before, result_.solution, parents_);
        all_gathered_ = false;
    }

    /// @param last  with all vertices, if they are gathered, and the form factors' error
    Errors estimate(bool last) {
        const std::vector<Refinement::Step>& steps = result_.steps;
        // Without an error to be met no step but the last needs more; nor could one that goes on from stored
        // rows know how many steps there were.
        const bool far =
            !last && (!goal_.error || (steps.size() < steps_of_small_samples &&
                                       (steps.empty() || steps.back().error > far_from_goal * *goal_.error)));
        const bool gathers = should_gather(goal_.gather, settings_, result_.mesh, result_.solution);
        bends_.clear();
        if (gathers && goal_.error_of == ErrorOf::vertices) {
            return estimate_by_bends(last);
        }
        return estimate_by_sample(last, far ? 1.0 : effort_near_goal) ? errors_by_sample(last) : Errors{};
    }

    /// What the sample says; of the form factors' part, where it is not known, what was known last.
    Errors errors_by_sample(bool last) {
        Errors errors = errors_of(result_.solution, goal_.error_of);
        if (last || errors.all > errors.patch_size) { // stored better rows say it from the first step on
            const double others = errors.all * errors.all - errors.patch_size * errors.patch_size;
            others_ = std::sqrt(std::max(0.0, others));
            first_judged_ = first_judged_.value_or(last ? result_.steps.size() - 1 : result_.steps.size());
        } else {
            errors.all = std::hypot(errors.patch_size, others_);
        }
        return errors;
    }

    /// Gathers vertices, all or those that are new, and finds the bends between them.
    void find_bends() {
        Solution& solution = result_.solution;
        if (!all_gathered_) {
            // A run that goes on from stored rows knows no older light: `--refine` is to cut the same
            // patches.
            all_gathered_ = known_.values.empty() || rows_.checkpoint != nullptr ||
                            result_.mesh.size() > gather_again * static_cast<double>(patches_gathered_);
            gather_at_vertices(scene_, result_.mesh, settings_, Gather::on, solution, observer_,
                               all_gathered_ ? KnownCorners{} : std::move(known_));
            known_ = {};
            patches_gathered_ = all_gathered_ ? result_.mesh.size() : patches_gathered_;
        }
        bends_ =
            vertex_bends(result_.mesh, solution,
                         visible_radiosity(result_.mesh, SmoothSurfaces(result_.mesh),
                                           patches_near_surfaces(result_.mesh), solution.channels,
                                           solution.radiosity, solution.exitance, solution.back_face_share));
    }

    /// From how the radiosity bends between gathered vertices. For the last mesh by a sample, and for the
    /// first one where nothing bends, to know whether anything reflects light at all.
    Errors estimate_by_bends(bool last) {
        if (result_.steps.empty() && result_.solution.error) { // by stored better rows
            others_ = result_.solution.error->rms;
            first_judged_ = 0;
        }
        find_bends();
        double bend = rms_of_bends();
        const auto by_bend = [&] {
            const double error = std::sqrt(square_of_bend_) * bend;
            return Errors{error, std::hypot(error, others_)};
        };
        if (!all_gathered_ && is_enough(by_bend())) {
            find_bends(); // all: none is known any more
            bend = rms_of_bends();
        }
        if (!last && (bend > 0.0 || !result_.steps.empty())) {
            return by_bend();
        }
        if (!estimate_by_sample(last, effort_near_goal)) {
            return {};
        }
        const Errors errors = errors_by_sample(last);
        square_of_bend_ = bend > 0.0 ? std::pow(errors.patch_size / bend, 2.0) : square_of_bend_;
        if (bend == 0.0) {
            bends_.clear(); // which do not say what to cut
        }
        return errors;
    }

    /// Of all patches that reflect, relative to what is reflected, in the worst channel.
    [[nodiscard]] double rms_of_bends() const {
        const PatchMesh& mesh = result_.mesh;
        const Solution& solution = result_.solution;
        double worst = 0.0;
        for (std::uint32_t c = 0; c < solution.channels; ++c) {
            double bends = 0.0;
            double reflected = 0.0;
            for (const std::uint32_t i : reflecting_patches(scene_, mesh)) {
                if (solution.back_face_share[i] > buried_above) {
                    continue;
                }
                const std::size_t at = std::size_t{i} * solution.channels + c;
                bends += mesh.areas()[i] * bends_[at] * bends_[at];
                reflected += mesh.areas()[i] * std::pow(solution.radiosity[at] - solution.exitance[at], 2.0);
            }
            worst = reflected > 0.0 ? std::max(worst, bends / reflected) : worst;
        }
        return std::sqrt(worst);
    }

    /// What the estimate of the goal's error takes.
    [[nodiscard]] std::uint64_t bytes_to_estimate(const PatchMesh& mesh, double effort) const {
        return patch_size_error_bytes(mesh, {effort, goal_.error_of == ErrorOf::groups},
                                      result_.solution.channels);
    }

    /// @return whether the error of the goal is known; else it was said why not
    bool estimate_by_sample(bool last, double effort) {
        const PatchMesh& mesh = result_.mesh;
        FactorSettings settings = settings_;
        const std::uint64_t limit = memory_limit(settings_);
        settings.max_memory = limit; // the same for all of it
        effort = bytes_to_estimate(mesh, effort) > limit ? 1.0 : effort;
        const PatchSizeSample sample{effort, last || goal_.error_of == ErrorOf::groups};
        result_.solution.patch_size_error = estimate_patch_size_error(
            scene_, mesh, result_.factors, result_.solution, settings, observer_, sample);
        const bool is_estimated = result_.solution.patch_size_error.has_value();
        if (is_estimated && !std::isnan(errors_of(result_.solution, goal_.error_of).all)) {
            return true;
        }
        std::string why = "no light reaches anything that reflects light";
        if (const std::uint64_t bytes = bytes_to_estimate(mesh, effort); bytes > limit) {
            why = fmt::format("to estimate the error of {} takes about {} of memory",
                              plural(mesh.size(), "patch", "patches"), memory_text(bytes));
        } else if (is_estimated && mesh.groups().size() > GroupImportance::most_groups) {
            why = fmt::format("errors of at most {} groups can be estimated, and there are {}",
                              GroupImportance::most_groups, mesh.groups().size());
        } else if (is_estimated) {
            why = "no light reaches any group, or their errors could not be solved for (-v says more)";
        }
        if (result_.steps.empty()) { // nothing was found that could be lost
            throw InvalidArgument("patches cannot be cut where it tells: " + why,
                                  {!goal_.error   ? "refine"
                                   : is_estimated ? "error-target-of"
                                                  : "error-target"});
        }
        result_.stopped = std::move(why);
        return false;
    }

    /// Errors of the form factors and gathered vertices for the mesh as it is now. Where memory is short for
    /// them, the solution and what is known of its errors stay, and Refinement::stopped says so.
    Errors finish() {
        const std::optional<PatchSizeError> known = result_.solution.patch_size_error;
        try {
            return try_to_finish();
        } catch (const OutOfMemory& error) {
            result_.stopped = error.what();
        } catch (const std::bad_alloc&) {
            result_.stopped = "memory is short to find the errors of the form factors";
        }
        result_.solution.patch_size_error = known;
        return {};
    }
    Errors try_to_finish() {
        if (result_.raw.reference.entries() == 0) { // else they were stored
            add_reference_rows(result_.raw, result_.mesh, settings_, observer_,
                               reference_rows_of_cut_patches);
            estimate_error(result_.raw);
            keep();
        }
        result_.factors.reference = result_.raw.reference;
        estimate_error(result_.factors);
        Solution solution =
            solve_radiosity(scene_, result_.mesh, result_.factors, solver_, observer_, with_irradiance_);
        std::vector<float>& vertices = result_.solution.vertex_radiosity;
        if (all_gathered_ && !vertices.empty()) { // the light is the same
            solution.vertex_radiosity = std::move(vertices);
        } else {
            gather_at_vertices(scene_, result_.mesh, settings_, goal_.gather, solution, observer_);
        }
        result_.solution = std::move(solution);
        all_gathered_ = true;
        patches_gathered_ = result_.mesh.size();
        const Errors errors = estimate(true);
        if (!std::isnan(errors.all)) {
            result_.steps.back().error = errors.all;
        }
        return errors;
    }

    [[nodiscard]] PatchSplit how_to_split(const PatchSplits& ways, std::uint32_t patch,
                                          std::uint32_t channel) const {
        const Solution& solution = result_.solution;
        return bends_.empty() ? result_.mesh.split_by_shape(patch)
                              : ways.across_bend(patch, solution.vertex_radiosity, solution.channels, channel,
                                                 bends_[std::size_t{patch} * solution.channels + channel]);
    }

    /// A split of a patch, on both sides of its surface where it has two.
    struct Candidate {
        PatchSplit split;
        double part = 0.0;       ///< of the square of the error that the goal is for
        std::uint32_t added = 0; ///< patches
    };

    /// All that may be split, best first by what a new patch takes away.
    /// @param parts     contributions of all patches
    /// @param channels  where these are largest
    [[nodiscard]] std::vector<Candidate> candidates(const PatchSplits& ways, std::span<const double> parts,
                                                    std::span<const std::uint32_t> channels) const {
        const PatchMesh& mesh = result_.mesh;
        const double smallest = std::pow(least_size * mesh.bounds().diagonal(), 2.0);
        std::vector<Candidate> result;
        for (std::uint32_t front = 0; front < mesh.size(); ++front) {
            if (mesh.is_back(front) || mesh.areas()[front] <= smallest) {
                continue;
            }
            const std::uint32_t s = mesh.surface_of()[front];
            const bool two_sided = mesh.surfaces()[s].two_sided;
            const std::uint32_t back = two_sided ? front + mesh.patches_per_side(s) : front;
            const std::uint32_t patch = parts[back] > parts[front] ? back : front; // says how to cut
            if (!(parts[patch] > 0.0)) {
                continue;
            }
            const PatchSplit split = how_to_split(ways, patch, channels[patch]);
            const std::uint32_t added = split.along_u && split.along_v ? 3 : 1;
            result.push_back({split, two_sided ? parts[front] + parts[back] : parts[front],
                              two_sided ? 2 * added : added});
        }
        std::stable_sort(result.begin(), result.end(), [](const Candidate& a, const Candidate& b) {
            return a.part / a.added > b.part / b.added;
        });
        return result;
    }

    /// Patches that are to be split, ascending.
    [[nodiscard]] std::vector<PatchSplit> choose(const Errors& errors) {
        const PatchMesh& mesh = result_.mesh;
        auto [parts, channels] = contributions(mesh, result_.solution, goal_.error_of, bends_);
        const double left_by_parts = left_by(parts);
        const double total = std::accumulate(parts.begin(), parts.end(), 0.0);
        // What the error's other parts leave for the patches' size, of the square of what it is now.
        // Estimates scatter, and a finer mesh is no worse than a coarser one: the least so far says how far
        // it is.
        double wanted = 0.0;
        if (goal_.error && errors.patch_size > 0.0) {
            const double others = errors.all * errors.all - errors.patch_size * errors.patch_size;
            least_error_ = bends_.empty() ? std::min(least_error_, errors.patch_size) : errors.patch_size;
            wanted = std::max(0.0, std::pow(pace().aim * *goal_.error, 2.0) - std::max(0.0, others)) /
                     (least_error_ * least_error_);
        }
        const auto share = [&mesh](double of) {
            return static_cast<std::size_t>(std::ceil(of * mesh.size()));
        };
        std::size_t most = share(pace().most);
        if (goal_.patches > 0) {
            most = std::min<std::size_t>(most, std::max(goal_.patches, mesh.size()) - mesh.size());
        }
        double left = total;
        double not_chosen = total;
        std::size_t added = 0;
        std::vector<PatchSplit> chosen;
        const PatchSplits ways(mesh);
        for (const Candidate& candidate : candidates(ways, parts, channels)) {
            const bool enough =
                not_chosen <= (1.0 - pace().share) * total || (goal_.error && left <= wanted * total);
            if (added >= most || (added >= share(pace().least) && enough)) {
                break;
            }
            not_chosen -= candidate.part;
            left -= (1.0 - left_by_parts) * candidate.part;
            chosen.push_back(candidate.split);
            added += candidate.added;
        }
        ways.grade(chosen);
        contributions_ = std::move(parts);
        return chosen;
    }

    /// What the parts of the patches that the last step split have of those patches' contributions.
    /// @param parts  contributions of the patches as they are now
    [[nodiscard]] double left_by(std::span<const double> parts) const {
        std::vector<std::uint32_t> count(contributions_.size(), 0);
        for (const std::uint32_t parent : parents_) {
            ++count[parent];
        }
        double before = 0.0;
        for (std::size_t parent = 0; parent < count.size(); ++parent) {
            before += count[parent] > 1 ? contributions_[parent] : 0.0;
        }
        double after = 0.0;
        for (std::size_t k = 0; k < parents_.size(); ++k) {
            after += count[parents_[k]] > 1 ? parts[k] : 0.0;
        }
        return before > 0.0 ? std::clamp(after / before, least_left_by_parts, most_left_by_parts)
                            : usually_left_by_parts;
    }

    /// Splits patches and finds the rows of their parts. Where memory is short, nothing changes but
    /// Refinement::stopped.
    Refinement::Step split(const std::vector<PatchSplit>& chosen) {
        try {
            return try_split(chosen);
        } catch (const OutOfMemory& error) {
            result_.stopped = error.what();
        } catch (const std::bad_alloc&) {
            result_.stopped = "memory is short for more patches";
        } catch (const InvalidArgument& error) { // a surface cannot be cut any finer
            result_.stopped = error.what();
        }
        return {};
    }
    Refinement::Step try_split(const std::vector<PatchSplit>& chosen) {
        SplitMesh finer = result_.mesh.split(chosen);
        std::vector<std::uint32_t> parts(result_.mesh.size(), 0);
        for (const std::uint32_t parent : finer.parents) {
            ++parts[parent];
        }
        std::vector<std::uint32_t> fresh;
        for (std::uint32_t k = 0; k < finer.mesh.size(); ++k) {
            if (parts[finer.parents[k]] > 1) {
                fresh.push_back(k);
            }
        }
        const double growth = static_cast<double>(finer.mesh.size()) / result_.mesh.size();
        const auto before = static_cast<double>(result_.raw.matrix.entries());
        const double after = growth * growth * before;
        const double new_ones = after * static_cast<double>(fresh.size()) / finer.mesh.size();
        // Raw and prepared ones: of the finer mesh, or, while it is made, of this one, beside new rows.
        const double entries = std::max(2.0 * after, 2.0 * before + new_ones + after);
        const double held = settings_.max_memory ? 0.0 : 2.0 * before; // are not in what is free
        const double for_rows =
            pair_bytes * static_cast<double>(fresh.size() * image_count(finer.mesh)) * finer.mesh.size() +
            (rows_are_in_file() ? 0.0 : entry_bytes * (entries - held));
        const double bytes = std::max( // and the error of this mesh is to be known
            for_rows, static_cast<double>(bytes_to_estimate(finer.mesh, effort_near_goal)));
        if (bytes > static_cast<double>(memory_limit(settings_))) {
            result_.stopped =
                fmt::format("{} would need about {} of memory", plural(finer.mesh.size(), "patch", "patches"),
                            memory_text(static_cast<std::uint64_t>(bytes)));
            return {};
        }
        FormFactors rows = compute(finer.mesh, fresh);
        const bool both = rows.matrix.entries() > 0 && result_.raw.matrix.entries() > 0;
        if (both && rows.matrix.has_visibility() != result_.raw.matrix.has_visibility()) {
            result_.stopped = "memory is short for unoccluded factors of more patches";
            if (rows_.checkpoint != nullptr) { // of rows that are of no use
                rows_.checkpoint->start_over();
            }
            return {};
        }
        rows.matrix = split_rows(result_.raw.matrix, rows.matrix, finer.parents, finer.mesh.areas());
        rows.touching = find_touching_faces(rows.matrix, finer.mesh);
        rows.work.rows += result_.raw.work.rows;
        rows.work.hemicubes += result_.raw.work.hemicubes;
        rows.work.seconds += result_.raw.work.seconds;
        rows.work.reference_seconds += result_.raw.work.reference_seconds;
        result_.raw = std::move(rows);
        result_.mesh = std::move(finer.mesh);
        parents_ = std::move(finer.parents);
        keep();
        return {result_.mesh.size(), fresh.size(), not_known};
    }

    const Scene& scene_;
    FactorSettings settings_;
    const SolverSettings& solver_;
    RefinementGoal goal_;
    bool with_irradiance_;
    Observer& observer_;
    RefinementRows rows_;
    Stopwatch watch_;
    Refinement result_;
    KnownCorners known_;                           ///< from the step before
    bool all_gathered_ = false;                    ///< whether all vertices are of this step's light
    std::uint32_t patches_gathered_ = 0;           ///< when all were last
    std::vector<double> bends_;                    ///< of the mesh, see vertex_bends(); empty: not known
    double square_of_bend_ = usual_square_of_bend; ///< square of the error over that of the bends
    std::optional<std::size_t> first_judged_;      ///< step that better rows judged; those before know less
    double others_ = 0.0; ///< what the error had of other parts when it was known last
    double least_error_ = std::numeric_limits<double>::infinity(); ///< of the patches' size, so far
    std::vector<double> contributions_;  ///< of the patches that the last step began with
    std::vector<std::uint32_t> parents_; ///< of the patches as they are now, among those
};

} // namespace

Refinement solve_refined(const Scene& scene, const PatchMesh& coarse, const FactorSettings& settings,
                         const SolverSettings& solver, const RefinementGoal& goal, bool with_irradiance,
                         Observer& observer, RefinementRows rows) {
    if (goal.error_of == ErrorOf::factors || (!goal.error && goal.patches == 0)) {
        throw InvalidArgument("refinement: the goal must be an error that depends on the patches' size, or a "
                              "number of patches",
                              {"error-target"});
    }
    if (settings.method != Method::hemicube) {
        throw InvalidArgument("refinement: patches are split with hemicubes only", {"method"});
    }
    Refinement result =
        Refiner(scene, coarse, settings, solver, goal, with_irradiance, observer, std::move(rows)).run();
    if (!result.solution.error) { // of form factors that are none
        result.solution.patch_size_error.reset();
    }
    return result;
}

} // namespace hemi
