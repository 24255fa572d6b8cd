#include "cli/report/trade_report.hpp"

#include "cli/report/trade_plot.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::cli {

namespace {

/// Options by which `solve` and `factors` do the same as a candidate.
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

std::string entry_text(const Trade::Entry& entry) {
    return fmt::format("{} ({} for a row error of {:.2g})", options_of(entry.candidate.settings),
                       seconds_text(entry.seconds()), entry.error());
}

std::string advice(const Trade& trade) {
    const Trade::Entry* const best = trade.best();
    if (best == nullptr) {
        return "Nothing was measured: give more time with --budget.";
    }
    std::string text = "Recommended: " + entry_text(*best);
    if (const Trade::Entry* const faster = trade.faster()) {
        text += "; where time matters more: " + entry_text(*faster);
    }
    if (const Trade::Entry* const better = trade.more_accurate()) {
        text += "; where accuracy matters more: " + entry_text(*better);
    }
    return text + ".";
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

Json entry_json(const Trade::Entry& entry, std::uint32_t patches) {
    const Measurement& m = *entry.measurement;
    const FactorSettings& settings = entry.candidate.settings;
    const RowPlan plan = plan_rows(settings, patches);
    const bool hemicubes = settings.method == Method::hemicube;
    const auto hemicubes_only = [hemicubes](const Json& value) { return hemicubes ? value : Json(nullptr); };
    return {{"label", entry.candidate.label()},
            {"method", to_word(settings.method)},
            {"preset", hemicubes_only(to_word(settings.preset))},
            {"eye_points", hemicubes_only(plan.hemicube.eye_points)},
            {"resolution", hemicubes_only(plan.hemicube.resolution)},
            {"shadow_rays", plan.weighted ? hemicubes_only(plan.weighted->shadow_rays) : Json(nullptr)},
            {"rays", settings.rays ? Json(*settings.rays) : Json(nullptr)},
            {"options", options_of(settings)},
            {"rows", m.all_rows ? "all" : "sample"},
            {"seconds", m.seconds},
            {"rms", m.error.rms},
            {"max", m.error.max},
            {"row", m.error.row_rms},
            {"radiosity", m.radiosity ? Json(*m.radiosity) : Json(nullptr)},
            {"front", entry.front}};
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
Report measurements_report(const Trade& trade, std::uint32_t patches) {
    Table table({"", "method", "settings", "seconds", "rms", "max", "row", "radiosity", "rows"}, 3);
    Json list = Json::array();
    for (const Trade::Entry* const entry : trade.by_time()) {
        table.add(entry_line(*entry));
        list.push_back(entry_json(*entry, patches));
    }
    return {fmt::format("\n{}\n{}", table.text(), legend(trade)), {{"measurements", list}}};
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

Report trade_report(const Trade& trade, const LoadedScene& loaded, double budget, double seconds) {
    const std::uint32_t patches = loaded.mesh.size();
    const std::string& renderer = trade.reference.renderer;
    const Trade::Entry* const best = trade.best();
    Report report;
    report.add("scene", fmt::format("{}, {}", loaded.scene.name, plural(patches, "patch", "patches")),
               {{"scene", loaded.scene.name}});
    report.add("renderer", renderer, {{"renderer", renderer}});
    report.json.update({{"patches", patches}, {"budget", budget}, {"seconds", seconds}});
    report.add(reference_report(trade.reference));
    report.add(measurements_report(trade, patches));
    report.add(omitted_report(trade));
    report.json["best"] = best != nullptr ? Json(options_of(best->candidate.settings)) : Json(nullptr);
    report.json["advice"] = advice(trade);
    report.text += fmt::format("\n{}\n", advice(trade));
    report.select("hemi/trade/1", {"scene", "renderer", "patches", "budget", "seconds", "reference",
                                   "measurements", "omitted", "best", "advice"});
    return report;
}

std::string trade_drawing(const Trade& trade, const LoadedScene& loaded) {
    std::vector<PlotPoint> points; // in the order of the sweep, so that lines join settings that grow
    for (const Trade::Entry& entry : trade.entries) {
        if (entry.measurement) {
            const Candidate& candidate = entry.candidate;
            points.push_back({candidate.family,
                              candidate.variant.empty() ? candidate.family : candidate.variant,
                              std::max(entry.seconds(), 1e-3), entry.error(), entry.front});
        }
    }
    std::stable_sort(points.begin(), points.end(),
                     [](const PlotPoint& a, const PlotPoint& b) { return a.seconds < b.seconds; });
    const std::string size = plural(loaded.mesh.size(), "patch", "patches");
    const std::string title = loaded.scene.name.empty() ? size : size + ": " + loaded.scene.name;
    return trade_plot(title, "error of a row (root of its sum of squares, rms over rows)", points);
}

} // namespace hemi::cli
