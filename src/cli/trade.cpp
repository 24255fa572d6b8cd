#include "cli/candidate.hpp"
#include "cli/commands.hpp"
#include "cli/outputs.hpp"
#include "cli/report.hpp"
#include "cli/solution.hpp"
#include "cli/trade_plot.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace hemi::cli {

namespace {

constexpr double reference_share = 0.12; // of the budget
// Errors below what float factors can show are drawn and compared as this.
constexpr double least_error = 1e-9;

struct Entry {
    Candidate candidate;
    std::optional<Measurement> measurement;
    std::string omitted; ///< why there is no measurement
    bool front = false;  ///< nothing is both faster and better
    bool choice = false; ///< nothing that `solve` can do is

    [[nodiscard]] double seconds() const { return measurement->seconds; }
    [[nodiscard]] double error() const { return std::max(measurement->error.row_rms, least_error); }
};

/// Cheap ones first.
std::vector<Entry> all_entries(const RowOptions& base, std::uint32_t patches) {
    std::vector<Entry> entries;
    const auto add = [&entries](Candidate candidate) {
        entries.push_back({std::move(candidate), {}, "", false, false});
    };
    const auto hemicube = [&](const std::string& preset, std::uint32_t eyes = 0, std::uint32_t resolution = 0,
                              std::optional<std::uint32_t> rays = {}) {
        Candidate candidate = hemicube_candidate(base, preset, patches, eyes, resolution, rays);
        const bool known = std::any_of(entries.begin(), entries.end(), [&](const Entry& entry) {
            const RowPlan a = plan_rows(entry.candidate.options, patches);
            RowPlan b = plan_rows(candidate.options, patches);
            // More points near surfaces are no reason to try the same eyes twice.
            b.hemicube.near_eye_points = a.hemicube.near_eye_points;
            return !entry.candidate.yardstick && a.hemicube == b.hemicube && a.hybrid == b.hybrid;
        });
        if (!known) {
            add(std::move(candidate));
        }
    };
    hemicube("plain", 1, 32);
    hemicube("plain", 1, 64);
    hemicube("plain", 1, 128);
    hemicube("fast");
    hemicube("default", 0, 0, 0);
    hemicube("default");
    const bool few = patches <= max_baseline_patches;
    if (few) {
        add(baseline_candidate(base, BaselineMethod::montecarlo, 1024));
        add(baseline_candidate(base, BaselineMethod::montecarlo, 4096));
    }
    hemicube("plain", 1, 256);
    hemicube("plain", 4, 64);
    hemicube("default", 4, 64);
    if (few) {
        add(baseline_candidate(base, BaselineMethod::montecarlo, 16384));
        add(baseline_candidate(base, BaselineMethod::hemisphere));
    }
    hemicube("plain", 1, 512);
    hemicube("plain", 16, 64);
    hemicube("default", 9, 64);
    hemicube("exact");
    if (few) {
        add(baseline_candidate(base, BaselineMethod::montecarlo, 65536));
        add(baseline_candidate(base, BaselineMethod::contour));
        add(baseline_candidate(base, BaselineMethod::direct));
    }
    return entries;
}

class Trade {
public:
    Trade(const TradeArguments& arguments, const LoadedScene& loaded, const Terminal& terminal)
        : arguments_(arguments), loaded_(loaded), terminal_(terminal),
          patches_(all_patches(loaded.mesh.size())),
          entries_(all_entries(arguments.rows, loaded.mesh.size())) {}

    void run() {
        reference_ = find_reference(loaded_, patches_, arguments_.rows, reference_share * arguments_.budget);
        terminal_.note(fmt::format("reference: {} by {} eye points of resolution {}, in {}",
                                   plural(reference_.patches.size(), "row", "rows"),
                                   reference_.settings.eye_points, reference_.settings.resolution,
                                   seconds_text(reference_.seconds)));
        for (Entry& entry : entries_) {
            measure(entry);
        }
        find_front();
    }

    [[nodiscard]] double spent() const { return watch_.seconds(); }
    [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
    [[nodiscard]] const Reference& reference() const { return reference_; }

    /// Of what `solve` can do: the least product of time and error, as far as smaller errors are of use.
    [[nodiscard]] const Entry* best() const {
        const Entry* best = nullptr;
        for (const Entry& entry : entries_) {
            const auto price = [](const Entry& of) { return of.seconds() * std::max(of.error(), 1e-6); };
            if (entry.choice && (best == nullptr || price(entry) < price(*best))) {
                best = &entry;
            }
        }
        return best;
    }
    [[nodiscard]] bool measured_any() const {
        return std::any_of(entries_.begin(), entries_.end(),
                           [](const Entry& entry) { return entry.measurement.has_value(); });
    }

    [[nodiscard]] std::string advice() const {
        const Entry* const chosen = best();
        if (chosen == nullptr) {
            return "Nothing was measured: give more time with --budget.";
        }
        const auto tell = [](const Entry& entry) {
            return fmt::format("{} ({} for a row error of {:.2g})", entry.candidate.command,
                               seconds_text(entry.seconds()), entry.error());
        };
        std::string text = "Take " + tell(*chosen);
        const Entry* faster = nullptr;
        const Entry* better = nullptr;
        for (const Entry& entry : entries_) {
            if (!entry.choice) {
                continue;
            }
            // Only what makes a difference.
            if (entry.seconds() < 0.7 * chosen->seconds() &&
                (faster == nullptr || entry.seconds() > faster->seconds())) {
                faster = &entry;
            }
            if (entry.error() < 0.6 * chosen->error() && chosen->error() > 1e-6 &&
                (better == nullptr || entry.seconds() < better->seconds())) {
                better = &entry;
            }
        }
        if (faster != nullptr) {
            text += ", or if time matters more " + tell(*faster);
        }
        if (better != nullptr) {
            text += ", or if accuracy does " + tell(*better);
        }
        return text + ".";
    }

private:
    /// On a sample first; then on all rows if half of what time is left will do.
    void measure(Entry& entry) {
        const Candidate& candidate = entry.candidate;
        const double left = arguments_.budget - spent();
        if (left <= 0.0) {
            entry.omitted = "no time was left";
            return;
        }
        if (table_of_pairs(candidate, loaded_.mesh.size(), patches_.size()) > memory_limit(arguments_.rows)) {
            entry.omitted = "its table of pairs does not fit into the memory";
            return;
        }
        terminal_.detail(candidate.label());
        entry.measurement = try_on_sample(loaded_, candidate, reference_, patches_.size(), radiosity_);
        if (entry.measurement->seconds > 0.5 * (arguments_.budget - spent())) {
            return;
        }
        io::FactorFile rows;
        entry.measurement = try_on_all(loaded_, candidate, reference_, radiosity_, &rows);
        if (radiosity_.empty() && !candidate.yardstick) {
            const Terminal silent(true);
            radiosity_ = solve_scene(loaded_, rows.factors, SolverSettings{}, false, silent).radiosity;
            entry.measurement->radiosity =
                estimate_radiosity_error(rows.factors, reference_.rows, loaded_.mesh.areas(),
                                         static_cast<std::uint32_t>(loaded_.scene.channels.size()),
                                         patch_reflectance(loaded_.scene, loaded_.mesh),
                                         patch_exitance(loaded_.scene, loaded_.mesh), radiosity_)
                    .rms;
        }
    }

    /// Whether something that `counts` is as fast and as good, and faster or better.
    template <class Counts>
    [[nodiscard]] bool beaten(const Entry& entry, const Counts& counts) const {
        return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& other) {
            return &other != &entry && other.measurement && counts(other) &&
                   other.seconds() <= entry.seconds() && other.error() <= entry.error() &&
                   (other.seconds() < entry.seconds() || other.error() < entry.error());
        });
    }

    void find_front() {
        const auto anything = [](const Entry&) { return true; };
        const auto can_be_chosen = [](const Entry& entry) { return !entry.candidate.command.empty(); };
        for (Entry& entry : entries_) {
            entry.front = entry.measurement && !beaten(entry, anything);
            entry.choice = entry.measurement && can_be_chosen(entry) && !beaten(entry, can_be_chosen);
        }
    }

    const TradeArguments& arguments_;
    const LoadedScene& loaded_;
    const Terminal& terminal_;
    Stopwatch watch_;
    std::vector<std::uint32_t> patches_;
    std::vector<Entry> entries_;
    Reference reference_;
    std::vector<double> radiosity_; ///< of the first rows that were all computed
};

std::vector<const Entry*> by_time(const std::vector<Entry>& entries) {
    std::vector<const Entry*> measured;
    for (const Entry& entry : entries) {
        if (entry.measurement) {
            measured.push_back(&entry);
        }
    }
    std::stable_sort(measured.begin(), measured.end(),
                     [](const Entry* a, const Entry* b) { return a->seconds() < b->seconds(); });
    return measured;
}

std::string report(const Trade& trade, const LoadedScene& loaded) {
    const Reference& reference = trade.reference();
    std::string text = summary_line(
        "scene", fmt::format("{}, {}", loaded.scene.name, plural(loaded.mesh.size(), "patch", "patches")));
    text += summary_line("renderer", reference.renderer);
    text +=
        summary_line("judged by", fmt::format("{}: exact factors times visibility from {} eye points of "
                                              "resolution {}",
                                              plural(reference.patches.size(), "row", "rows"),
                                              reference.settings.eye_points, reference.settings.resolution));
    Table table({"", "method", "settings", "seconds", "rms", "max", "row", "radiosity", "rows"}, 3);
    bool sampled = false;
    for (const Entry* const entry : by_time(trade.entries())) {
        const Measurement& m = *entry->measurement;
        sampled = sampled || !m.all_rows;
        table.add({entry->front ? "*" : "", entry->candidate.family, entry->candidate.settings,
                   fmt::format("{:.3g}", m.seconds), fmt::format("{:.1e}", m.error.rms),
                   fmt::format("{:.1e}", m.error.max), fmt::format("{:.1e}", m.error.row_rms),
                   m.radiosity ? fmt::format("{:.1e}", *m.radiosity) : "-", m.all_rows ? "all" : "sample"});
    }
    text += "\n" + table.text() + "\n";
    text +=
        "* nothing is both faster and better. rms, max: of a factor; row: root of a row's sum of squares;\n"
        "radiosity: of what is reflected, relative. Seconds are for all rows";
    text += sampled ? fmt::format("; where only a sample of {} was computed, in proportion, and a hybrid's\n"
                                  "errors are then upper ones: its pairs were seen from one end, and not "
                                  "closed.\n",
                                  plural(reference.patches.size(), "row", "rows"))
                    : ".\n";
    for (const Entry& entry : trade.entries()) {
        if (!entry.measurement) {
            text += fmt::format("Not measured: {}, {}.\n", entry.candidate.label(), entry.omitted);
        }
    }
    return text + "\n" + trade.advice() + "\n";
}

Json to_json(const Trade& trade, const LoadedScene& loaded, const TradeArguments& arguments, double seconds) {
    const Reference& reference = trade.reference();
    Json measurements = Json::array();
    Json omitted = Json::array();
    for (const Entry& entry : trade.entries()) {
        const Candidate& candidate = entry.candidate;
        if (!entry.measurement) {
            omitted.push_back({{"label", candidate.label()}, {"why", entry.omitted}});
        }
    }
    for (const Entry* const entry : by_time(trade.entries())) {
        const Candidate& candidate = entry->candidate;
        const Measurement& m = *entry->measurement;
        const RowPlan plan = plan_rows(candidate.options, loaded.mesh.size());
        const HemicubeSettings& hemicube = plan.hemicube;
        const bool rays = candidate.yardstick && candidate.yardstick->method == BaselineMethod::montecarlo;
        measurements.push_back(
            {{"label", candidate.label()},
             {"method", candidate.options.method},
             {"preset", candidate.yardstick ? Json(nullptr) : Json(candidate.options.preset)},
             {"eye_points", candidate.yardstick ? Json(nullptr) : Json(hemicube.eye_points)},
             {"resolution", candidate.yardstick ? Json(nullptr) : Json(hemicube.resolution)},
             {"shadow_rays",
              plan.hybrid && !candidate.yardstick ? Json(plan.hybrid->shadow_rays) : Json(nullptr)},
             {"rays", rays ? Json(candidate.yardstick->rays) : Json(nullptr)},
             {"options", candidate.command.empty() ? Json(nullptr) : Json(candidate.command)},
             {"rows", m.all_rows ? "all" : "sample"},
             {"seconds", m.seconds},
             {"rms", m.error.rms},
             {"max", m.error.max},
             {"row", m.error.row_rms},
             {"radiosity", m.radiosity ? Json(*m.radiosity) : Json(nullptr)},
             {"front", entry->front}});
    }
    const Entry* const best = trade.best();
    return {{"schema", "hemi/trade/1"},
            {"scene", loaded.scene.name},
            {"renderer", reference.renderer},
            {"patches", loaded.mesh.size()},
            {"budget", arguments.budget},
            {"seconds", seconds},
            {"reference",
             {{"rows", reference.patches.size()},
              {"eye_points", reference.settings.eye_points},
              {"resolution", reference.settings.resolution},
              {"seconds", reference.seconds}}},
            {"measurements", measurements},
            {"omitted", omitted},
            {"best", best != nullptr ? Json(best->candidate.command) : Json(nullptr)},
            {"advice", trade.advice()}};
}

/// In the order of the sweep, so that lines join settings that grow.
void write_plot(const std::filesystem::path& path, const Trade& trade, const LoadedScene& loaded) {
    std::vector<PlotPoint> points;
    for (const Entry& entry : trade.entries()) {
        if (entry.measurement) {
            const Candidate& candidate = entry.candidate;
            points.push_back({candidate.family,
                              candidate.settings.empty() ? candidate.family : candidate.settings,
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
        if (outputs.uses_standard_output() && arguments.common.json) {
            throw InvalidArgument("--json and an output to - cannot both go to standard output");
        }
    }
    if (!io::is_scene_file(arguments.scene.path)) {
        throw InvalidArgument(
            fmt::format("{}: trade needs a scene, .json or .obj", arguments.scene.path.string()));
    }
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    if (loaded.mesh.size() < 2) {
        throw InvalidArgument(fmt::format("{}: a scene of {} has no factors to compare",
                                          arguments.scene.path.string(),
                                          plural(loaded.mesh.size(), "patch", "patches")));
    }
    Trade trade(arguments, loaded, terminal);
    trade.run();
    if (arguments.output && trade.measured_any()) {
        write_plot(*arguments.output, trade, loaded);
    }
    if (arguments.common.json) {
        print_json(to_json(trade, loaded, arguments, total.seconds()));
    } else {
        const std::string text = report(trade, loaded);
        if (outputs.uses_standard_output()) {
            std::fputs(text.c_str(), stderr);
        } else {
            print(text);
        }
    }
    return ExitStatus::ok;
}

} // namespace hemi::cli
