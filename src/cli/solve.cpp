#include "cli/commands.hpp"
#include "cli/error_report.hpp"
#include "cli/outputs.hpp"
#include "cli/picture_output.hpp"
#include "cli/pipeline.hpp"
#include "cli/repair_rows.hpp"
#include "cli/report.hpp"
#include "cli/signals.hpp"
#include "cli/solution.hpp"
#include "engine/draw_list.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>

namespace hemi::cli {

namespace {

namespace fs = std::filesystem;

struct Seconds {
    double load = 0.0;
    double factors = 0.0;
    double repair = 0.0;
    double solve = 0.0;
    double estimate = 0.0; ///< of errors
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
    if (!arguments.factors || !fs::is_regular_file(*arguments.factors)) { // else it is an input
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

Rows find_rows(const SolveArguments& arguments, const LoadedScene& loaded, const Terminal& terminal) {
    if (arguments.factors && fs::is_regular_file(*arguments.factors)) {
        Rows rows = reuse_rows(*arguments.factors, loaded, arguments.rows, arguments.common);
        settle_contacts(rows.file);
        terminal.detail(fmt::format("form factors from {}: no rows to compute", arguments.factors->string()));
        return rows;
    }
    const bool all = arguments.factors || arguments.result || arguments.radiosity;
    const auto patches = all ? all_patches(loaded.mesh.size()) : reflecting_patches(loaded);
    Rows rows = compute_rows(loaded, patches, arguments.rows, terminal);
    add_reference(rows, loaded, arguments.rows, terminal);
    if (arguments.factors) {
        estimate_rows(rows.file);
        io::write_hff(*arguments.factors, rows.file);
        terminal.detail(fmt::format("form factors written to {}", arguments.factors->string()));
    }
    settle_contacts(rows.file);
    return rows;
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
    if (!rows.reused && rows.computed > 0) {
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
    text += error_summary(rows.file.error, solution.error);
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
            {"error_estimate", error_json(rows.file.error, solution.error)},
            {"seconds",
             {{"load", seconds.load},
              {"factors", seconds.factors},
              {"repair", seconds.repair},
              {"solve", seconds.solve},
              {"estimate", seconds.estimate},
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
    if (!io::is_scene_file(arguments.scene.path)) {
        throw InvalidArgument(fmt::format("{}: solve needs a scene ({})", arguments.scene.path.string(),
                                          io::scene_extensions()));
    }
    Seconds seconds;
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    if (arguments.picture.output) {
        (void)channels_to_show(loaded.scene.channels, arguments.picture.show);
        (void)choose_camera(loaded.scene, loaded.mesh, arguments.picture.camera);
    }
    seconds.load = loaded.seconds;

    const Stopwatch factors_watch;
    Rows rows = find_rows(arguments, loaded, terminal);
    const FormFactorMatrix& factors = rows.file.factors;
    if (arguments.result || arguments.radiosity) {
        if (!factors.all_known()) {
            throw InputError(fmt::format("{}: rows are missing that --result and --radiosity need",
                                         arguments.factors->string()));
        }
    }
    const EnclosureFinding enclosure =
        find_leaks(factors, enclosure_name(loaded.scene.enclosure), arguments.rows.max_row_error);
    seconds.estimate = rows.reference_seconds;
    seconds.factors = factors_watch.seconds() - seconds.estimate;
    const RowRepair repair = repair_rows(rows.file, arguments.rows.repair);
    seconds.repair = repair.seconds;
    const Stopwatch estimate_watch;
    estimate_rows(rows.file);
    const double rows_estimated = estimate_watch.seconds();
    const RowSums sums = row_sums(factors);
    report_covered(sums, terminal);

    const bool with_irradiance = arguments.result || arguments.radiosity;
    Solution solution = solve_scene(loaded, factors, arguments.solver, with_irradiance, terminal);
    seconds.solve = solution.seconds;
    const Stopwatch solution_watch;
    solution.error = estimate_solution(loaded, rows.file, solution);
    seconds.estimate += rows_estimated + solution_watch.seconds();
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
    report_leaks(enclosure, factors, loaded.names(), arguments.rows.max_row_error, terminal);
    return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

} // namespace hemi::cli
