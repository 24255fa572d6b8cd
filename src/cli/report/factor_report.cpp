#include "cli/report/factor_report.hpp"

#include "cli/report/balance_report.hpp"
#include "cli/report/group_sizes.hpp"
#include "hemi/engine/leaks.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::cli {

namespace {

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

Report entries_report(const FormFactorMatrix& matrix, const std::string& remark = "") {
    Report report;
    report.add(
        "entries",
        fmt::format("{}{}, {}", count_text(matrix.entries()), remark, memory_text(matrix.memory_bytes())),
        {{"entries", matrix.entries()},
         {"memory", matrix.memory_bytes()},
         {"clusters", matrix.clusters() != nullptr}});
    return report;
}

/// What made rows that a file holds.
Report provenance_report(const Provenance& made) {
    const std::string_view preset = made.preset ? to_word(*made.preset) : "none";
    Report report;
    report.add("made by",
               fmt::format("{}, preset {}, resolution {}, {}, {}, seed {}", to_word(made.method), preset,
                           made.resolution, plural(made.eye_points, "sample point", "sample points"),
                           plural(made.shadow_rays, "shadow ray", "shadow rays"), made.seed),
               {{"preset", preset},
                {"method", to_word(made.method)},
                {"resolution", made.resolution},
                {"eye_points", made.eye_points},
                {"shadow_rays", made.shadow_rays},
                {"seed", made.seed}});
    report.add("renderer", made.renderer, {{"renderer", made.renderer}});
    return report;
}

/// Patches and area of every group of a file.
Report groups_report(const FormFactors& file) {
    const std::vector<GroupSize> sizes = group_sizes(file.areas, file.group_of, file.groups.size());
    Table table({"group", "patches", "area"});
    Json list = Json::array();
    for (std::size_t g = 0; g < sizes.size(); ++g) {
        const auto& [patches, area] = sizes[g];
        table.add({file.groups[g], count_text(patches), number_text(area)});
        list.push_back({{"name", file.groups[g]}, {"patches", patches}, {"area", area}});
    }
    return {fmt::format("\n{}", table.text()), {{"groups", list}}};
}

} // namespace

Report rows_report(const FormFactors& factors, const RowSums& sums, const EnclosureFinding& enclosure) {
    const FormFactorMatrix& matrix = factors.matrix;
    const double per_row = static_cast<double>(matrix.entries()) / std::max<double>(sums.known, 1.0);
    const std::string buried =
        sums.covered > 0 ? ", " + plural(sums.covered, "patch buried", "patches buried") : std::string();
    Report report;
    report.add("renderer", factors.provenance.renderer, {{"renderer", factors.provenance.renderer}});
    report.add("hemicubes", hemicubes_text(factors));
    report.add(entries_report(matrix, fmt::format(" ({:.0f} a row{})", per_row,
                                                  matrix.clusters() != nullptr ? ", in clusters" : "")));
    report.add(row_sum_report(sums));
    report.add("",
               fmt::format("share to the environment up to {}, to back faces up to {}{}",
                           number_text(sums.environment_max), number_text(sums.blocked_max), buried),
               {{"environment_max", sums.environment_max}, {"blocked_max", sums.blocked_max}});
    report.add("enclosure",
               std::string(enclosure.closed ? "closed" : "open") + (enclosure.declared ? " (declared)" : ""));
    return report;
}

Report prepared_rows_report(const FormFactors& factors, const RowSums& sums,
                            const EnclosureFinding& enclosure, double repair_seconds) {
    Report report = rows_report(factors, sums, enclosure);
    report.add(repair_report(factors, repair_seconds));
    report.add(chosen_report(factors.provenance.chosen_for));
    report.add(error_report(factors.error));
    return report;
}

Report stored_factors_report(const FormFactors& file) {
    const std::string hash = fmt::format("{:016x}", file.geometry_hash);
    const RowSums sums = row_sums(file.matrix);
    Report report;
    report.add(
        "patches",
        count_text(file.patches()) +
            (file.parts.any() ? fmt::format(", in {}", plural(file.matrix.size(), "part", "parts")) : ""),
        {{"patches", file.patches()}, {"parts", file.matrix.size()}});
    report.add("rows", fmt::format("{} computed", count_text(sums.known)), {{"rows", sums.known}});
    report.add(
        entries_report(file.matrix, file.matrix.clusters() != nullptr ? " (far patches in clusters)" : ""));
    report.add(provenance_report(file.provenance));
    report.add("enclosure", to_word(file.enclosure), {{"enclosure", to_word(file.enclosure)}});
    report.add("geometry", hash, {{"geometry_hash", hash}});
    report.add(row_sum_report(sums));
    report.add(chosen_report(file.provenance.chosen_for));
    report.json["chosen_for"] = file.provenance.chosen_for; // "" rather than null, as the file has it
    report.add(error_report(file.error));
    report.add(groups_report(file));
    return report;
}

Report matrix_report(const FormFactorMatrix& factors) {
    Report report;
    report.add("patches", count_text(factors.size()), {{"patches", factors.size()}});
    report.add(entries_report(factors));
    report.add(row_sum_report(row_sums(factors)));
    return report;
}

Report chosen_report(const std::string& chosen_for) {
    Report report;
    if (chosen_for.empty()) {
        report.json["chosen_for"] = nullptr;
    } else {
        report.add("chosen", chosen_for, {{"chosen_for", chosen_for}});
    }
    return report;
}

Report error_report(const std::optional<FactorErrorEstimate>& factors,
                    const std::optional<RadiosityErrorEstimate>& radiosity, bool say_radiosity) {
    Report report;
    report.json["error_estimate"] = nullptr;
    if (!factors) {
        return report;
    }
    if (radiosity && say_radiosity) {
        report.add("error", fmt::format("reflected radiosity: {:.2g} % rms, due to form factors (the size "
                                        "of the patches is not included)",
                                        100.0 * radiosity->rms));
    }
    Json json{{"rows_compared", factors->sampled},
              {"factor", {{"rms", factors->rms}, {"max", factors->max}}},
              {"row", {{"rms", factors->row_rms}, {"max", factors->row_max}}}};
    if (radiosity) {
        json["radiosity"] = {{"rms", radiosity->rms}};
    }
    report.add(
        radiosity ? "" : "error",
        fmt::format("form factors, estimated from {}: {:.2g} rms, {:.2g} max; row (2-norm) {:.2g} rms, "
                    "{:.2g} max",
                    plural(factors->sampled, "row", "rows"), factors->rms, factors->max, factors->row_rms,
                    factors->row_max),
        {{"error_estimate", json}});
    return report;
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
                               number_text(factors.environment(shown[k])), towards_text(directions[k]));
    }
    terminal.error(message);
}

void report_no_fronts(const RowSums& sums, const FormFactorMatrix& factors, const Terminal& terminal) {
    if (factors.size() > 1 && sums.known == factors.size() && sums.max <= 0.0) {
        terminal.warn(
            "no patch sees the front of another: all factors are 0. If this is no lone convex body, its "
            "faces "
            "are the wrong way round: --flip turns all of them, --orient in each body to its inside");
    }
}

void report_buried(const RowSums& sums, const Terminal& terminal) {
    if (sums.covered > 0) {
        terminal.warn(
            fmt::format("{} buried: the centre lies under or inside other geometry (`hemi check` lists them)",
                        plural(sums.covered, "patch is", "patches are")));
    }
}

} // namespace hemi::cli
