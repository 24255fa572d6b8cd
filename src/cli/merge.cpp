#include "cli/commands.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/seconds.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/pipeline/factor_parts.hpp"

#include <fmt/format.h>

namespace hemi::cli {

ExitStatus run(const MergeArguments& arguments, const Terminal& terminal) {
    Outputs outputs;
    for (const std::filesystem::path& part : arguments.parts) {
        outputs.keep(part);
    }
    outputs.add("-o", *arguments.output, {".hff"});
    Seconds seconds({"merge", "repair"});
    TerminalObserver observer(terminal);
    const Stopwatch merge_watch;
    FormFactors factors = merge_factor_parts(arguments.parts, arguments.rows.factors, observer);
    estimate_error(factors);
    io::write_hff(*arguments.output, factors);
    seconds["merge"] = merge_watch.seconds();
    const Stopwatch repair_watch;
    prepare_form_factors(factors, arguments.rows.factors.repair, observer);
    seconds["repair"] = repair_watch.seconds();
    const double max_row_error = arguments.rows.max_row_error;
    const RowSums sums = row_sums(factors.matrix);
    const EnclosureFinding enclosure = find_leaks(factors, max_row_error);
    Report report;
    report.add("merged", plural(arguments.parts.size(), "part", "parts"),
               {{"merged", arguments.parts.size()}, {"patches", factors.patches()}});
    report.add(prepared_rows_report(factors, sums, enclosure, seconds["repair"]));
    report.add(seconds.report());
    report.add("written", arguments.output->string() + " (rows before repair)");
    report.select("hemi/merge/1", {"renderer", "patches", "merged", "entries", "memory", "row_sum",
                                   "environment_max", "blocked_max", "repair", "error_estimate", "seconds"});
    outputs.show(report, arguments.common.json, terminal);
    const PatchNames names{factors.groups, factors.group_of, {}, factors.parts.patch_of};
    report_no_fronts(sums, factors.matrix, terminal);
    report_buried(sums, terminal);
    report_leaks(enclosure, factors.matrix, names, nullptr, max_row_error, terminal);
    return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

} // namespace hemi::cli
