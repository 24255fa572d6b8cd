#include "cli/repair_rows.hpp"

#include "cli/pipeline.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hemi::cli {

namespace {

/// By the rule that unoccluded factors are found with.
double unoccluded_error(const io::FactorFile& file) {
    constexpr double exact_rule = 3e-5;
    return file.preset == "exact" ? exact_rule : RepairSettings().unoccluded_error;
}

Json errors_json(const RowImbalance& rows, const Reciprocity& pairs) {
    return {{"row_error", {{"max", rows.max}, {"rms", rows.rms}}},
            {"reciprocity", pairs.pairs > 0 ? reciprocity_json(pairs) : Json(nullptr)}};
}

} // namespace

std::string repair_name(Repair repair) {
    switch (repair) {
    case Repair::reciprocity:
        return "reciprocity";
    case Repair::closure:
        return "closure";
    case Repair::none:
        break;
    }
    return "none";
}

RowRepair repair_rows(io::FactorFile& file, std::optional<Repair> wanted) {
    const Stopwatch watch;
    const Repair chosen = wanted.value_or(file.factors.has_visibility() ? Repair::closure : Repair::none);
    RowRepair result;
    result.report = repair(file.factors, file.areas, chosen, {.unoccluded_error = unoccluded_error(file)});
    result.seconds = watch.seconds();
    return result;
}

std::string repair_summary(const RowRepair& repair) {
    const RepairReport& report = repair.report;
    if (report.repair == Repair::none) {
        return summary_line("repair",
                            fmt::format("none; rows miss balance by up to {:.2g}, reciprocity by "
                                        "{:.2g} (relative rms)",
                                        report.row_error_before.max, report.reciprocity_before.relative_rms));
    }
    std::string what = repair_name(report.repair);
    if (report.repair == Repair::closure) {
        what += fmt::format(", {}", plural(report.iterations, "iteration", "iterations"));
        if (report.at_zero + report.at_unoccluded > 0) {
            what += fmt::format(", {} held at 0 and {} at the unoccluded factor",
                                plural(report.at_zero, "pair", "pairs"), count_text(report.at_unoccluded));
        }
        what += fmt::format(", largest change {:.2g} of a factor", report.largest_change);
    }
    if (report.added > 0) {
        what += fmt::format(", {} added", plural(report.added, "entry", "entries"));
    }
    return summary_line("repair", what) +
           summary_line("", fmt::format("rows miss balance by up to {:.2g} (before {:.2g}), reciprocity by "
                                        "{:.2g} (before {:.2g})",
                                        report.row_error_after.max, report.row_error_before.max,
                                        report.reciprocity_after.relative_rms,
                                        report.reciprocity_before.relative_rms));
}

Json repair_json(const RowRepair& repair) {
    const RepairReport& report = repair.report;
    return {{"name", repair_name(report.repair)},
            {"before", errors_json(report.row_error_before, report.reciprocity_before)},
            {"after", errors_json(report.row_error_after, report.reciprocity_after)},
            {"iterations", report.iterations},
            {"passes", report.passes},
            {"at_zero", report.at_zero},
            {"at_unoccluded", report.at_unoccluded},
            {"added", report.added},
            {"largest_change", report.largest_change},
            {"seconds", repair.seconds}};
}

} // namespace hemi::cli
