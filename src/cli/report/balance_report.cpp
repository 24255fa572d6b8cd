#include "cli/report/balance_report.hpp"

#include <fmt/format.h>

namespace hemi::cli {

namespace {

Json imbalance_json(const RowImbalance& rows, const Reciprocity& pairs,
                    std::span<const std::uint32_t> patch_of) {
    return {{"row_error", {{"max", rows.max}, {"rms", rows.rms}}},
            {"reciprocity", pairs.pairs > 0 ? reciprocity_json(pairs, patch_of) : Json(nullptr)}};
}

/// What was enforced, and how much that changed.
std::string change_text(const RepairReport& repair) {
    std::string text(to_word(repair.repair));
    if (repair.repair == Repair::closure) {
        text += fmt::format(", {}; largest relative change of a factor {:.2g}",
                            plural(repair.iterations, "iteration", "iterations"), repair.largest_change);
        if (repair.at_zero + repair.at_unoccluded > 0) {
            text += fmt::format("; {} limited at 0, {} at the unoccluded factor",
                                plural(repair.at_zero, "pair", "pairs"), count_text(repair.at_unoccluded));
        }
    }
    if (repair.added > 0) {
        text += fmt::format("; {} added", plural(repair.added, "entry", "entries"));
    }
    return text;
}

} // namespace

Report row_sum_report(const RowSums& sums) {
    Report report;
    if (sums.known == 0) {
        report.add("row sums", "no rows computed",
                   {{"row_sum", {{"min", nullptr}, {"max", nullptr}, {"mean", nullptr}}}});
    } else {
        report.add("row sums",
                   fmt::format("min {:.6f}, mean {:.6f}, max {:.6f}", sums.min, sums.mean, sums.max),
                   {{"row_sum", {{"min", sums.min}, {"max", sums.max}, {"mean", sums.mean}}}});
    }
    return report;
}

Json reciprocity_json(const Reciprocity& reciprocity, std::span<const std::uint32_t> patch_of) {
    const auto number = [patch_of](std::uint32_t patch) {
        return patch_of.empty() ? patch : patch_of[patch];
    };
    return {{"rms", reciprocity.rms},
            {"max", reciprocity.max},
            {"relative_rms", reciprocity.relative_rms},
            {"relative_max", reciprocity.relative_max},
            {"worst",
             reciprocity.pairs > 0 ? Json{number(reciprocity.worst_i), number(reciprocity.worst_j)} : Json()},
            {"pairs", reciprocity.pairs}};
}

Report repair_report(const FormFactors& factors, double seconds) {
    const RepairReport& repair = *factors.repair;
    const std::span<const std::uint32_t> patch_of = factors.parts.patch_of;
    const RowImbalance& rows_before = repair.row_error_before;
    const RowImbalance& rows_after = repair.row_error_after;
    const Reciprocity& pairs_before = repair.reciprocity_before;
    const Reciprocity& pairs_after = repair.reciprocity_after;
    Report report;
    if (factors.matrix.clusters() != nullptr) {
        report.add("repair", fmt::format("none; far patches in clusters, near pairs reciprocal; largest row "
                                         "imbalance {:.2g}",
                                         rows_before.max));
    } else if (repair.repair == Repair::none) {
        report.add("repair", fmt::format("none; largest row imbalance {:.2g}, reciprocity error {:.2g} "
                                         "(relative, rms)",
                                         rows_before.max, pairs_before.relative_rms));
    } else {
        report.add("repair", change_text(repair));
        report.add("", fmt::format("largest row imbalance {:.2g} (before {:.2g}), reciprocity error {:.2g} "
                                   "(before {:.2g})",
                                   rows_after.max, rows_before.max, pairs_after.relative_rms,
                                   pairs_before.relative_rms));
    }
    report.json["repair"] = {{"name", to_word(repair.repair)},
                             {"before", imbalance_json(rows_before, pairs_before, patch_of)},
                             {"after", imbalance_json(rows_after, pairs_after, patch_of)},
                             {"iterations", repair.iterations},
                             {"passes", repair.passes},
                             {"at_zero", repair.at_zero},
                             {"at_unoccluded", repair.at_unoccluded},
                             {"added", repair.added},
                             {"largest_change", repair.largest_change},
                             {"seconds", seconds}};
    return report;
}

} // namespace hemi::cli
