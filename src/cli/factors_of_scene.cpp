#include "cli/cluster_settings.hpp"
#include "cli/factor_source.hpp"
#include "cli/factors.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/factor_tables.hpp"
#include "cli/report/scene_report.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/vtp_file.hpp"
#include "hemi/pipeline/accuracy.hpp"

#include <fmt/format.h>

namespace hemi::cli {

namespace {

/// `.hff` holds the rows as they were computed; repair is redone when it is read.
bool holds_raw_rows(const std::filesystem::path& path) {
    return extension_of(path) == ".hff";
}

/// --row: computes that row alone.
ExitStatus one_row(const FactorsArguments& arguments, const Terminal& terminal) {
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    const std::uint32_t row = *arguments.row;
    FactorSettings settings = arguments.rows.factors;
    if (settings.repair.value_or(Repair::none) != Repair::none) {
        throw InvalidArgument(
            "--repair needs all rows, but --row computes one; store them first with -o FILE.hff");
    }
    if (row >= loaded.patches().size()) {
        throw InvalidArgument(fmt::format("--row {}: the scene has {}, counted from 0", row,
                                          plural(loaded.patches().size(), "patch", "patches")));
    }
    settings.estimate_error = false;
    TerminalObserver observer(terminal);
    std::vector<std::uint32_t> parts{row};
    if (loaded.as_read) {
        parts.clear();
        const std::vector<std::uint32_t>& patch_of = loaded.as_read->parts.patch_of;
        for (std::uint32_t part = 0; part < patch_of.size(); ++part) {
            if (patch_of[part] == row) {
                parts.push_back(part);
            }
        }
    }
    FormFactors factors = compute_raw_form_factors(loaded.scene, loaded.mesh, parts, settings, observer);
    factors.parts = loaded.parts();
    if (arguments.patches) {
        loaded.write_patches(*arguments.patches);
    }
    show(row_report(merge_parts(std::move(factors)), row, loaded.patch_names()), arguments.common.json);
    return ExitStatus::ok;
}

FormFactors compute(const FactorsArguments& arguments, const LoadedScene& loaded, const Terminal& terminal,
                    RowCheckpoint* checkpoint, Seconds& seconds) {
    TerminalObserver observer(terminal);
    const FactorSettings& settings = arguments.rows.factors;
    if (arguments.rows.error_target) {
        TargetResult found =
            factors_to_target(loaded.scene, loaded.mesh, settings, *arguments.rows.error_target, observer);
        seconds["search"] = found.search_seconds;
        seconds["factors"] = found.factor_seconds;
        found.raw.parts = loaded.parts();
        return std::move(found.raw);
    }
    const Stopwatch watch;
    FormFactors factors = compute_raw_form_factors(loaded.scene, loaded.mesh, all_patches(loaded.mesh.size()),
                                                   settings, observer, checkpoint);
    seconds["estimate"] = factors.work.reference_seconds;
    seconds["factors"] = watch.seconds() - factors.work.reference_seconds;
    factors.parts = loaded.parts();
    return factors;
}

/// The rows are complete: what was kept of them is not needed any more.
void discard(RowCheckpoint* checkpoint) {
    if (checkpoint != nullptr) {
        checkpoint->discard();
    }
}

/// @param zone  the scene's name, where it is a zone
/// @param max_memory  bytes that factors of single patches may take, where they stand in clusters
void write_prepared(const std::filesystem::path& path, const FormFactors& factors, const LoadedScene& loaded,
                    const std::string& zone, std::uint64_t max_memory, Diagnostics& diagnostics) {
    if (extension_of(path) == ".vtp") {
        io::write_vtp(path, loaded.mesh, io::factor_arrays(factors));
    } else {
        const std::vector<double> emissivity = emissivities(loaded.patches(), loaded.scene.materials);
        FormFactors merged = merge_parts(factors);
        if (extension_of(path) != ".idf") { // which has sums over groups
            expand_clusters(merged, path, max_memory, diagnostics);
        }
        io::write_factors(path, merged, {emissivity, zone}, diagnostics);
    }
}

/// The summary of all rows of a scene.
void show_summary(const FactorsArguments& arguments, const FormFactors& factors, const LoadedScene& loaded,
                  const Report& rows, const Seconds& seconds, const Outputs& outputs,
                  const Terminal& terminal) {
    Report report = scene_size_report(loaded);
    report.add(rows);
    report.add(seconds.report());
    if (arguments.output && !is_standard_output(*arguments.output)) {
        const bool repaired = factors.repair->repair != Repair::none;
        const char* const which = !repaired                           ? ""
                                  : holds_raw_rows(*arguments.output) ? " (rows before repair)"
                                                                      : " (rows after repair)";
        report.add("written", arguments.output->string() + which);
    }
    report.select("hemi/factors/1",
                  {"renderer", "patches", "parts", "groups", "entries", "memory", "clusters", "row_sum",
                   "environment_max", "blocked_max", "repair", "chosen_for", "error_estimate", "seconds"});
    outputs.show(report, arguments.common.json, terminal);
}

ExitStatus all_rows(const FactorsArguments& arguments, const Outputs& outputs, const Terminal& terminal,
                    RowCheckpoint* checkpoint) {
    Seconds seconds = factor_stages();
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    seconds["load"] = loaded.seconds;
    FormFactors factors = compute(arguments, loaded, terminal, checkpoint, seconds);
    Diagnostics diagnostics;
    const bool raw = writes_rows(arguments) && holds_raw_rows(*arguments.output);
    if (raw) {
        estimate_error(factors);
        io::write_factors(*arguments.output, factors, {}, diagnostics);
        discard(checkpoint);
    }
    const Stopwatch repair_watch;
    TerminalObserver observer(terminal);
    prepare_form_factors(factors, arguments.rows.factors.repair, observer);
    seconds["repair"] = repair_watch.seconds();
    if (arguments.patches) {
        loaded.write_patches(*arguments.patches, factors.matrix);
    }
    if (writes_rows(arguments) && !raw) {
        const bool is_zone = arguments.scene.also.empty() && extension_of(arguments.scene.path) == ".epjson";
        write_prepared(*arguments.output, factors, loaded, is_zone ? loaded.scene.name : "",
                       memory_limit(arguments.rows.factors), diagnostics);
    }
    terminal.warn(diagnostics);
    discard(checkpoint);
    const double max_row_error = arguments.rows.max_row_error;
    const RowSums sums = row_sums(factors.matrix);
    const EnclosureFinding enclosure = find_leaks(factors, max_row_error);
    if (arguments.by_group) {
        show_groups(arguments, factors, seconds);
    } else {
        const Report rows = prepared_rows_report(factors, sums, enclosure, seconds["repair"]);
        show_summary(arguments, factors, loaded, rows, seconds, outputs, terminal);
    }
    report_no_fronts(sums, factors.matrix, terminal);
    report_buried(sums, terminal);
    report_leaks(enclosure, factors.matrix, loaded.names(), &loaded.mesh, max_row_error, terminal);
    return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

} // namespace

ExitStatus factors_of_scene(const FactorsArguments& arguments, const Outputs& outputs,
                            const Terminal& terminal) {
    if (arguments.row) {
        return one_row(arguments, terminal);
    }
    return with_checkpoint(
        keeps_rows(arguments) ? arguments.output : std::nullopt, arguments.rows.resume, terminal,
        [&](RowCheckpoint* checkpoint) { return all_rows(arguments, outputs, terminal, checkpoint); });
}

} // namespace hemi::cli
