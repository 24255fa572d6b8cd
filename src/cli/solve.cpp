#include "cli/commands.hpp"
#include "cli/error_report.hpp"
#include "cli/error_target.hpp"
#include "cli/outputs.hpp"
#include "cli/picture_output.hpp"
#include "cli/pipeline.hpp"
#include "cli/repair_rows.hpp"
#include "cli/report.hpp"
#include "cli/signals.hpp"
#include "cli/solution.hpp"
#include "engine/hemicube/draw_list.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <system_error>

namespace hemi::cli {

namespace {

namespace fs = std::filesystem;

/// Whether `--factors` names rows that are there.
bool has_rows(const SolveArguments& arguments) {
    std::error_code ignored; // a name that no file can have
    return arguments.factors && fs::is_regular_file(*arguments.factors, ignored);
}

struct Seconds {
    double load = 0.0;
    double factors = 0.0;
    double repair = 0.0;
    double solve = 0.0;
    double estimate = 0.0; ///< of errors
    double search = 0.0;   ///< for settings that meet --error-target
    double render = 0.0;
    double total = 0.0;
};

Outputs check_outputs(const SolveArguments& arguments) {
    Outputs outputs;
    add_picture_output(outputs, arguments.picture);
    const auto add = [&outputs](std::string_view option, const std::optional<fs::path>& path,
                                std::string_view extension, bool allow_standard_output) {
        if (path) {
            outputs.add(option, *path, {extension}, allow_standard_output);
        }
    };
    if (arguments.factors && !has_rows(arguments)) { // else it is an input
        add("--factors", arguments.factors, ".hff", false);
    }
    add("--result", arguments.result, ".hres", false);
    add("--radiosity", arguments.radiosity, ".csv", true);
    add("--patches", arguments.patches, ".csv", true);
    if (outputs.uses_standard_output() && arguments.common.json) {
        throw InvalidArgument("--json and an output to - cannot both go to standard output");
    }
    return outputs;
}

/// Rows and what was made of them.
struct Solved {
    Rows rows;
    RowRepair repair;
    EnclosureFinding enclosure;
    Solution solution;
};

void store_rows(const SolveArguments& arguments, Rows& rows, const Terminal& terminal) {
    if (arguments.factors && !rows.reused) {
        estimate_rows(rows.file);
        io::write_hff(*arguments.factors, rows.file);
        terminal.detail(fmt::format("form factors written to {}", arguments.factors->string()));
    }
}

std::vector<std::uint32_t> needed_patches(const SolveArguments& arguments, const LoadedScene& loaded) {
    const bool all = arguments.factors || arguments.result || arguments.radiosity;
    return all ? all_patches(loaded.mesh.size()) : reflecting_patches(loaded);
}

Rows find_rows(const SolveArguments& arguments, const LoadedScene& loaded, const Terminal& terminal,
               KeptRows& kept) {
    if (has_rows(arguments)) {
        Rows rows = reuse_rows(*arguments.factors, loaded, arguments.rows, arguments.common);
        terminal.detail(fmt::format("form factors from {}: no rows to compute", arguments.factors->string()));
        if ((arguments.result || arguments.radiosity) && !rows.file.factors.all_known()) {
            throw InputError(fmt::format("{}: rows are missing that --result and --radiosity need",
                                         arguments.factors->string()));
        }
        kept.discard(); // of a run that was killed when the file was complete
        return rows;
    }
    Rows rows = compute_rows(loaded, needed_patches(arguments, loaded), arguments.rows, terminal, &kept);
    add_reference(rows, loaded, arguments.rows, terminal);
    store_rows(arguments, rows, terminal);
    kept.discard();
    return rows;
}

/// From raw rows to the radiosity and what it is off by.
Solved solve_rows(const SolveArguments& arguments, const LoadedScene& loaded, Rows rows, Seconds& seconds,
                  const Terminal& terminal) {
    Solved solved;
    solved.rows = std::move(rows);
    io::FactorFile& file = solved.rows.file;
    settle_contacts(file);
    solved.enclosure =
        find_leaks(file.factors, enclosure_name(loaded.scene.enclosure), arguments.rows.max_row_error);
    solved.repair = repair_rows(file, arguments.rows.repair);
    seconds.repair = solved.repair.seconds;
    const Stopwatch rows_watch;
    estimate_rows(file);
    seconds.estimate += rows_watch.seconds();
    const bool with_irradiance = arguments.result || arguments.radiosity;
    solved.solution = solve_scene(loaded, file.factors, arguments.solver, with_irradiance, terminal);
    seconds.solve = solved.solution.seconds;
    const Stopwatch solution_watch;
    solved.solution.error = estimate_solution(loaded, file, solved.solution);
    seconds.estimate += solution_watch.seconds();
    return solved;
}

/// The cheapest settings first, and from what comes of them to those that are good enough.
Solved solve_to_target(const SolveArguments& arguments, const LoadedScene& loaded, Seconds& seconds,
                       const Terminal& terminal) {
    const auto patches = needed_patches(arguments, loaded);
    if (patches.empty()) {
        throw InvalidArgument("--error-target: nothing in the scene reflects, so that nothing can be wrong");
    }
    const Stopwatch search_watch;
    TargetSearch search(loaded, patches, arguments.rows, *arguments.rows.error_target, terminal);
    RowOptions options = search.first();
    seconds.search = search_watch.seconds();
    for (;;) {
        const Stopwatch watch;
        Rows rows = compute_rows(loaded, patches, options, terminal);
        rows.file.reference = search.reference().rows;
        rows.file.chosen_for = search.told();
        seconds.factors = watch.seconds();
        Rows raw = rows;
        Solved solved = solve_rows(arguments, loaded, std::move(rows), seconds, terminal);
        if (search.met(solved.solution.error ? solved.solution.error->rms : 0.0)) {
            store_rows(arguments, raw, terminal);
            return solved;
        }
        const Stopwatch next_watch;
        options = search.next(solved.solution.radiosity);
        seconds.search += next_watch.seconds();
    }
}

void report_savings(const LoadedScene& loaded, const Rows& rows, const Solution& solution,
                    const RowOptions& options, const Terminal& terminal) {
    if (!terminal.verbose()) {
        return;
    }
    const std::size_t patches = loaded.mesh.size();
    if (!rows.reused) {
        terminal.detail(fmt::format("rows computed: {} of {} (patches that reflect nothing need none)",
                                    count_text(rows.computed), count_text(patches)));
    }
    terminal.detail(fmt::format("channels solved: {} of {}{}", solution.channels_solved, solution.channels,
                                solution.channels_solved < solution.channels ? " (all are equal)" : ""));
    if (rows.hemicubes > 0) {
        const std::size_t drawn = make_draw_list(loaded.mesh, options.merge).polygons.size();
        terminal.detail(fmt::format("polygons drawn: {} for {}", count_text(drawn),
                                    plural(loaded.mesh.surfaces().size(), "surface", "surfaces")));
    }
}

std::string summary(const LoadedScene& loaded, const Rows& rows, const RowSums& sums,
                    const EnclosureFinding& enclosure, const RowRepair& repair, const Solution& solution,
                    const Seconds& seconds, const std::string& picture) {
    std::string text =
        summary_line("scene", fmt::format("{}, {}, {}", plural(loaded.mesh.size(), "patch", "patches"),
                                          plural(loaded.mesh.surfaces().size(), "surface", "surfaces"),
                                          plural(loaded.mesh.groups().size(), "group", "groups")));
    text += rows_summary(rows, sums, enclosure);
    text += repair_summary(repair);
    text += summary_line("dominance", fmt::format("{:.6g} (largest reflectance x row sum; below 1 converges)",
                                                  solution.dominance));
    const bool gradients = solution.solver == solver_name(SolverMethod::conjugate_gradient);
    text += summary_line("solver", fmt::format("{}, {}, residual {:.3g}", solution.solver,
                                               gradients ? plural(solution.sweeps, "iteration", "iterations")
                                                         : plural(solution.sweeps, "sweep", "sweeps"),
                                               solution.residual));
    text += summary_line("", solution.why);
    text += chosen_summary(rows.file.chosen_for) + error_summary(rows.file.error, solution.error);
    text += summary_line("seconds", fmt::format("load {:.3f}, factors {:.3f}, repair {:.3f}, solve {:.3f}, "
                                                "estimate {:.3f}, render {:.3f}, total {:.3f}",
                                                seconds.load, seconds.factors, seconds.repair, seconds.solve,
                                                seconds.estimate, seconds.render, seconds.total));
    if (!picture.empty()) {
        text += summary_line("picture", picture);
    }
    return text;
}

/// Area mean per group and channel of a per-patch value.
std::vector<double> group_means(const LoadedScene& loaded, const std::vector<double>& areas,
                                const std::vector<double>& values, std::uint32_t channels) {
    std::vector<double> sums(areas.size() * channels, 0.0);
    for (std::uint32_t i = 0; i < loaded.mesh.size(); ++i) {
        for (std::uint32_t c = 0; c < channels; ++c) {
            sums[loaded.group_of[i] * channels + c] +=
                loaded.mesh.areas()[i] * values[std::size_t{i} * channels + c];
        }
    }
    for (std::size_t k = 0; k < sums.size(); ++k) {
        sums[k] /= areas[k / channels];
    }
    return sums;
}

std::vector<double> group_areas(const LoadedScene& loaded) {
    std::vector<double> areas(loaded.mesh.groups().size(), 0.0);
    for (std::uint32_t i = 0; i < loaded.mesh.size(); ++i) {
        areas[loaded.group_of[i]] += loaded.mesh.areas()[i];
    }
    return areas;
}

/// Area mean per group of e or b; null for a group with rows that were not computed.
Json share_json(const LoadedScene& loaded, const std::vector<double>& areas, const FormFactorMatrix& factors,
                double RowView::*share) {
    std::vector<double> values(factors.size(), 0.0);
    std::vector<bool> known(areas.size(), true);
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        values[i] = factors.row(i).*share;
        known[loaded.group_of[i]] = known[loaded.group_of[i]] && factors.known(i);
    }
    const std::vector<double> means = group_means(loaded, areas, values, 1);
    Json json = Json::array();
    for (std::size_t g = 0; g < means.size(); ++g) {
        json.push_back(known[g] ? Json(means[g]) : Json());
    }
    return json;
}

Json to_json(const LoadedScene& loaded, const Rows& rows, const RowSums& sums, const RowRepair& repair,
             const Solution& solution, const Seconds& seconds) {
    const std::uint32_t channels = solution.channels;
    const std::vector<double> areas = group_areas(loaded);
    const FormFactorMatrix& factors = rows.file.factors;
    return {{"schema", "hemi/solve/1"},
            {"renderer", rows.file.renderer},
            {"patches", loaded.mesh.size()},
            {"channels", loaded.scene.channels},
            {"groups", loaded.mesh.groups()},
            {"areas", areas},
            {"radiosity", rows_json(group_means(loaded, areas, solution.radiosity, channels), channels)},
            {"exitance", rows_json(group_means(loaded, areas, solution.exitance, channels), channels)},
            {"environment", share_json(loaded, areas, factors, &RowView::environment)},
            {"blocked", share_json(loaded, areas, factors, &RowView::blocked)},
            {"solver",
             {{"name", solution.solver},
              {"sweeps", solution.sweeps},
              {"residual", solution.residual},
              {"why", solution.why}}},
            {"row_sum", row_sum_json(sums)},
            {"reciprocity",
             factors.all_known() ? reciprocity_json(repair.report.reciprocity_after) : Json(nullptr)},
            {"repair", repair_json(repair)},
            {"chosen_for", rows.file.chosen_for.empty() ? Json(nullptr) : Json(rows.file.chosen_for)},
            {"error_estimate", error_json(rows.file.error, solution.error)},
            {"seconds",
             {{"load", seconds.load},
              {"factors", seconds.factors},
              {"repair", seconds.repair},
              {"solve", seconds.solve},
              {"estimate", seconds.estimate},
              {"search", seconds.search},
              {"render", seconds.render},
              {"total", seconds.total}}}};
}

void write_files(const SolveArguments& arguments, const LoadedScene& loaded, const Rows& rows,
                 const Solution& solution) {
    if (arguments.patches) {
        io::write_patches_csv(*arguments.patches, loaded.mesh);
    }
    if (arguments.result) {
        io::write_hres(*arguments.result, make_result(loaded, arguments.scene, rows, solution));
    }
    if (arguments.radiosity) {
        io::write_radiosity_csv(*arguments.radiosity, loaded.mesh, loaded.scene.channels, solution.exitance,
                                solution.irradiance, solution.radiosity);
    }
}

} // namespace

ExitStatus run(const SolveArguments& arguments, const Terminal& terminal) {
    const Stopwatch total;
    const Outputs outputs = check_outputs(arguments);
    if (arguments.rows.error_target && has_rows(arguments)) {
        throw InvalidArgument(fmt::format("--error-target chooses settings, but the rows of {} are there "
                                          "already; leave one out",
                                          arguments.factors->string()));
    }
    if (!io::is_scene_file(arguments.scene.path)) {
        throw InvalidArgument(fmt::format("{}: solve needs a scene ({})", arguments.scene.path.string(),
                                          io::scene_extensions()));
    }
    Seconds seconds;
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    if (arguments.picture.output) {
        (void)channels_to_show(loaded.scene.channels, arguments.picture.show);
        (void)choose_camera(loaded.scene, loaded.mesh, arguments.picture);
    }
    seconds.load = loaded.seconds;

    Solved solved;
    if (arguments.rows.error_target) {
        solved = solve_to_target(arguments, loaded, seconds, terminal);
    } else {
        const Stopwatch watch;
        Rows found = keeping_rows(arguments.factors, arguments.rows.resume, terminal, [&](KeptRows& kept) {
            return find_rows(arguments, loaded, terminal, kept);
        });
        seconds.estimate = found.reference_seconds;
        seconds.factors = watch.seconds() - seconds.estimate;
        solved = solve_rows(arguments, loaded, std::move(found), seconds, terminal);
    }
    const auto& [rows, repair, enclosure, solution] = solved;
    const FormFactorMatrix& factors = rows.file.factors;
    const RowSums sums = row_sums(factors);
    report_covered(sums, terminal);
    write_files(arguments, loaded, rows, solution);

    std::string picture;
    if (arguments.picture.output) {
        const Stopwatch render_watch;
        picture = write_picture(
                      {loaded.scene, loaded.mesh, solution.radiosity, solution.exitance, solution.blocked},
                      arguments.picture, arguments.rows.device)
                      .text;
        seconds.render = render_watch.seconds();
    }
    seconds.total = total.seconds();
    report_savings(loaded, rows, solution, arguments.rows, terminal);
    if (arguments.common.json) {
        print_json(to_json(loaded, rows, sums, repair, solution, seconds));
    } else if (!terminal.quiet()) {
        const std::string text = summary(loaded, rows, sums, enclosure, repair, solution, seconds, picture);
        if (outputs.uses_standard_output()) {
            std::fputs(text.c_str(), stderr);
        } else {
            print(text);
        }
    }
    report_leaks(enclosure, factors, loaded.names(), &loaded.mesh, arguments.rows.max_row_error, terminal);
    return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

} // namespace hemi::cli
