#include "cli/cluster_settings.hpp"
#include "cli/commands.hpp"
#include "cli/factor_source.hpp"
#include "cli/output_paths.hpp"
#include "cli/picture_output.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/seconds.hpp"
#include "cli/report/solution_report.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/accuracy.hpp"
#include "hemi/pipeline/cost.hpp"
#include "hemi/pipeline/light_balance.hpp"
#include "hemi/pipeline/patch_size_error.hpp"
#include "hemi/pipeline/vertex_gather.hpp"
#include "hemi/scene/light_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>

namespace hemi::cli {

namespace {

namespace fs = std::filesystem;

Outputs check_outputs(const SolveArguments& arguments) {
    Outputs outputs;
    add_picture_output(outputs, arguments.picture);
    const auto add = [&outputs](std::string_view option, const std::optional<fs::path>& path,
                                std::string_view extension, bool allow_standard_output) {
        if (path) {
            outputs.add(option, *path, {extension}, allow_standard_output);
        }
    };
    if (arguments.factors && (arguments.refines() || !has_rows(arguments))) { // else it is an input
        add("--factors", arguments.factors, ".hff", false);
    }
    add("--result", arguments.result, ".hres", false);
    add("--radiosity", arguments.radiosity, ".csv", true);
    add("--patches", arguments.patches, ".csv", true);
    outputs.refuse_with_json(arguments.common.json);
    return outputs;
}

/// What of `solve` keeps rows from being those of clusters.
std::optional<ClusterObstacle> cluster_obstacle(const SolveArguments& arguments) {
    if (arguments.refines() || arguments.rows.error_target) {
        return {{"--error-target and --refine", "which need the pairs of patches"}};
    }
    return obstacle_of_solver(arguments.solver);
}

void check_input(const SolveArguments& arguments) {
    refuse_chosen_settings(arguments.common, arguments.rows);
    if (arguments.rows.error_target && arguments.rows.error_of == ErrorOf::factors &&
        (arguments.refinement.patches > 0 || arguments.refinement.budget > 0.0 || arguments.parts)) {
        throw InvalidArgument(
            "--error-target-of factors cuts no patches: --refine, --budget and --parts do not "
            "apply");
    }
    if (arguments.parts && !arguments.refines() && !has_rows(arguments)) {
        throw InvalidArgument("--parts needs --error-target or --refine, by which patches are cut, or the "
                              "--factors of such patches");
    }
    if (arguments.rows.resume && arguments.rows.error_target && !arguments.refines()) {
        throw InvalidArgument("--resume excludes --error-target of factors, by which several settings are "
                              "tried; leave one out");
    }
    if (arguments.picture.quantity && is_error(*arguments.picture.quantity) &&
        !arguments.rows.factors.estimate_error) {
        throw InvalidArgument(fmt::format("--show {} needs the estimate that --no-estimate leaves out",
                                          to_word(*arguments.picture.quantity)));
    }
    check_budget(arguments.refinement, arguments.rows);
    if (arguments.rows.error_target && !arguments.refines() && has_rows(arguments)) {
        throw InvalidArgument(fmt::format("--error-target chooses settings, but the rows of {} are there "
                                          "already; leave one out",
                                          arguments.factors->string()));
    }
    if (!io::is_scene_file(arguments.scene.path)) {
        throw InvalidArgument(fmt::format("{}: solve needs a scene ({})", arguments.scene.path.string(),
                                          io::scene_extensions()));
    }
}

bool is_lit_from_outside(const Scene& scene) {
    return scene.sun || scene.sky ||
           std::any_of(scene.environment.begin(), scene.environment.end(),
                       [](double exitance) { return exitance > 0.0; });
}

/// Whether the light that reaches black patches is wanted: for tables, or since it comes from outside.
bool wants_irradiance(const SolveArguments& arguments, const Scene& scene) {
    return arguments.with_irradiance() || is_lit_from_outside(scene);
}

/// Where light comes from and is reflected; all where something is wanted of all.
std::vector<std::uint32_t> needed_patches(const SolveArguments& arguments, const LoadedScene& loaded) {
    if (arguments.factors || arguments.patches || wants_irradiance(arguments, loaded.scene)) {
        return all_patches(loaded.mesh.size());
    }
    return reflecting_patches(loaded.scene, loaded.mesh).empty()
               ? std::vector<std::uint32_t>()
               : shining_patches(patch_values(loaded.scene, loaded.mesh));
}

/// Form factors, prepared, and the radiosity by them.
struct Solved {
    FormFactors factors;
    Solution solution;
};

Solved solve(const SolveArguments& arguments, const LoadedScene& loaded, Observer& observer,
             const Terminal& terminal, Seconds& seconds) {
    const Stopwatch rows_watch;
    const std::vector<std::uint32_t> patches = needed_patches(arguments, loaded);
    FormFactors factors =
        with_checkpoint(arguments.factors, arguments.rows.resume, terminal, [&](RowCheckpoint* checkpoint) {
            return find_rows(arguments, loaded, patches, observer, terminal, checkpoint);
        });
    if (arguments.rows.factors.estimate_error) {
        add_missing_reference(factors, loaded.mesh, arguments.rows.factors, observer);
    }
    seconds["estimate"] = factors.work.reference_seconds;
    seconds["factors"] = rows_watch.seconds() - factors.work.reference_seconds;
    const Stopwatch repair_watch;
    prepare_form_factors(factors, arguments.rows.factors.repair, observer);
    seconds["repair"] = repair_watch.seconds();
    const Stopwatch solve_watch;
    Solution solution = solve_radiosity(loaded.scene, loaded.mesh, factors, arguments.solver, observer,
                                        wants_irradiance(arguments, loaded.scene));
    seconds["solve"] = solution.seconds;
    seconds["estimate"] += solve_watch.seconds() - solution.seconds;
    return {std::move(factors), std::move(solution)};
}

/// Whether the radiosity at vertices is asked for, or an output holds it.
bool gathers(const SolveArguments& arguments) {
    const bool is_drawn = arguments.picture.output && !arguments.picture.flat && !arguments.picture.quantity;
    return arguments.gather == Gather::on || arguments.result || is_drawn;
}

/// Rows of a file may be of another preset.
FactorSettings settings_to_gather(const SolveArguments& arguments, const FormFactors& factors) {
    FactorSettings settings = arguments.rows.factors;
    settings.method = factors.provenance.method;
    settings.preset = factors.provenance.preset.value_or(settings.preset);
    return settings;
}

/// What the work consists of.
std::vector<Phase> phases_of(const SolveArguments& arguments, const LoadedScene& loaded) {
    const FactorSettings& settings = arguments.rows.factors;
    const bool weighted =
        settings.method == Method::hemicube && plan_rows(settings, loaded.mesh.size()).weighted.has_value();
    std::vector<Phase> phases = factor_phases(loaded.mesh, settings);
    phases.push_back(Phase::radiosity);
    if (gathers(arguments) &&
        (arguments.gather == Gather::on ||
         (arguments.gather == Gather::automatic && weighted && settings.preset != Preset::fast))) {
        phases.push_back(Phase::gather);
    }
    if (settings.estimate_error) {
        phases.push_back(Phase::patch_size);
    }
    return phases;
}

Solved solve_to_target(const SolveArguments& arguments, const LoadedScene& loaded, Observer& observer,
                       const Terminal& terminal, Seconds& seconds) {
    TargetResult found = hemi::solve_to_target(
        loaded.scene, loaded.mesh, needed_patches(arguments, loaded), arguments.rows.factors,
        arguments.solver, *arguments.rows.error_target, observer, wants_irradiance(arguments, loaded.scene));
    store_rows(arguments, found.raw, terminal);
    seconds["search"] = found.search_seconds;
    seconds["factors"] = found.factor_seconds;
    seconds["solve"] = found.solution.seconds;
    return {std::move(found.factors), std::move(found.solution)};
}

/// Solves on patches that are cut until the result is good enough; the scene gets their mesh.
/// @param missed  becomes a sentence where it is not
Solved solve_on_finer_patches(const SolveArguments& arguments, LoadedScene& loaded, Observer& observer,
                              const Terminal& terminal, Seconds& seconds, Report& report,
                              std::string& missed) {
    const Stopwatch watch;
    const RefinementGoal goal = arguments.refinement.goal(
        arguments.rows, arguments.picture.flat && !gathers(arguments) ? Gather::off : arguments.gather);
    FactorSettings settings = arguments.rows.factors;
    CutMesh start = has_rows(arguments) ? mesh_of_rows(loaded, arguments.scene, *arguments.factors)
                                        : CutMesh{coarse_begin(loaded, arguments.scene), loaded.mesh};
    Refinement found =
        with_checkpoint(arguments.factors, arguments.rows.resume, terminal, [&](RowCheckpoint* checkpoint) {
            RefinementRows rows;
            if (has_rows(arguments)) {
                rows.begin = rows_to_refine(arguments, loaded.scene, start.mesh, settings);
            }
            rows.checkpoint = checkpoint;
            rows.store = [&](const PatchMesh& mesh, FormFactors& raw) {
                LoadedScene finer = loaded;
                finer.adopt(mesh, start.begin, arguments.parts);
                raw.parts = finer.parts();
                store_rows(arguments, raw, terminal);
            };
            return solve_refined(loaded.scene, start.begin.mesh, settings, arguments.solver, goal,
                                 wants_irradiance(arguments, loaded.scene), observer, std::move(rows));
        });
    loaded.adopt(std::move(found.mesh), start.begin, arguments.parts);
    found.factors.parts = loaded.parts();
    seconds["solve"] = found.solution.seconds;
    seconds["refine"] = watch.seconds() - found.solution.seconds;
    report = refinement_report(found.steps, found.stopped);
    if (!found.stopped.empty() && goal.error) {
        const double error = found.steps.back().error;
        missed = fmt::format("an error of {:.6g} % ({}) is not met: {}; the estimated error is {}",
                             100.0 * *goal.error, to_word(goal.error_of), found.stopped,
                             std::isfinite(error) ? fmt::format("{:.2g} %", 100.0 * error) : "not known");
    }
    return {std::move(found.factors), std::move(found.solution)};
}

/// Whether a file of that name is replaced when it is written again; a pipe would get both.
bool is_replaced(const std::filesystem::path& path) {
    std::error_code unknown;
    return path != "-" &&
           (!std::filesystem::exists(path, unknown) || std::filesystem::is_regular_file(path, unknown));
}

/// @param only_replaced  leaves out what cannot be written again
void write_solution(const SolveArguments& arguments, const LoadedScene& loaded, const Solution& solution,
                    bool only_replaced) {
    const auto wanted = [only_replaced](const std::optional<std::filesystem::path>& path) {
        return path && (!only_replaced || is_replaced(*path));
    };
    if (!wanted(arguments.result) && !wanted(arguments.radiosity)) {
        return;
    }
    const io::ResultFile result = loaded.result(solution);
    if (wanted(arguments.result)) {
        io::write_hres(*arguments.result, result);
    }
    if (wanted(arguments.radiosity)) {
        io::write_radiosity_csv(*arguments.radiosity, result);
    }
}

/// Adds what the patches' size does, unless no estimate is wanted.
void estimate_patch_size(const SolveArguments& arguments, const LoadedScene& loaded,
                         const FormFactors& factors, Observer& observer, Solution& solution,
                         Seconds& seconds) {
    if (!arguments.rows.factors.estimate_error || !solution.error) {
        return;
    }
    const Stopwatch watch;
    solution.patch_size_error = try_estimate_patch_size_error(loaded.scene, loaded.mesh, factors, solution,
                                                              arguments.rows.factors, observer);
    seconds["estimate"] += watch.seconds();
}

/// Finds the radiosity at vertices where an output holds it.
void gather(const SolveArguments& arguments, const LoadedScene& loaded, const FormFactors& factors,
            Observer& observer, Solution& solution, Seconds& seconds) {
    if (!gathers(arguments)) {
        return;
    }
    const Stopwatch watch;
    gather_at_vertices(loaded.scene, loaded.mesh, settings_to_gather(arguments, factors), arguments.gather,
                       solution, observer);
    seconds["gather"] = watch.seconds();
}

/// @return report of the picture; empty where none was asked for
Report draw(const SolveArguments& arguments, const LoadedScene& loaded, const Solution& solution,
            Seconds& seconds) {
    if (!arguments.picture.output) {
        return {};
    }
    const Stopwatch watch;
    Report picture = write_picture(loaded.scene, loaded.mesh, solution, arguments.picture,
                                   arguments.rows.factors.engine.device);
    seconds["render"] = watch.seconds();
    return picture;
}

} // namespace

ExitStatus run(const SolveArguments& given, const Terminal& terminal) {
    SolveArguments arguments = given;
    settle_clusters(arguments.common, arguments.rows, cluster_obstacle(arguments));
    check_input(arguments);
    const Outputs outputs = check_outputs(arguments);
    Seconds seconds(
        {"load", "factors", "repair", "solve", "gather", "estimate", "search", "refine", "render"});
    LoadedScene loaded = load_scene(arguments.scene, terminal);
    if (arguments.factors && !arguments.refines()) {
        adopt_mesh_of_rows(loaded, arguments.scene, *arguments.factors, arguments.parts);
    }
    seconds["load"] = loaded.seconds;
    if (!arguments.refines() && !has_rows(arguments)) {
        advise_patch_size(loaded, terminal);
    }
    if (arguments.picture.output) { // tested before the work
        if (arguments.picture.quantity) {
            check_channel(loaded.scene.channels, arguments.picture.channel);
        } else {
            (void)channels_to_show(loaded.scene.channels, arguments.picture.show);
        }
        (void)choose_camera(loaded.scene, loaded.mesh, arguments.picture);
        (void)picture_cut(arguments.picture, loaded.mesh.groups());
    }
    TerminalObserver observer(terminal);
    // Refinement goes over some phases again; and stored rows may be of another preset.
    if (!arguments.refines() && !arguments.rows.error_target && !has_rows(arguments)) {
        observer.plan(phases_of(arguments, loaded));
    }
    Report refinement;
    std::string missed;
    auto [factors, solution] =
        arguments.refines()
            ? solve_on_finer_patches(arguments, loaded, observer, terminal, seconds, refinement, missed)
        : arguments.rows.error_target ? solve_to_target(arguments, loaded, observer, terminal, seconds)
                                      : solve(arguments, loaded, observer, terminal, seconds);
    const double max_row_error = arguments.rows.max_row_error;
    const RowSums sums = row_sums(factors.matrix);
    const EnclosureFinding enclosure = find_leaks(factors, max_row_error);
    report_no_fronts(sums, factors.matrix, terminal);
    if (!arguments.scene.environment.empty() && loaded.scene.enclosure != Enclosure::closed &&
        factors.matrix.all_known() && sums.environment_max == 0.0) {
        terminal.warn("--environment has no effect: no patch sees the environment");
    }
    report_buried(sums, terminal);
    if (arguments.patches) {
        loaded.write_patches(*arguments.patches, factors.matrix);
    }
    // Stored before what may be cancelled, and again with it.
    write_solution(arguments, loaded, solution, true);
    Report picture;
    try {
        if (!arguments.refines()) {
            gather(arguments, loaded, factors, observer, solution, seconds);
        }
        const bool shows_error = arguments.picture.quantity && is_error(*arguments.picture.quantity);
        if (!shows_error) { // which is soon there
            picture = draw(arguments, loaded, solution, seconds);
        }
        if (!arguments.refines()) {
            estimate_patch_size(arguments, loaded, factors, observer, solution, seconds);
        }
        if (shows_error) {
            picture = draw(arguments, loaded, solution, seconds);
        }
    } catch (const Cancelled&) {
        write_solution(arguments, loaded, solution, false);
        throw;
    }
    write_solution(arguments, loaded, solution, false);
    PatchValues values = patch_values(loaded.scene, loaded.mesh);
    values.direct = solution.direct;
    const std::optional<LightBalance> balance =
        light_balance(factors, values, solution.radiosity, flux_weights(loaded.scene));
    report_savings(loaded, factors, solution, arguments.rows.factors.merge_lattices, terminal);
    Report report = solve_report(loaded, factors, rows_report(factors, sums, enclosure), solution, balance,
                                 seconds, arguments.rows.error_of, terminal.verbose());
    report.text += refinement.text + picture.text;
    report.json.update(refinement.json);
    outputs.show(report, arguments.common.json, terminal);
    report_leaks(enclosure, factors.matrix, loaded.names(), &loaded.mesh, max_row_error, terminal);
    report_lost_light(balance, factors.groups, terminal);
    if (!missed.empty()) {
        terminal.warn(missed);
    }
    if (solution_error(solution) && !arguments.refines() && !arguments.picture.output &&
        !gathers(arguments) &&
        should_gather(arguments.gather, settings_to_gather(arguments, factors), loaded.mesh, solution)) {
        terminal.note(
            "the error is that of the patches' means at the vertices, since no picture and no --result "
            "shows gathered ones; --gather on gathers them");
    }
    return enclosure.leaks.empty() && missed.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

} // namespace hemi::cli
