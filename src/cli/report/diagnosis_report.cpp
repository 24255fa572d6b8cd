#include "cli/report/diagnosis_report.hpp"

#include "cli/report/balance_report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::cli {

namespace {

/// A kind of finding.
struct Section {
    const char* key;   ///< in JSON
    const char* title; ///< in text
    const std::vector<PatchFinding>* findings;
    std::string explanation; ///< what it means and what to do; what the share is
    bool with_share;
};

std::string leak_explanation(const Diagnosis& diagnosis) {
    if (diagnosis.enclosure == EnclosureVerdict::nearly_closed) {
        return "they see the environment, most others do not; if the scene is meant to be closed, there are "
               "gaps near them, or they face the outside. Environment share";
    }
    if (diagnosis.sums.max <= 0.0) {
        return "no patch sees any other: all normals may be reversed. Environment share";
    }
    return "they see the environment: there are gaps near them, or they face the outside. Environment share";
}

/// Sections of patches, in the order in which they are reported.
std::vector<Section> sections(const Diagnosis& diagnosis) {
    return {
        {"leaks", "leaks", &diagnosis.leaks, leak_explanation(diagnosis), true},
        {"covered", "buried", &diagnosis.buried,
         "their centre lies under or inside other geometry; nothing reaches them", false},
        {"blocked", "back faces", &diagnosis.back_faces,
         diagnosis.reversed.empty()
             ? "they meet back faces: a surface cuts through them, or an open body is near. Back-face share"
             : "they meet back faces: see reversed normals. Back-face share",
         true},
        {"straddled", "partly buried", &diagnosis.partly_buried,
         "other geometry stands on part of them; use smaller patches, or make its outline an edge of the "
         "mesh. Share that is buried",
         true},
        {"outside", "outside", &diagnosis.outside,
         "they are outside of what the others enclose, and see the environment and one another alone; what "
         "they meet there is not judged. Environment share",
         true},
        {"near", "close surfaces", &diagnosis.close,
         "a surface is close above them; the preset default takes up to 16 sample points there, exact up to "
         "64, and smaller patches help. Gap in patch sizes",
         true}};
}

/// A line, the worst patches below it, and the section's key.
Report section_report(const Section& section, const PatchNames& names) {
    const std::vector<PatchFinding>& findings = *section.findings;
    std::string text =
        findings.empty()
            ? summary_line(section.title, "none")
            : summary_line(section.title, fmt::format("{}: {}", plural(findings.size(), "patch", "patches"),
                                                      section.explanation));
    Json worst = Json::array();
    for (std::size_t k = 0; k < std::min(Diagnosis::shown, findings.size()); ++k) {
        const PatchFinding& finding = findings[k];
        Json patch = names.json(finding.patch);
        text += fmt::format("    {}", names.describe(finding.patch));
        if (section.with_share) {
            text += fmt::format(": {}", number_text(finding.share));
            patch["share"] = finding.share;
        }
        text += towards_text(finding.towards) + "\n";
        if (const auto& towards = finding.towards) {
            patch["towards"] = {towards->x, towards->y, towards->z};
        }
        worst.push_back(patch);
    }
    if (findings.size() > Diagnosis::shown) {
        text += fmt::format("    and {} more\n", count_text(findings.size() - Diagnosis::shown));
    }
    return {text, {{section.key, {{"count", findings.size()}, {"worst", worst}}}}};
}

Report enclosure_report(const Diagnosis& diagnosis) {
    const RowSums& sums = diagnosis.sums;
    std::string text(to_word(diagnosis.enclosure));
    text += diagnosis.declared ? " (declared)" : " (from the rows)";
    if (sums.leaking > 0) {
        text += fmt::format(": {} of {} the environment", count_text(sums.leaking),
                            sums.known == 1 ? "1 patch sees" : count_text(sums.known) + " patches see");
    }
    Report report;
    report.add("enclosure", text,
               {{"enclosure", to_word(diagnosis.enclosure)},
                {"declared", diagnosis.declared},
                {"leaking", sums.leaking}});
    return report;
}

/// Groups with reversed normals; the text needs all rows.
Report reversed_report(const Diagnosis& diagnosis, const PatchNames& names) {
    const std::vector<ReversedGroup>& reversed = diagnosis.reversed;
    std::string text = summary_line(
        "reversed", reversed.empty() ? "none"
                                     : "reversed normals: no patch sees the front of these surfaces, but "
                                       "others meet their backs: reverse the vertex order, or set two_sided");
    Json list = Json::array();
    for (std::size_t k = 0; k < reversed.size(); ++k) {
        const ReversedGroup& group = reversed[k];
        const std::string& name = names.groups[group.group];
        const std::uint32_t surfaces = group.surfaces;
        list.push_back({{"group", name},
                        {"surfaces", surfaces > 0 ? Json(surfaces) : Json(nullptr)},
                        {"patches", group.patches}});
        if (k < Diagnosis::shown) {
            text += fmt::format("    {}: {}{}\n", name,
                                surfaces > 0 ? plural(surfaces, "surface", "surfaces") + ", " : "",
                                plural(group.patches, "patch", "patches"));
        }
    }
    if (reversed.size() > Diagnosis::shown) {
        text += fmt::format("    and {} more groups\n", count_text(reversed.size() - Diagnosis::shown));
    }
    return {diagnosis.all_known ? text : "", {{"turned", list}}};
}

Report never_visible_report(const Diagnosis& diagnosis, const PatchNames& names) {
    const Section section{"unseen", "never visible", &diagnosis.never_visible, "no patch sees them", false};
    if (diagnosis.all_known) {
        return section_report(section, names);
    }
    Report report;
    report.add(section.title, "not known: some rows were not computed", {{section.key, nullptr}});
    return report;
}

Report pairs_report(const Reciprocity& pairs, const PatchNames& names) {
    Report report;
    if (pairs.pairs == 0) {
        report.add("reciprocity", "no pairs", {{"reciprocity", nullptr}});
        return report;
    }
    report.add("reciprocity",
               fmt::format("rms {:.3g}, relative rms {:.3g}, over {}", pairs.rms, pairs.relative_rms,
                           plural(pairs.pairs, "pair", "pairs")),
               {{"reciprocity", reciprocity_json(pairs, names.patch_of)}});
    report.add("", fmt::format("worst {:.3g}: {} and {}", pairs.max, names.describe(pairs.worst_i),
                               names.describe(pairs.worst_j)));
    return report;
}

} // namespace

Report diagnosis_report(const Diagnosis& diagnosis, const FormFactors& factors, const PatchNames& names,
                        double max_row_error, double repair_seconds, const Report& mended) {
    const RowSums& sums = diagnosis.sums;
    Report report = mended;
    report.json["renderer"] = factors.provenance.renderer;
    report.add("rows",
               fmt::format("{} of {} computed", count_text(sums.known), count_text(names.group_of.size())),
               {{"patches", factors.patches()}, {"parts", factors.matrix.size()}, {"rows", sums.known}});
    report.add(row_sum_report(sums));
    report.json.update({{"environment_max", sums.environment_max}, {"blocked_max", sums.blocked_max}});
    report.add("row balance",
               fmt::format("row sum + environment share + back-face share differs from 1 by up to {:.3g}",
                           sums.balance_error_max),
               {{"balance_error", sums.balance_error_max}});
    report.add(repair_report(factors, repair_seconds));
    report.add(
        "bounds",
        fmt::format("largest factor {}, {} above 1", number_text(diagnosis.largest_factor),
                    diagnosis.outside_bounds == 0
                        ? std::string("none")
                        : plural(diagnosis.outside_bounds, "factor or row sum", "factors or row sums")),
        {{"largest_factor", diagnosis.largest_factor}, {"above_one", diagnosis.outside_bounds}});
    report.add(pairs_report(diagnosis.reciprocity, names));
    report.add(enclosure_report(diagnosis));
    for (const Section& section : sections(diagnosis)) {
        const bool applies =
            section.findings != &diagnosis.leaks || diagnosis.enclosure != EnclosureVerdict::open;
        const Report found = section_report(section, names);
        report.text += applies ? found.text : "";
        report.json.update(found.json);
    }
    report.add(reversed_report(diagnosis, names));
    report.add(never_visible_report(diagnosis, names));
    report.add("result",
               diagnosis.failures.empty() ? fmt::format("within {}", max_row_error)
                                          : fmt::format("out of tolerance ({}): {}", max_row_error,
                                                        fmt::join(diagnosis.failures, "; ")),
               {{"max_row_error", max_row_error},
                {"failures", diagnosis.failures},
                {"ok", diagnosis.failures.empty()}});
    report.select("hemi/check/1", {"renderer",
                                   "imprint",
                                   "patches",
                                   "parts",
                                   "rows",
                                   "row_sum",
                                   "environment_max",
                                   "blocked_max",
                                   "balance_error",
                                   "largest_factor",
                                   "above_one",
                                   "reciprocity",
                                   "repair",
                                   "enclosure",
                                   "declared",
                                   "leaking",
                                   "leaks",
                                   "covered",
                                   "blocked",
                                   "straddled",
                                   "outside",
                                   "near",
                                   "turned",
                                   "unseen",
                                   "max_row_error",
                                   "failures",
                                   "ok"});
    return report;
}

} // namespace hemi::cli
