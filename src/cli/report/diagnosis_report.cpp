#include "cli/report/diagnosis_report.hpp"

#include "cli/report/factor_report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hemi::cli {

namespace {

/// A kind of finding, as text and JSON have it.
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
               "gaps "
               "near them, or they face the outside. Environment share";
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
         "mesh. "
         "Share that is buried",
         true},
        {"near", "close surfaces", &diagnosis.close,
         "a surface is close above them; the preset default takes up to 16 sample points there, exact up to "
         "64, "
         "and smaller patches help. Gap in patch sizes",
         true}};
}

std::string section_text(const Section& section, const PatchNames& names) {
    const std::vector<PatchFinding>& findings = *section.findings;
    if (findings.empty()) {
        return summary_line(section.title, "none");
    }
    std::string text =
        summary_line(section.title,
                     fmt::format("{}: {}", plural(findings.size(), "patch", "patches"), section.explanation));
    for (std::size_t k = 0; k < std::min(Diagnosis::shown, findings.size()); ++k) {
        text += "    " + names.describe(findings[k].patch);
        text += section.with_share ? ": " + number_text(findings[k].share) : "";
        text += towards_text(findings[k].towards) + "\n";
    }
    if (findings.size() > Diagnosis::shown) {
        text += fmt::format("    and {} more\n", count_text(findings.size() - Diagnosis::shown));
    }
    return text;
}

Json section_json(const Section& section, const PatchNames& names) {
    const std::vector<PatchFinding>& findings = *section.findings;
    Json worst = Json::array();
    for (std::size_t k = 0; k < std::min(Diagnosis::shown, findings.size()); ++k) {
        Json patch = names.json(findings[k].patch);
        if (section.with_share) {
            patch["share"] = findings[k].share;
        }
        if (const auto& towards = findings[k].towards) {
            patch["towards"] = {towards->x, towards->y, towards->z};
        }
        worst.push_back(patch);
    }
    return {{"count", findings.size()}, {"worst", worst}};
}

Section never_visible_section(const Diagnosis& diagnosis) {
    return {"unseen", "never visible", &diagnosis.never_visible, "no patch sees them", false};
}

std::string enclosure_text(const Diagnosis& diagnosis) {
    std::string text(to_word(diagnosis.enclosure));
    text += diagnosis.declared ? " (declared)" : " (from the rows)";
    if (diagnosis.sums.leaking > 0) {
        text += fmt::format(": {} of {} the environment", count_text(diagnosis.sums.leaking),
                            diagnosis.sums.known == 1 ? "1 patch sees"
                                                      : count_text(diagnosis.sums.known) + " patches see");
    }
    return text;
}

std::string reversed_text(const Diagnosis& diagnosis, const PatchNames& names) {
    constexpr const char* title = "reversed";
    if (diagnosis.reversed.empty()) {
        return summary_line(title, "none");
    }
    std::string text =
        summary_line(title, "reversed normals: no patch sees the front of these surfaces, but others "
                            "meet their backs: reverse the vertex order, or set two_sided");
    for (std::size_t k = 0; k < std::min(Diagnosis::shown, diagnosis.reversed.size()); ++k) {
        const ReversedGroup& group = diagnosis.reversed[k];
        text += fmt::format("    {}: {}{}\n", names.groups[group.group],
                            group.surfaces > 0 ? plural(group.surfaces, "surface", "surfaces") + ", " : "",
                            plural(group.patches, "patch", "patches"));
    }
    if (diagnosis.reversed.size() > Diagnosis::shown) {
        text +=
            fmt::format("    and {} more groups\n", count_text(diagnosis.reversed.size() - Diagnosis::shown));
    }
    return text;
}

std::string pairs_text(const Reciprocity& pairs, const PatchNames& names) {
    if (pairs.pairs == 0) {
        return summary_line("reciprocity", "no pairs");
    }
    return summary_line("reciprocity",
                        fmt::format("rms {:.3g}, relative rms {:.3g}, over {}", pairs.rms, pairs.relative_rms,
                                    plural(pairs.pairs, "pair", "pairs"))) +
           summary_line("", fmt::format("worst {:.3g}: {} and {}", pairs.max, names.describe(pairs.worst_i),
                                        names.describe(pairs.worst_j)));
}

} // namespace

std::string diagnosis_text(const Diagnosis& diagnosis, const FormFactors& factors, const PatchNames& names,
                           double max_row_error) {
    const RowSums& sums = diagnosis.sums;
    std::string text = summary_line(
        "rows", fmt::format("{} of {} computed", count_text(sums.known), count_text(names.group_of.size())));
    text += summary_line("row sums", row_sum_text(sums));
    text += summary_line(
        "row balance",
        fmt::format("row sum + environment share + back-face share differs from 1 by up to {:.3g}",
                    sums.balance_error_max));
    text += repair_summary(*factors.repair);
    text += summary_line(
        "bounds",
        fmt::format("largest factor {}, {} above 1", number_text(diagnosis.largest_factor),
                    diagnosis.outside_bounds == 0
                        ? std::string("none")
                        : plural(diagnosis.outside_bounds, "factor or row sum", "factors or row sums")));
    text += pairs_text(diagnosis.reciprocity, names);
    text += summary_line("enclosure", enclosure_text(diagnosis));
    for (const Section& section : sections(diagnosis)) {
        const bool applies =
            section.findings != &diagnosis.leaks || diagnosis.enclosure != EnclosureVerdict::open;
        text += applies ? section_text(section, names) : "";
    }
    if (diagnosis.all_known) {
        text += reversed_text(diagnosis, names) + section_text(never_visible_section(diagnosis), names);
    } else {
        text += summary_line("never visible", "not known: some rows were not computed");
    }
    return text + summary_line("result", diagnosis.failures.empty()
                                             ? fmt::format("within {}", max_row_error)
                                             : fmt::format("out of tolerance ({}): {}", max_row_error,
                                                           fmt::join(diagnosis.failures, "; ")));
}

Json diagnosis_json(const Diagnosis& diagnosis, const FormFactors& factors, const PatchNames& names,
                    double max_row_error, double repair_seconds) {
    Json reversed = Json::array();
    for (const ReversedGroup& group : diagnosis.reversed) {
        reversed.push_back({{"group", names.groups[group.group]},
                            {"surfaces", group.surfaces > 0 ? Json(group.surfaces) : Json(nullptr)},
                            {"patches", group.patches}});
    }
    const RowSums& sums = diagnosis.sums;
    Json json{{"schema", "hemi/check/1"},
              {"renderer", factors.provenance.renderer},
              {"patches", factors.matrix.size()},
              {"rows", sums.known},
              {"row_sum", row_sum_json(sums)},
              {"environment_max", sums.environment_max},
              {"blocked_max", sums.blocked_max},
              {"balance_error", sums.balance_error_max},
              {"largest_factor", diagnosis.largest_factor},
              {"above_one", diagnosis.outside_bounds},
              {"reciprocity",
               diagnosis.reciprocity.pairs > 0 ? reciprocity_json(diagnosis.reciprocity) : Json(nullptr)},
              {"repair", repair_json(*factors.repair, repair_seconds)},
              {"enclosure", to_word(diagnosis.enclosure)},
              {"declared", diagnosis.declared},
              {"leaking", sums.leaking}};
    for (const Section& section : sections(diagnosis)) {
        json[section.key] = section_json(section, names);
    }
    json["turned"] = reversed;
    const Section never_visible = never_visible_section(diagnosis);
    json[never_visible.key] = diagnosis.all_known ? section_json(never_visible, names) : Json(nullptr);
    json["max_row_error"] = max_row_error;
    json["failures"] = diagnosis.failures;
    json["ok"] = diagnosis.failures.empty();
    return json;
}

} // namespace hemi::cli
