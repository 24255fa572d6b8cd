#include "cli/commands.hpp"
#include "cli/findings.hpp"
#include "cli/outputs.hpp"
#include "cli/pipeline.hpp"
#include "cli/repair_rows.hpp"
#include "cli/report.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hemi::cli {

namespace {

std::string verdict_name(EnclosureVerdict verdict) {
    switch (verdict) {
    case EnclosureVerdict::closed:
        return "closed";
    case EnclosureVerdict::nearly_closed:
        return "nearly closed";
    case EnclosureVerdict::open:
        break;
    }
    return "open";
}

std::string enclosure_text(const Findings& findings) {
    std::string text = verdict_name(findings.enclosure);
    text += findings.declared ? " (declared)" : " (from the rows)";
    if (findings.sums.leaking > 0) {
        text += fmt::format(": {} of {} the environment", count_text(findings.sums.leaking),
                            findings.sums.known == 1 ? "1 patch sees"
                                                     : count_text(findings.sums.known) + " patches see");
    }
    return text;
}

/// A kind of finding: a line with the count and why, then the first patches.
std::string section(std::string_view name, const std::vector<PatchFinding>& findings, std::string_view why,
                    const PatchNames& names, bool with_share) {
    if (findings.empty()) {
        return summary_line(name, "none");
    }
    std::string text =
        summary_line(name, fmt::format("{}: {}", plural(findings.size(), "patch", "patches"), why));
    for (std::size_t k = 0; k < std::min(findings_shown, findings.size()); ++k) {
        text += "    " + names.describe(findings[k].patch);
        text += with_share ? ": " + number_text(findings[k].share) : "";
        text += towards_text(findings[k].towards) + "\n";
    }
    if (findings.size() > findings_shown) {
        text += fmt::format("    and {} more\n", count_text(findings.size() - findings_shown));
    }
    return text;
}

std::string turned_text(const Findings& findings, const PatchNames& names) {
    if (findings.turned.empty()) {
        return summary_line("turned round", "none");
    }
    std::string text =
        summary_line("turned round", "fronts that nobody sees while others meet back faces; reverse "
                                     "their vertices, or make them two-sided");
    for (std::size_t k = 0; k < std::min(findings_shown, findings.turned.size()); ++k) {
        const TurnedGroup& group = findings.turned[k];
        text += fmt::format("    {}: {}{}\n", names.groups[group.group],
                            group.surfaces > 0 ? plural(group.surfaces, "surface", "surfaces") + ", " : "",
                            plural(group.patches, "patch", "patches"));
    }
    if (findings.turned.size() > findings_shown) {
        text += fmt::format("    and {} more groups\n", count_text(findings.turned.size() - findings_shown));
    }
    return text;
}

std::string_view leak_reason(const Findings& findings) {
    if (findings.enclosure == EnclosureVerdict::nearly_closed) {
        return "they see the environment, most others do not; if the scene is meant to be closed there are "
               "gaps "
               "near them, or they face the outside";
    }
    if (findings.sums.max <= 0.0) {
        return "no patch sees any other; all surfaces may be turned round";
    }
    return "they see the environment: there are gaps near them, or they face the outside";
}

std::string to_text(const Findings& findings, const RowRepair& repair, const PatchNames& names,
                    double max_row_error) {
    const RowSums& sums = findings.sums;
    const Reciprocity& pairs = findings.reciprocity;
    std::string text = summary_line(
        "rows", fmt::format("{} of {} computed", count_text(sums.known), count_text(names.group_of.size())));
    text += summary_line("row sums", row_sum_text(sums));
    text +=
        summary_line("row balance", fmt::format("sum + environment + blocked differs from 1 by up to {:.3g}",
                                                sums.balance_error_max));
    text += repair_summary(repair);
    text += summary_line(
        "bounds",
        fmt::format("largest factor {}, {} above 1", number_text(findings.largest_factor),
                    findings.outside_bounds == 0
                        ? std::string("none")
                        : plural(findings.outside_bounds, "factor or row sum", "factors or row sums")));
    if (pairs.pairs == 0) {
        text += summary_line("reciprocity", "no pairs");
    } else {
        text += summary_line("reciprocity",
                             fmt::format("rms {:.3g}, relative rms {:.3g}, over {}", pairs.rms,
                                         pairs.relative_rms, plural(pairs.pairs, "pair", "pairs")));
        text += summary_line("", fmt::format("worst {:.3g}: {} and {}", pairs.max,
                                             names.describe(pairs.worst_i), names.describe(pairs.worst_j)));
    }
    text += summary_line("enclosure", enclosure_text(findings));
    if (findings.enclosure != EnclosureVerdict::open) {
        text += section("leaks", findings.leaks, leak_reason(findings), names, true);
    }
    text += section("covered", findings.covered,
                    "their centre lies under or inside something; nothing reaches them", names, false);
    text += section("blocked", findings.blocked,
                    findings.turned.empty()
                        ? "they meet back faces: something cuts through them or stands open nearby"
                        : "they meet back faces: see what is turned round",
                    names, true);
    text += section("straddled", findings.straddled,
                    "something stands on part of them; smaller patches, or a border along its outline, tell "
                    "that part from the rest. The share under it",
                    names, true);
    text += section("near", findings.near,
                    "a surface hovers close above them; --preset default takes up to 16 sample points there, "
                    "exact up to 64, and smaller patches help. Its distance in patch sizes",
                    names, true);
    if (findings.all_known) {
        text += turned_text(findings, names);
        text += section("unseen", findings.unseen, "no patch sees them", names, false);
    } else {
        text += summary_line("unseen", "not known: some rows were not computed");
    }
    if (findings.failures.empty()) {
        text += summary_line("result", fmt::format("within {}", max_row_error));
    } else {
        text += summary_line("result", fmt::format("out of tolerance ({}): {}", max_row_error,
                                                   fmt::join(findings.failures, "; ")));
    }
    return text;
}

Json section_json(const std::vector<PatchFinding>& findings, const PatchNames& names, bool with_share) {
    Json worst = Json::array();
    for (std::size_t k = 0; k < std::min(findings_shown, findings.size()); ++k) {
        Json patch = names.json(findings[k].patch);
        if (with_share) {
            patch["share"] = findings[k].share;
        }
        if (const auto& towards = findings[k].towards) {
            patch["towards"] = {towards->x, towards->y, towards->z};
        }
        worst.push_back(patch);
    }
    return {{"count", findings.size()}, {"worst", worst}};
}

Json to_json(const Findings& findings, const RowRepair& repair, const io::FactorFile& file,
             const PatchNames& names, double max_row_error) {
    Json turned = Json::array();
    for (const TurnedGroup& group : findings.turned) {
        turned.push_back({{"group", names.groups[group.group]},
                          {"surfaces", group.surfaces > 0 ? Json(group.surfaces) : Json(nullptr)},
                          {"patches", group.patches}});
    }
    const RowSums& sums = findings.sums;
    return {{"schema", "hemi/check/1"},
            {"renderer", file.renderer},
            {"patches", file.factors.size()},
            {"rows", sums.known},
            {"row_sum", row_sum_json(sums)},
            {"environment_max", sums.environment_max},
            {"blocked_max", sums.blocked_max},
            {"balance_error", sums.balance_error_max},
            {"largest_factor", findings.largest_factor},
            {"above_one", findings.outside_bounds},
            {"reciprocity",
             findings.reciprocity.pairs > 0 ? reciprocity_json(findings.reciprocity) : Json(nullptr)},
            {"repair", repair_json(repair)},
            {"enclosure", verdict_name(findings.enclosure)},
            {"declared", findings.declared},
            {"leaking", sums.leaking},
            {"leaks", section_json(findings.leaks, names, true)},
            {"covered", section_json(findings.covered, names, false)},
            {"blocked", section_json(findings.blocked, names, true)},
            {"straddled", section_json(findings.straddled, names, true)},
            {"near", section_json(findings.near, names, true)},
            {"turned", turned},
            {"unseen", findings.all_known ? section_json(findings.unseen, names, false) : Json(nullptr)},
            {"max_row_error", max_row_error},
            {"failures", findings.failures},
            {"ok", findings.failures.empty()}};
}

io::FactorFile read_file(const CheckArguments& arguments) {
    const std::filesystem::path& path = arguments.scene.path;
    if (extension_of(path) != ".hff") {
        throw InvalidArgument(fmt::format("{}: check needs a scene ({}) or a .hff; other files hold no row "
                                          "balance and no areas",
                                          path.string(), io::scene_extensions()));
    }
    refuse_all_but(arguments.common, std::vector<std::string>{"--enclosure", "--max-row-error", "--repair"},
                   path);
    io::FactorFile file = io::read_hff(path);
    if (arguments.scene.enclosure) {
        file.enclosure = enclosure_name(*arguments.scene.enclosure);
    }
    return file;
}

} // namespace

ExitStatus run(const CheckArguments& arguments, const Terminal& terminal) {
    std::optional<LoadedScene> loaded;
    io::FactorFile file;
    if (io::is_scene_file(arguments.scene.path)) {
        loaded = load_scene(arguments.scene, terminal);
        file = compute_rows(*loaded, all_patches(loaded->mesh.size()), arguments.rows, terminal).file;
    } else {
        file = read_file(arguments);
    }
    settle_contacts(file);
    const RowRepair repair = repair_rows(file, arguments.rows.repair);
    const PatchNames names = loaded ? loaded->names() : PatchNames{file.groups, file.group_of, {}};
    const double limit = arguments.rows.max_row_error;
    const Findings findings = find_defects(file, loaded ? &loaded->mesh : nullptr, limit);
    if (arguments.common.json) {
        print_json(to_json(findings, repair, file, names, limit));
    } else if (!terminal.quiet()) {
        print(to_text(findings, repair, names, limit));
    }
    if (findings.enclosure == EnclosureVerdict::nearly_closed) {
        terminal.warn(
            fmt::format("nearly closed: {}; --enclosure closed makes that an error, --enclosure open says "
                        "that it is meant",
                        plural(findings.leaks.size(), "patch leaks", "patches leak")));
    }
    return findings.failures.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

} // namespace hemi::cli
