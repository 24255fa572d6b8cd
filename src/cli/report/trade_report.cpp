#include "cli/report/trade_report.hpp"

#include "cli/report/trade_plot.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::cli {

namespace {

/// Options by which `solve` and `factors` do the same as a candidate, on whatever patches.
std::string options_of(const FactorSettings& settings) {
    if (settings.method != Method::hemicube) {
        std::string text = fmt::format("--method {}", to_word(settings.method));
        return settings.rays ? text + fmt::format(" --rays {}", *settings.rays) : text;
    }
    std::string text = fmt::format("--preset {}", to_word(settings.preset));
    text += settings.eye_points ? fmt::format(" --eye-points {}", *settings.eye_points) : "";
    text += settings.resolution ? fmt::format(" --resolution {}", *settings.resolution) : "";
    text += settings.shadow_rays ? fmt::format(" --shadow-rays {}", *settings.shadow_rays) : "";
    return text;
}

/// Options by which the same patches are made, with a space after each.
std::string options_of(const Subdivision& subdivision, bool imprint) {
    std::string text;
    text += subdivision.patch_size ? fmt::format("--patch-size {} ", *subdivision.patch_size) : "";
    text += subdivision.patches_per_face
                ? fmt::format("--patches-per-face {} ", *subdivision.patches_per_face)
                : "";
    return text + (imprint ? "" : "--no-imprint ");
}

std::string options_of(const Trade::Entry& entry, const SceneOptions& given) {
    return options_of(given.subdivision, given.imprint) + options_of(entry.candidate.settings);
}

std::string options_of(const Trade::Answer& answer, const SceneOptions& given) {
    Subdivision subdivision;
    if (answer.patch_size) {
        subdivision.patch_size = answer.patch_size;
    } else if (!answer.error_target) {
        subdivision = given.subdivision;
    }
    const std::string target =
        answer.error_target ? fmt::format("--error-target {:g}% ", 100.0 * *answer.error_target) : "";
    return target + options_of(subdivision, given.imprint) + options_of(answer.candidate.settings);
}

std::string percent(double value) {
    return fmt::format("{:.2g} %", 100.0 * value);
}

/// "patches of 0.05", "the scene's own patches", "patches refined to 1 %".
std::string patches_of(const Trade::Answer& answer) {
    return answer.error_target ? fmt::format("patches refined to {:g} %", 100.0 * *answer.error_target)
           : answer.patch_size ? fmt::format("patches of {:g}", *answer.patch_size)
                               : "the scene's own patches";
}

/// "fast", "plain 1x32", "hemisphere".
std::string method_of(const Trade::Answer& answer) {
    const Candidate& candidate = answer.candidate;
    return candidate.is_preset() ? std::string(to_word(candidate.settings.preset)) : candidate.label();
}

std::string offer_text(const Trade::Answer& answer, const SceneOptions& given) {
    return fmt::format("{} by {}: {} in {} ({})", patches_of(answer), answer.candidate.description(),
                       percent(answer.vertices()), seconds_text(answer.seconds), options_of(answer, given));
}

std::string offer_text(const Trade::Entry& entry, const SceneOptions& given) {
    return fmt::format("{} ({} for a row error of {:.2g})", options_of(entry, given),
                       seconds_text(entry.seconds()), entry.error());
}

template <class Offered>
std::string advice(const std::vector<const Offered*>& offers, const Recommendation& recommended,
                   const SceneOptions& given) {
    if (!recommended.best) {
        return "Nothing was measured: give more with --budget or --max-memory.";
    }
    std::string text = "Recommended: " + offer_text(*offers[*recommended.best], given);
    if (recommended.faster) {
        text += "; where time matters more: " + offer_text(*offers[*recommended.faster], given);
    }
    if (recommended.more_accurate) {
        text += "; where accuracy matters more: " + offer_text(*offers[*recommended.more_accurate], given);
    }
    return text + ".";
}

std::string advice(const Trade& trade, const SceneOptions& given) {
    return trade.answers.empty() ? advice(trade.by_time(), trade.recommended_entries(), given)
                                 : advice(trade.answers_by_time(), trade.recommended_answers(), given);
}

/// Options of what is recommended.
Json best_options(const Trade& trade, const SceneOptions& given) {
    if (!trade.answers.empty()) {
        return options_of(*trade.answers_by_time()[*trade.recommended_answers().best], given);
    }
    const auto best = trade.recommended_entries().best;
    return best ? Json(options_of(*trade.by_time()[*best], given)) : Json(nullptr);
}

/// A line of the table.
std::vector<std::string> entry_line(const Trade::Entry& entry) {
    const Measurement& m = *entry.measurement;
    return {entry.front ? "*" : "",
            entry.candidate.family,
            entry.candidate.variant,
            fmt::format("{:.3g}", m.seconds),
            fmt::format("{:.1e}", m.error.rms),
            fmt::format("{:.1e}", m.error.max),
            fmt::format("{:.1e}", m.error.row_rms),
            m.radiosity ? fmt::format("{:.1e}", *m.radiosity) : "-",
            m.all_rows ? "all" : "sample"};
}

/// Keys that say how form factors are found.
Json settings_json(const Candidate& candidate, std::uint32_t patches) {
    const FactorSettings& settings = candidate.settings;
    const RowPlan plan = plan_rows(settings, patches);
    const bool hemicubes = settings.method == Method::hemicube;
    const auto hemicubes_only = [hemicubes](const Json& value) { return hemicubes ? value : Json(nullptr); };
    return {{"label", candidate.label()},
            {"method", to_word(settings.method)},
            {"preset", hemicubes_only(to_word(settings.preset))},
            {"eye_points", hemicubes_only(plan.hemicube.eye_points)},
            {"resolution", hemicubes_only(plan.hemicube.resolution)},
            {"shadow_rays", plan.weighted ? hemicubes_only(plan.weighted->shadow_rays) : Json(nullptr)},
            {"rays", settings.rays ? Json(*settings.rays) : Json(nullptr)}};
}

Json entry_json(const Trade::Entry& entry, std::uint32_t patches, const SceneOptions& given) {
    const Measurement& m = *entry.measurement;
    Json json = settings_json(entry.candidate, patches);
    json.update({{"options", options_of(entry, given)},
                 {"rows", m.all_rows ? "all" : "sample"},
                 {"seconds", m.seconds},
                 {"rms", m.error.rms},
                 {"max", m.error.max},
                 {"row", m.error.row_rms},
                 {"radiosity", m.radiosity ? Json(*m.radiosity) : Json(nullptr)},
                 {"front", entry.front}});
    return json;
}

Json answer_json(const Trade::Answer& answer, const SceneOptions& given) {
    const auto field = [](const FieldError& error) {
        return Json{{"rms", error.rms}, {"p95", error.percentile95}};
    };
    const auto optional = [](const std::optional<double>& value) {
        return value ? Json(*value) : Json(nullptr);
    };
    Json json = settings_json(answer.candidate, answer.patches);
    json["label"] = patches_of(answer) + ", " + answer.candidate.label();
    json.update({{"options", options_of(answer, given)},
                 {"patches", answer.patches},
                 {"patch_size", optional(answer.patch_size)},
                 {"error_target", optional(answer.error_target)},
                 {"gathered", answer.gathered},
                 {"seconds", answer.seconds},
                 {"memory", answer.memory},
                 {"vertices", field(answer.error.vertices)},
                 {"field", field(answer.error.field)},
                 {"row", answer.row_error},
                 {"front", answer.front}});
    return json;
}

/// Whole solutions, quickest first, and what they were judged by.
Report answers_report(const Trade& trade, const SceneOptions& given) {
    if (!trade.answer_reference) {
        return {fmt::format("\nErrors of form factors only: {}.\n", trade.unanswered),
                {{"solutions", Json::array()}, {"solution_reference", nullptr}}};
    }
    Table table({"", "patches", "form factors", "number", "seconds", "memory", "picture", "constants", "row"},
                3);
    Json list = Json::array();
    for (const Trade::Answer* const answer : trade.answers_by_time()) {
        table.add({answer->front ? "*" : "", patches_of(*answer), method_of(*answer),
                   count_text(answer->patches), fmt::format("{:.3g}", answer->seconds),
                   memory_text(answer->memory), percent(answer->vertices()), percent(answer->error.field.rms),
                   fmt::format("{:.1e}", answer->row_error)});
        list.push_back(answer_json(*answer, given));
    }
    const RadiosityReference& reference = *trade.answer_reference;
    const std::string legend = fmt::format(
        "* on the Pareto front: nothing is both faster and more accurate. Seconds: all of a solution, "
        "without\n"
        "reading and drawing; of refined patches with the estimates that they follow. picture, constants: "
        "rms "
        "error\nof the reflected light, interpolated as pictures show it, and as one constant a patch; row: "
        "2-norm of a\nrow's error. Compared at {} points with light gathered from {}, whose own\nerror is "
        "about {}.\n",
        count_text(reference.points.size()), plural(reference.patches, "patch", "patches"),
        percent(reference.own_error));
    return {fmt::format("\nSolutions\n{}\n{}", table.text(), legend),
            {{"solutions", list},
             {"solution_reference",
              {{"patches", reference.patches},
               {"points", reference.points.size()},
               {"error", reference.own_error},
               {"seconds", reference.seconds}}}}};
}

/// What the columns of the table mean.
std::string legend(const Trade& trade) {
    const auto measured = trade.by_time();
    const bool sampled = std::any_of(measured.begin(), measured.end(),
                                     [](const Trade::Entry* entry) { return !entry->measurement->all_rows; });
    const std::string text =
        "* on the Pareto front: nothing is both faster and more accurate. rms, max: error of a factor; row: "
        "2-norm\n"
        "of a row's error; radiosity: relative error of the reflected radiosity. Seconds are for all rows";
    return text + (sampled
                       ? fmt::format("; where\nonly a sample of {} was computed, they are extrapolated, and "
                                     "errors of visibility-weighted\nfactors are upper ones: pairs were seen "
                                     "from one end, and rows not closed.\n",
                                     plural(trade.reference.patches.size(), "row", "rows"))
                       : ".\n");
}

/// The table of all measurements, quickest first.
Report measurements_report(const Trade& trade, std::uint32_t patches, const SceneOptions& given) {
    Table table({"", "method", "settings", "seconds", "rms", "max", "row", "radiosity", "rows"}, 3);
    Json list = Json::array();
    for (const Trade::Entry* const entry : trade.by_time()) {
        table.add(entry_line(*entry));
        list.push_back(entry_json(*entry, patches, given));
    }
    return {fmt::format("\nForm factors of the scene's own patches\n{}\n{}", table.text(), legend(trade)),
            {{"measurements", list}}};
}

/// Candidates that there was no time for, or that do not apply.
Report omitted_report(const Trade& trade) {
    std::string text;
    Json list = Json::array();
    for (const Trade::Entry& entry : trade.entries) {
        if (!entry.measurement) {
            text += fmt::format("Not measured: {}, {}.\n", entry.candidate.label(), entry.omitted);
            list.push_back({{"label", entry.candidate.label()}, {"why", entry.omitted}});
        }
    }
    for (const auto& [what, why] : trade.omitted) {
        text += fmt::format("Not measured: {}, {}.\n", what, why);
        list.push_back({{"label", what}, {"why", why}});
    }
    return {text, {{"omitted", list}}};
}

Report reference_report(const Reference& reference) {
    const std::uint32_t eye_points = reference.settings.eye_points;
    const std::uint32_t resolution = reference.settings.resolution;
    Report report;
    report.add("reference",
               fmt::format("{}: unoccluded factors times visibility from {} sample points of "
                           "resolution {}",
                           plural(reference.patches.size(), "row", "rows"), eye_points, resolution),
               {{"reference",
                 {{"rows", reference.patches.size()},
                  {"eye_points", eye_points},
                  {"resolution", resolution},
                  {"seconds", reference.seconds}}}});
    return report;
}

} // namespace

Report trade_report(const Trade& trade, const LoadedScene& loaded, const SceneOptions& given, double budget,
                    double seconds) {
    const std::uint32_t patches = loaded.mesh.size();
    const std::string& renderer = trade.reference.renderer;
    Report report;
    report.add("scene", fmt::format("{}, {}", loaded.scene.name, plural(patches, "patch", "patches")),
               {{"scene", loaded.scene.name}});
    report.add("renderer", renderer, {{"renderer", renderer}});
    report.json.update({{"patches", patches}, {"budget", budget}, {"seconds", seconds}});
    report.add(reference_report(trade.reference));
    report.add(answers_report(trade, given));
    report.add(measurements_report(trade, patches, given));
    report.add(omitted_report(trade));
    report.json["best"] = best_options(trade, given);
    report.json["advice"] = advice(trade, given);
    report.text += fmt::format("\n{}\n", advice(trade, given));
    report.select("hemi/trade/1",
                  {"scene", "renderer", "patches", "budget", "seconds", "reference", "measurements",
                   "solutions", "solution_reference", "omitted", "best", "advice"});
    return report;
}

namespace {

constexpr double least_seconds = 1e-3; // of a drawing

PlotPanel factors_panel(const Trade& trade) {
    PlotPanel panel{"Form factors of the scene's own patches",
                    "seconds for all rows",
                    "error of a row (2-norm, rms over rows)",
                    false,
                    {}};
    for (const Trade::Entry& entry : trade.entries) {
        if (entry.measurement) {
            const Candidate& candidate = entry.candidate;
            panel.points.push_back({candidate.family,
                                    candidate.variant.empty() ? candidate.family : candidate.variant,
                                    std::max(entry.seconds(), least_seconds), entry.error(), entry.front});
        }
    }
    std::stable_sort(panel.points.begin(), panel.points.end(),
                     [](const PlotPoint& a, const PlotPoint& b) { return a.seconds < b.seconds; });
    return panel;
}

/// Lines join the sizes of one preset; single settings on the scene's own patches are points without names.
PlotPanel answers_panel(const Trade& trade) {
    PlotPanel panel{"The answer: error of the light in the picture, by patch size",
                    "seconds for the whole solution",
                    "rms error of the reflected light",
                    true,
                    {}};
    std::vector<PlotPoint> others;
    for (const Trade::Answer& answer : trade.answers) {
        const FactorSettings& settings = answer.candidate.settings;
        PlotPoint point{"other form factors, the scene's own patches",
                        "",
                        std::max(answer.seconds, least_seconds),
                        answer.vertices(),
                        answer.front,
                        false};
        if (answer.error_target) {
            point.family = fmt::format("refined, preset {}", to_word(settings.preset));
            point.label = fmt::format("to {:g} %", 100.0 * *answer.error_target);
        } else if (answer.candidate.is_preset()) {
            point.family = fmt::format("preset {}", to_word(settings.preset));
            point.label = answer.patch_size ? fmt::format("size {:g}", *answer.patch_size) : "own size";
        } else {
            point.label = answer.front ? answer.candidate.label() : "";
            others.push_back(std::move(point));
            continue;
        }
        point.joined = true;
        panel.points.push_back(std::move(point));
    }
    panel.points.insert(panel.points.end(), others.begin(), others.end());
    return panel;
}

} // namespace

std::string trade_drawing(const Trade& trade, const LoadedScene& loaded) {
    std::vector<PlotPanel> panels;
    if (!trade.answers.empty()) {
        panels.push_back(answers_panel(trade));
    }
    if (!trade.by_time().empty()) {
        panels.push_back(factors_panel(trade));
    }
    const std::string size = plural(loaded.mesh.size(), "patch", "patches");
    return trade_plot(loaded.scene.name.empty() ? size : size + ": " + loaded.scene.name, panels);
}

} // namespace hemi::cli
