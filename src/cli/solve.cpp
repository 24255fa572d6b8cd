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
#include "hemi/io/factor_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/accuracy.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hemi::cli {

namespace {

namespace fs = std::filesystem;

/// Whether `--factors` names rows that are there.
bool has_rows(const SolveArguments& arguments) {
    std::error_code ignored; // a name that no file can have
    return arguments.factors && fs::is_regular_file(*arguments.factors, ignored);
}

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
    outputs.refuse_with_json(arguments.common.json);
    return outputs;
}

void check_input(const SolveArguments& arguments) {
    if (arguments.rows.error_target && has_rows(arguments)) {
        throw InvalidArgument(fmt::format("--error-target chooses settings, but the rows of {} are there "
                                          "already; leave one out",
                                          arguments.factors->string()));
    }
    if (!io::is_scene_file(arguments.scene.path)) {
        throw InvalidArgument(fmt::format("{}: solve needs a scene ({})", arguments.scene.path.string(),
                                          io::scene_extensions()));
    }
}

/// One run of the command.
class Solve {
public:
    Solve(const SolveArguments& arguments, const Terminal& terminal)
        : arguments_(arguments), terminal_(terminal), observer_(terminal), outputs_(check_outputs(arguments)),
          seconds_({"load", "factors", "repair", "solve", "estimate", "search", "render", "total"}),
          loaded_(load_scene(arguments.scene, terminal)) {
        seconds_["load"] = loaded_.seconds;
        if (arguments.picture.output) { // tested before the work
            (void)channels_to_show(loaded_.scene.channels, arguments.picture.show);
            (void)choose_camera(loaded_.scene, loaded_.mesh, arguments.picture);
        }
    }

    ExitStatus run() {
        if (arguments_.rows.error_target) {
            solve_to_target();
        } else {
            solve();
        }
        const RowSums sums = row_sums(factors_.matrix);
        const EnclosureFinding enclosure = find_leaks(factors_, arguments_.rows.max_row_error);
        report_buried(sums, terminal_);
        write_files();
        const std::string picture = draw();
        seconds_["total"] = total_.seconds();
        report_savings(loaded_, factors_, solution_, arguments_.rows.factors.merge_lattices, terminal_);
        if (arguments_.common.json) {
            print_json(solution_json(loaded_, factors_, sums, solution_, seconds_));
        } else {
            outputs_.print_summary(scene_summary(loaded_.mesh) + rows_summary(factors_, sums, enclosure) +
                                       repair_summary(*factors_.repair) + solution_summary(solution_) +
                                       seconds_.summary() + picture,
                                   terminal_);
        }
        report_leaks(enclosure, factors_.matrix, loaded_.names(), &loaded_.mesh,
                     arguments_.rows.max_row_error, terminal_);
        return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
    }

private:
    [[nodiscard]] bool with_irradiance() const { return arguments_.result || arguments_.radiosity; }

    [[nodiscard]] std::vector<std::uint32_t> needed_patches() const {
        return arguments_.factors || with_irradiance() ? all_patches(loaded_.mesh.size())
                                                       : reflecting_patches(loaded_.scene, loaded_.mesh);
    }

    void store(FormFactors& raw) const {
        if (arguments_.factors) {
            estimate_error(raw);
            io::write_hff(*arguments_.factors, raw);
            terminal_.detail(fmt::format("form factors written to {}", arguments_.factors->string()));
        }
    }

    void find_rows(RowCheckpoint* checkpoint) {
        if (has_rows(arguments_)) {
            factors_ = reuse_rows(*arguments_.factors, loaded_, arguments_.rows.factors, arguments_.common);
            terminal_.detail(
                fmt::format("form factors from {}: no rows to compute", arguments_.factors->string()));
            if (with_irradiance() && !factors_.matrix.all_known()) {
                throw InputError(fmt::format("{}: rows are missing that --result and --radiosity need",
                                             arguments_.factors->string()));
            }
        } else {
            factors_ = compute_raw_form_factors(loaded_.scene, loaded_.mesh, needed_patches(),
                                                arguments_.rows.factors, observer_, checkpoint);
            store(factors_);
        }
        if (checkpoint != nullptr) { // also that of a run which was killed when the file was complete
            checkpoint->discard();
        }
    }

    void solve() {
        const Stopwatch rows_watch;
        with_checkpoint(arguments_.factors, arguments_.rows.resume, terminal_,
                        [this](RowCheckpoint* checkpoint) { find_rows(checkpoint); });
        seconds_["estimate"] = factors_.work.reference_seconds;
        seconds_["factors"] = rows_watch.seconds() - factors_.work.reference_seconds;
        const Stopwatch prepare_watch;
        prepare_form_factors(factors_, arguments_.rows.factors.repair);
        seconds_["repair"] = prepare_watch.seconds();
        const Stopwatch solve_watch;
        solution_ = solve_radiosity(loaded_.scene, loaded_.mesh, factors_, arguments_.solver, observer_,
                                    with_irradiance());
        seconds_["solve"] = solution_.seconds;
        seconds_["estimate"] += solve_watch.seconds() - solution_.seconds;
    }

    void solve_to_target() {
        TargetResult found = hemi::solve_to_target(
            loaded_.scene, loaded_.mesh, needed_patches(), arguments_.rows.factors, arguments_.solver,
            *arguments_.rows.error_target, observer_, with_irradiance());
        store(found.raw);
        factors_ = std::move(found.factors);
        solution_ = std::move(found.solution);
        seconds_["search"] = found.search_seconds;
        seconds_["factors"] = found.factor_seconds;
        seconds_["solve"] = solution_.seconds;
    }

    void write_files() const {
        if (arguments_.patches) {
            io::write_patches_csv(*arguments_.patches, loaded_.mesh);
        }
        if (arguments_.result) {
            io::write_hres(*arguments_.result, {loaded_.scene, arguments_.scene.subdivision, solution_});
        }
        if (arguments_.radiosity) {
            io::write_radiosity_csv(*arguments_.radiosity, loaded_.mesh, loaded_.scene.channels,
                                    solution_.exitance, solution_.irradiance, solution_.radiosity);
        }
    }

    /// @return the line that says so; empty where no picture was asked for
    std::string draw() {
        if (!arguments_.picture.output) {
            return "";
        }
        const Stopwatch watch;
        const WrittenPicture picture =
            write_picture(loaded_.scene, loaded_.mesh, solution_, arguments_.picture,
                          arguments_.rows.factors.engine.device);
        seconds_["render"] = watch.seconds();
        return summary_line("picture", picture.text);
    }

    const SolveArguments& arguments_;
    const Terminal& terminal_;
    TerminalObserver observer_;
    Stopwatch total_;
    Outputs outputs_;
    Seconds seconds_;
    LoadedScene loaded_;
    FormFactors factors_;
    Solution solution_;
};

} // namespace

ExitStatus run(const SolveArguments& arguments, const Terminal& terminal) {
    check_input(arguments);
    return Solve(arguments, terminal).run();
}

} // namespace hemi::cli
