#include "cli/commands.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/trade_plot.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/accuracy.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

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

std::string table_text(const Trade& trade) {
    Table table({"", "method", "settings", "seconds", "rms", "max", "row", "radiosity", "rows"}, 3);
    for (const Trade::Entry* const entry : trade.by_time()) {
        const Measurement& m = *entry->measurement;
        table.add({entry->front ? "*" : "", entry->candidate.family, entry->candidate.variant,
                   fmt::format("{:.3g}", m.seconds), fmt::format("{:.1e}", m.error.rms),
                   fmt::format("{:.1e}", m.error.max), fmt::format("{:.1e}", m.error.row_rms),
                   m.radiosity ? fmt::format("{:.1e}", *m.radiosity) : "-", m.all_rows ? "all" : "sample"});
    }
    return table.text();
}

std::string report(const Trade& trade, const LoadedScene& loaded) {
    const Reference& reference = trade.reference;
    const auto measured = trade.by_time();
    const bool sampled = std::any_of(measured.begin(), measured.end(),
                                     [](const Trade::Entry* entry) { return !entry->measurement->all_rows; });
    std::string text = summary_line(
        "scene", fmt::format("{}, {}", loaded.scene.name, plural(loaded.mesh.size(), "patch", "patches")));
    text += summary_line("renderer", reference.renderer);
    text += summary_line("reference",
                         fmt::format("{}: unoccluded factors times visibility from {} sample points of "
                                     "resolution {}",
                                     plural(reference.patches.size(), "row", "rows"),
                                     reference.settings.eye_points, reference.settings.resolution));
    text += fmt::format("\n{}\n", table_text(trade));
    text +=
        "* on the Pareto front: nothing is both faster and more accurate. rms, max: error of a factor; row: "
        "2-norm\n"
        "of a row's error; radiosity: relative error of the reflected radiosity. Seconds are for all rows";
    text += sampled
                ? fmt::format(
                      "; where\nonly a sample of {} was computed, they are extrapolated, and errors of "
                      "visibility-weighted\nfactors are upper ones: pairs were seen from one end, and rows "
                      "not closed.\n",
                      plural(reference.patches.size(), "row", "rows"))
                : ".\n";
    for (const Trade::Entry& entry : trade.entries) {
        if (!entry.measurement) {
            text += fmt::format("Not measured: {}, {}.\n", entry.candidate.label(), entry.omitted);
        }
    }
    return text + "\n" + advice(trade) + "\n";
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

Json to_json(const Trade& trade, const LoadedScene& loaded, double budget, double seconds) {
    const Reference& reference = trade.reference;
    Json measurements = Json::array();
    Json omitted = Json::array();
    for (const Trade::Entry& entry : trade.entries) {
        if (!entry.measurement) {
            omitted.push_back({{"label", entry.candidate.label()}, {"why", entry.omitted}});
        }
    }
    for (const Trade::Entry* const entry : trade.by_time()) {
        measurements.push_back(entry_json(*entry, loaded.mesh.size()));
    }
    const Trade::Entry* const best = trade.best();
    return {{"schema", "hemi/trade/1"},
            {"scene", loaded.scene.name},
            {"renderer", reference.renderer},
            {"patches", loaded.mesh.size()},
            {"budget", budget},
            {"seconds", seconds},
            {"reference",
             {{"rows", reference.patches.size()},
              {"eye_points", reference.settings.eye_points},
              {"resolution", reference.settings.resolution},
              {"seconds", reference.seconds}}},
            {"measurements", measurements},
            {"omitted", omitted},
            {"best", best != nullptr ? Json(options_of(best->candidate.settings)) : Json(nullptr)},
            {"advice", advice(trade)}};
}

/// In the order of the sweep, so that lines join settings that grow.
void write_plot(const std::filesystem::path& path, const Trade& trade, const LoadedScene& loaded) {
    std::vector<PlotPoint> points;
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
    io::OutputFile file(path);
    file.write(trade_plot(title, "error of a row (root of its sum of squares, rms over rows)", points));
    file.commit();
}

} // namespace

ExitStatus run(const TradeArguments& arguments, const Terminal& terminal) {
    const Stopwatch total;
    Outputs outputs;
    if (arguments.output) {
        outputs.add("-o", *arguments.output, {".svg"}, true);
        outputs.refuse_with_json(arguments.common.json);
    }
    if (!io::is_scene_file(arguments.scene.path)) {
        throw InvalidArgument(fmt::format("{}: trade needs a scene ({})", arguments.scene.path.string(),
                                          io::scene_extensions()));
    }
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    if (loaded.mesh.size() < 2) {
        throw InvalidArgument(fmt::format("{}: a scene of {} has no factors to compare",
                                          arguments.scene.path.string(),
                                          plural(loaded.mesh.size(), "patch", "patches")));
    }
    TerminalObserver observer(terminal);
    const Trade trade =
        measure_trade(loaded.scene, loaded.mesh, arguments.rows.factors, arguments.budget, observer);
    if (arguments.output && trade.best() != nullptr) {
        write_plot(*arguments.output, trade, loaded);
    }
    if (arguments.common.json) {
        print_json(to_json(trade, loaded, arguments.budget, total.seconds()));
    } else if (outputs.uses_standard_output()) {
        std::fputs(report(trade, loaded).c_str(), stderr);
    } else {
        print(report(trade, loaded));
    }
    return ExitStatus::ok;
}

} // namespace hemi::cli
