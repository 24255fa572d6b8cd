#include "cli/report/factor_report.hpp"

#include "hemi/engine/leaks.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hemi::cli {

namespace {

Json imbalance_json(const RowImbalance& rows, const Reciprocity& pairs) {
    return {{"row_error", {{"max", rows.max}, {"rms", rows.rms}}},
            {"reciprocity", pairs.pairs > 0 ? reciprocity_json(pairs) : Json(nullptr)}};
}

std::string hemicubes_text(const FormFactors& factors) {
    const Provenance& made = factors.provenance;
    std::string text = fmt::format("resolution {}, {}", made.resolution,
                                   plural(made.eye_points, "sample point", "sample points"));
    text += made.shadow_rays > 0 ? ", " + plural(made.shadow_rays, "shadow ray", "shadow rays") : "";
    text += fmt::format(", seed {}", made.seed);
    if (factors.work.from_file) {
        return text + "; rows from a file";
    }
    if (factors.work.hemicubes > 0) {
        text += fmt::format(
            "; {} in {}: {:.0f}/s", count_text(factors.work.hemicubes), seconds_text(factors.work.seconds),
            static_cast<double>(factors.work.hemicubes) / std::max(factors.work.seconds, 1e-9));
    }
    return text;
}

} // namespace

std::string scene_summary(const PatchMesh& mesh) {
    return summary_line("scene", fmt::format("{}, {}, {}", plural(mesh.size(), "patch", "patches"),
                                             plural(mesh.surfaces().size(), "surface", "surfaces"),
                                             plural(mesh.groups().size(), "group", "groups")));
}

std::string rows_summary(const FormFactors& factors, const RowSums& sums, const EnclosureFinding& enclosure) {
    const FormFactorMatrix& matrix = factors.matrix;
    const double per_row = static_cast<double>(matrix.entries()) / std::max<double>(sums.known, 1.0);
    std::string text = summary_line("renderer", factors.provenance.renderer);
    text += summary_line("hemicubes", hemicubes_text(factors));
    text += summary_line("entries", fmt::format("{} ({:.0f} a row), {}", count_text(matrix.entries()),
                                                per_row, memory_text(matrix.memory_bytes())));
    text += summary_line("row sums", row_sum_text(sums));
    text += summary_line("", fmt::format("share to the environment up to {}, to back faces up to {}{}",
                                         number_text(sums.environment_max), number_text(sums.blocked_max),
                                         sums.covered > 0
                                             ? ", " + plural(sums.covered, "patch buried", "patches buried")
                                             : std::string()));
    return text + summary_line("enclosure", std::string(enclosure.closed ? "closed" : "open") +
                                                (enclosure.declared ? " (declared)" : ""));
}

std::string repair_summary(const RepairReport& report) {
    if (report.repair == Repair::none) {
        return summary_line("repair",
                            fmt::format("none; largest row imbalance {:.2g}, reciprocity error {:.2g} "
                                        "(relative, rms)",
                                        report.row_error_before.max, report.reciprocity_before.relative_rms));
    }
    std::string what(to_word(report.repair));
    if (report.repair == Repair::closure) {
        what += fmt::format(", {}; largest relative change of a factor {:.2g}",
                            plural(report.iterations, "iteration", "iterations"), report.largest_change);
        if (report.at_zero + report.at_unoccluded > 0) {
            what += fmt::format("; {} limited at 0, {} at the unoccluded factor",
                                plural(report.at_zero, "pair", "pairs"), count_text(report.at_unoccluded));
        }
    }
    if (report.added > 0) {
        what += fmt::format("; {} added", plural(report.added, "entry", "entries"));
    }
    return summary_line("repair", what) +
           summary_line("",
                        fmt::format("largest row imbalance {:.2g} (before {:.2g}), reciprocity error {:.2g} "
                                    "(before {:.2g})",
                                    report.row_error_after.max, report.row_error_before.max,
                                    report.reciprocity_after.relative_rms,
                                    report.reciprocity_before.relative_rms));
}

Json repair_json(const RepairReport& report, double seconds) {
    return {{"name", to_word(report.repair)},
            {"before", imbalance_json(report.row_error_before, report.reciprocity_before)},
            {"after", imbalance_json(report.row_error_after, report.reciprocity_after)},
            {"iterations", report.iterations},
            {"passes", report.passes},
            {"at_zero", report.at_zero},
            {"at_unoccluded", report.at_unoccluded},
            {"added", report.added},
            {"largest_change", report.largest_change},
            {"seconds", seconds}};
}

std::string chosen_summary(const std::string& chosen_for) {
    return chosen_for.empty() ? "" : summary_line("chosen", chosen_for);
}

std::string error_summary(const std::optional<FactorErrorEstimate>& factors,
                          const std::optional<RadiosityErrorEstimate>& radiosity) {
    if (!factors) {
        return "";
    }
    std::string text;
    if (radiosity) {
        text += summary_line("error",
                             fmt::format("reflected radiosity: {:.2g} % rms, due to form factors (the size "
                                         "of the patches is not included)",
                                         100.0 * radiosity->rms));
    }
    text += summary_line(
        radiosity ? "" : "error",
        fmt::format("form factors, estimated from {}: {:.2g} rms, {:.2g} max; row (2-norm) {:.2g} rms, "
                    "{:.2g} max",
                    plural(factors->sampled, "row", "rows"), factors->rms, factors->max, factors->row_rms,
                    factors->row_max));
    return text;
}

Json error_json(const std::optional<FactorErrorEstimate>& factors,
                const std::optional<RadiosityErrorEstimate>& radiosity) {
    if (!factors) {
        return nullptr;
    }
    Json json{{"rows_compared", factors->sampled},
              {"factor", {{"rms", factors->rms}, {"max", factors->max}}},
              {"row", {{"rms", factors->row_rms}, {"max", factors->row_max}}}};
    if (radiosity) {
        json["radiosity"] = {{"rms", radiosity->rms}};
    }
    return json;
}

void report_leaks(const EnclosureFinding& finding, const FormFactorMatrix& factors, const PatchNames& names,
                  const PatchMesh* mesh, double max_row_error, const Terminal& terminal) {
    if (finding.leaks.empty()) {
        return;
    }
    const auto shown = std::span(finding.leaks).first(std::min<std::size_t>(3, finding.leaks.size()));
    const auto directions =
        mesh != nullptr ? leak_directions(*mesh, shown) : std::vector<std::optional<Vec3>>(shown.size());
    std::string message =
        fmt::format("the enclosure is declared closed, but {} more than {} to the environment. Worst: ",
                    finding.leaks.size() == 1 ? std::string("1 patch loses")
                                              : plural(finding.leaks.size(), "patch", "patches") + " lose",
                    max_row_error);
    for (std::size_t k = 0; k < shown.size(); ++k) {
        message += fmt::format("{}{} {}{}", k == 0 ? "" : "; ", names.describe(shown[k]),
                               number_text(factors.row(shown[k]).environment), towards_text(directions[k]));
    }
    terminal.error(message);
}

void report_buried(const RowSums& sums, const Terminal& terminal) {
    if (sums.covered > 0) {
        terminal.warn(
            fmt::format("{} buried: the centre lies under or inside other geometry (`hemi check` lists them)",
                        plural(sums.covered, "patch is", "patches are")));
    }
}

} // namespace hemi::cli
