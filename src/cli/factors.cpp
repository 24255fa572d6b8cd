#include "cli/commands.hpp"
#include "cli/factor_source.hpp"
#include "cli/factor_tables.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/seconds.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/io/vtp_file.hpp"
#include "hemi/pipeline/accuracy.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <numeric>

namespace hemi::cli {

namespace {

/// Whether the group table goes into the .csv that -o names, else to stdout.
bool table_goes_to_file(const FactorsArguments& arguments) {
    return arguments.by_group && arguments.output &&
           (is_standard_output(*arguments.output) || extension_of(*arguments.output) == ".csv");
}

/// `.hff` holds the rows as they were computed; repair is redone when it is read.
bool holds_raw_rows(const std::filesystem::path& path) {
    return extension_of(path) == ".hff";
}

bool is_scene(const FactorsArguments& arguments) {
    return io::is_scene_file(arguments.scene.path);
}

Outputs check_outputs(const FactorsArguments& arguments) {
    Outputs outputs;
    if (arguments.output) {
        std::vector<std::string_view> extensions = io::factor_extensions();
        extensions.push_back(".vtp");
        outputs.add("-o", *arguments.output, extensions, true);
    }
    if (arguments.patches) {
        outputs.add("--patches", *arguments.patches, {".csv"}, true);
    }
    const bool prints =
        arguments.common.json || arguments.row || (arguments.by_group && !table_goes_to_file(arguments));
    if (outputs.uses_standard_output() && prints) {
        throw InvalidArgument("an output to - and a table or --json cannot both go to standard output");
    }
    return outputs;
}

/// The file of all rows, if one is to be written; rows are kept beside it meanwhile.
std::optional<std::filesystem::path> factor_file(const FactorsArguments& arguments) {
    const bool writes = arguments.output && !table_goes_to_file(arguments) &&
                        !is_standard_output(*arguments.output) && !arguments.rows.error_target &&
                        is_scene(arguments);
    if (arguments.rows.resume && !writes) {
        throw InvalidArgument(
            "--resume needs a file of form factors to go on with (-o FILE.hff), made from a scene");
    }
    return writes ? arguments.output : std::nullopt;
}

/// 1 - reflectance of every patch, the mean of all channels.
std::vector<double> emissivities(const LoadedScene& loaded) {
    const std::vector<double> reflectance =
        patch_values(loaded.mesh, loaded.scene.materials, &Material::reflectance);
    const auto channels = static_cast<std::ptrdiff_t>(loaded.scene.channels.size());
    std::vector<double> result;
    for (auto first = reflectance.begin(); first != reflectance.end(); first += channels) {
        const double sum = std::accumulate(first, first + channels, 0.0);
        result.push_back(1.0 - sum / static_cast<double>(channels));
    }
    return result;
}

GroupFactors sum_groups(const FormFactors& factors, const std::filesystem::path& path) {
    if (!factors.matrix.all_known()) {
        throw InputError(fmt::format("{}: some rows were not computed; --by-group needs all", path.string()));
    }
    return group_factors(factors.matrix, factors.areas, factors.group_of,
                         static_cast<std::uint32_t>(factors.groups.size()));
}

/// One run of the command.
class Factors {
public:
    Factors(const FactorsArguments& arguments, const Outputs& outputs, const Terminal& terminal,
            RowCheckpoint* checkpoint)
        : arguments_(arguments), outputs_(outputs), terminal_(terminal), observer_(terminal),
          checkpoint_(checkpoint), seconds_({"load", "factors", "repair", "estimate", "search", "total"}) {}

    ExitStatus run() {
        if (is_scene(arguments_)) {
            compute();
        } else {
            read();
        }
        if (arguments_.row && loaded_) {
            show_row(factors_, *arguments_.row, names(), arguments_.common.json);
            return ExitStatus::ok;
        }
        write_raw();
        const Stopwatch watch;
        prepare_form_factors(factors_, arguments_.rows.factors.repair);
        seconds_["repair"] = watch.seconds();
        write_prepared();
        terminal_.warn(diagnostics_);
        if (checkpoint_ != nullptr) {
            checkpoint_->discard();
        }
        if (arguments_.row) {
            show_row(factors_, *arguments_.row, names(), arguments_.common.json);
            return ExitStatus::ok;
        }
        return report();
    }

private:
    [[nodiscard]] PatchNames names() const {
        return loaded_ ? loaded_->names() : PatchNames{factors_.groups, factors_.group_of, {}};
    }

    void compute() {
        loaded_ = load_scene(arguments_.scene, terminal_);
        seconds_["load"] = loaded_->seconds;
        const PatchMesh& mesh = loaded_->mesh;
        FactorSettings settings = arguments_.rows.factors;
        std::vector<std::uint32_t> patches = all_patches(mesh.size());
        if (arguments_.row) {
            check_row(mesh);
            patches = {*arguments_.row};
            settings.estimate_error = false;
        }
        const Stopwatch watch;
        if (arguments_.rows.error_target) {
            TargetResult found =
                factors_to_target(loaded_->scene, mesh, settings, *arguments_.rows.error_target, observer_);
            factors_ = std::move(found.raw);
            seconds_["search"] = found.search_seconds;
            seconds_["factors"] = found.factor_seconds;
        } else {
            factors_ =
                compute_raw_form_factors(loaded_->scene, mesh, patches, settings, observer_, checkpoint_);
            seconds_["estimate"] = factors_.work.reference_seconds;
            seconds_["factors"] = watch.seconds() - factors_.work.reference_seconds;
        }
        if (arguments_.patches) {
            io::write_patches_csv(*arguments_.patches, mesh);
        }
    }

    void check_row(const PatchMesh& mesh) const {
        if (arguments_.rows.factors.repair.value_or(Repair::none) != Repair::none) {
            throw InvalidArgument(
                "--repair needs all rows, but --row computes one; store them first with -o FILE.hff");
        }
        if (*arguments_.row >= mesh.size()) {
            throw InvalidArgument(fmt::format("--row {}: the scene has {}, counted from 0", *arguments_.row,
                                              plural(mesh.size(), "patch", "patches")));
        }
    }

    void read() {
        const std::filesystem::path& path = arguments_.scene.path;
        if (extension_of(path) != ".hff") {
            throw InvalidArgument(fmt::format("{}: must be a scene ({}) or form factors with names (.hff)",
                                              path.string(), io::scene_extensions()));
        }
        refuse_all_but(arguments_.common,
                       std::vector<std::string>{"--row", "--by-group", "--output", "--repair"}, path);
        if (!arguments_.row && !arguments_.by_group) {
            throw InvalidArgument(
                fmt::format("{}: of a file, --row or --by-group can be shown; `hemi info` says what "
                            "is in it, `hemi convert` writes it in other formats",
                            path.string()));
        }
        if (writes()) {
            throw InvalidArgument(
                "-o: of a file only the table of --by-group can be written, as .csv; for other "
                "formats there is `hemi convert`");
        }
        const Stopwatch watch;
        factors_ = io::read_hff(path);
        factors_.work.from_file = true;
        seconds_["load"] = watch.seconds();
        const std::uint32_t size = factors_.matrix.size();
        if (arguments_.row && *arguments_.row >= size) {
            throw InvalidArgument(fmt::format("--row {}: the file has {}, counted from 0", *arguments_.row,
                                              plural(size, "row", "rows")));
        }
        if (arguments_.row && !factors_.matrix.known(*arguments_.row)) {
            throw InputError(fmt::format("{}: row {} was not computed", path.string(), *arguments_.row));
        }
    }

    [[nodiscard]] bool writes() const { return arguments_.output && !table_goes_to_file(arguments_); }

    void write_raw() {
        if (writes() && holds_raw_rows(*arguments_.output)) {
            estimate_error(factors_);
            io::write_factors(*arguments_.output, factors_, {}, diagnostics_);
            if (checkpoint_ != nullptr) {
                checkpoint_->discard();
            }
        }
    }

    void write_prepared() {
        if (!writes() || holds_raw_rows(*arguments_.output)) {
            return;
        }
        if (extension_of(*arguments_.output) == ".vtp") {
            io::write_vtp(*arguments_.output, loaded_->mesh, io::factor_arrays(factors_));
        } else {
            const std::vector<double> emissivity = emissivities(*loaded_);
            io::write_factors(*arguments_.output, factors_, {emissivity}, diagnostics_);
        }
    }

    ExitStatus report() {
        const RowSums sums = row_sums(factors_.matrix);
        const EnclosureFinding enclosure = find_leaks(factors_, arguments_.rows.max_row_error);
        if (arguments_.by_group) {
            report_groups(sums);
        } else {
            seconds_["total"] = total_.seconds();
            if (arguments_.common.json) {
                print_json(summary_json(sums));
            } else {
                outputs_.print_summary(summary(sums, enclosure), terminal_);
            }
        }
        if (loaded_) {
            report_buried(sums, terminal_);
        }
        report_leaks(enclosure, factors_.matrix, names(), loaded_ ? &loaded_->mesh : nullptr,
                     arguments_.rows.max_row_error, terminal_);
        return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
    }

    void report_groups(const RowSums& sums) {
        const GroupFactors groups = sum_groups(factors_, arguments_.scene.path);
        if (table_goes_to_file(arguments_)) {
            io::write_group_factors_csv(*arguments_.output, factors_.groups, groups);
        }
        seconds_["total"] = total_.seconds();
        if (arguments_.common.json) {
            print_json({{"schema", "hemi/factors-by-group/1"},
                        {"renderer", factors_.provenance.renderer},
                        {"patches", factors_.matrix.size()},
                        {"groups", factors_.groups},
                        {"areas", groups.areas},
                        {"factors", rows_json(groups.factors, groups.groups)},
                        {"environment", groups.environment},
                        {"blocked", groups.blocked},
                        {"row_sum", row_sum_json(sums)},
                        {"repair", repair_json(*factors_.repair, seconds_["repair"])},
                        {"error_estimate", error_json(factors_.error)},
                        {"seconds", seconds_.json()}});
        } else if (!table_goes_to_file(arguments_)) {
            print(groups_table(factors_.groups, groups));
        }
    }

    [[nodiscard]] std::string summary(const RowSums& sums, const EnclosureFinding& enclosure) const {
        std::string text = scene_summary(loaded_->mesh) + rows_summary(factors_, sums, enclosure) +
                           repair_summary(*factors_.repair) + chosen_summary(factors_.provenance.chosen_for) +
                           error_summary(factors_.error) + seconds_.summary();
        if (arguments_.output && !is_standard_output(*arguments_.output)) {
            const bool repaired = factors_.repair->repair != Repair::none;
            const char* const which = !repaired                            ? ""
                                      : holds_raw_rows(*arguments_.output) ? " (rows before repair)"
                                                                           : " (rows after repair)";
            text += summary_line("written", arguments_.output->string() + which);
        }
        return text;
    }

    [[nodiscard]] Json summary_json(const RowSums& sums) {
        const std::string& chosen = factors_.provenance.chosen_for;
        return {{"schema", "hemi/factors/1"},
                {"renderer", factors_.provenance.renderer},
                {"patches", factors_.matrix.size()},
                {"groups", factors_.groups},
                {"entries", factors_.matrix.entries()},
                {"memory", factors_.matrix.memory_bytes()},
                {"row_sum", row_sum_json(sums)},
                {"environment_max", sums.environment_max},
                {"blocked_max", sums.blocked_max},
                {"repair", repair_json(*factors_.repair, seconds_["repair"])},
                {"chosen_for", chosen.empty() ? Json(nullptr) : Json(chosen)},
                {"error_estimate", error_json(factors_.error)},
                {"seconds", seconds_.json()}};
    }

    const FactorsArguments& arguments_;
    const Outputs& outputs_;
    const Terminal& terminal_;
    TerminalObserver observer_;
    RowCheckpoint* checkpoint_;
    Stopwatch total_;
    Seconds seconds_;
    std::optional<LoadedScene> loaded_;
    FormFactors factors_;
    Diagnostics diagnostics_;
};

void check_point_options(const FactorsArguments& arguments) {
    if (!is_scene(arguments)) {
        throw InvalidArgument(fmt::format("--from-point does not apply to {}, which is not a scene",
                                          arguments.scene.path.string()));
    }
    static const std::vector<std::string> allowed{"--from-point", "--patch-size",      "--patches-per-face",
                                                  "--two-sided",  "--skip-degenerate", "--json",
                                                  "--quiet",      "--verbose",         "--color"};
    for (const std::string& option : arguments.common.given) {
        if (std::find(allowed.begin(), allowed.end(), option) == allowed.end()) {
            throw InvalidArgument(
                fmt::format("{} does not apply to --from-point, which needs no rows", option));
        }
    }
}

} // namespace

ExitStatus run(const FactorsArguments& arguments, const Terminal& terminal) {
    const Outputs outputs = check_outputs(arguments);
    const auto output = factor_file(arguments);
    if (arguments.from_point) {
        check_point_options(arguments);
        const LoadedScene loaded = load_scene(arguments.scene, terminal);
        show_point(loaded.mesh, *arguments.from_point, loaded.names(), arguments.common.json);
        return ExitStatus::ok;
    }
    return with_checkpoint(output, arguments.rows.resume, terminal, [&](RowCheckpoint* checkpoint) {
        return Factors(arguments, outputs, terminal, checkpoint).run();
    });
}

} // namespace hemi::cli
