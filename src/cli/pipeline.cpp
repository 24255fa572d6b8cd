#include "cli/pipeline.hpp"

#include "cli/outputs.hpp"
#include "cli/progress_bar.hpp"
#include "cli/signals.hpp"
#include "core/nearest_word.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/engine/baselines.hpp"
#include "hemi/engine/leaks.hpp"
#include "hemi/engine/touching_faces.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <type_traits>

namespace hemi::cli {

namespace {

constexpr std::uint32_t sample_rows = 64;
constexpr std::size_t sample_above = 256;

/// Shows rows to a watcher and passes them on.
template <class Row>
class WatchedRows : public BasicRowProvider<Row> {
public:
    WatchedRows(BasicRowProvider<Row>& provider, const RowWatcher& watcher)
        : provider_(provider), watcher_(watcher) {}

    [[nodiscard]] std::uint32_t size() const override { return provider_.size(); }
    [[nodiscard]] std::string renderer() const override { return provider_.renderer(); }
    void rows(std::span<const std::uint32_t> patches,
              const typename BasicRowProvider<Row>::Sink& sink) override {
        provider_.rows(patches, [&](std::uint32_t patch, const Row& row) {
            if (watcher_) {
                watcher_(patch, row);
            }
            sink(patch, row);
        });
    }

private:
    BasicRowProvider<Row>& provider_;
    const RowWatcher& watcher_;
};

void check_two_sided_groups(const Scene& scene, const SceneOptions& options) {
    if (options.two_sided.empty()) {
        return;
    }
    if (extension_of(options.path) == ".json") {
        throw InvalidArgument("--two-sided is not for JSON scenes, which say \"two_sided\": true");
    }
    for (const std::string& name : options.two_sided) {
        if (std::find(scene.groups.begin(), scene.groups.end(), name) == scene.groups.end()) {
            throw InvalidArgument(fmt::format("--two-sided {}: {} has no such group{}", name,
                                              options.path.string(), did_you_mean(name, scene.groups)));
        }
    }
}

/// MemAvailable of /proc/meminfo in bytes; without it nothing is refused.
std::uint64_t available_memory() {
    std::ifstream meminfo("/proc/meminfo");
    std::string name;
    std::uint64_t kibibytes = 0;
    std::string unit;
    while (meminfo >> name >> kibibytes) {
        if (name == "MemAvailable:") {
            return kibibytes * 1024;
        }
        std::getline(meminfo, unit);
    }
    return std::numeric_limits<std::uint64_t>::max();
}

void check_memory(const MatrixEstimate& estimate, std::size_t rows, const RowOptions& options) {
    const std::uint64_t limit = memory_limit(options);
    if (estimate.memory_bytes <= limit) {
        return;
    }
    throw OutOfMemory(fmt::format(
        "{} rows of about {:.0f} entries would need {}; the limit is {} ({}). Larger patches (--patch-size), "
        "a lower --resolution or a higher --max-memory would help",
        count_text(rows), estimate.entries_per_row, memory_text(estimate.memory_bytes), memory_text(limit),
        options.max_memory ? "--max-memory" : "80 % of the memory that is free"));
}

io::FactorFile describe(const LoadedScene& loaded, const RowOptions& options, const RowPlan& plan) {
    io::FactorFile file;
    file.areas.assign(loaded.mesh.areas().begin(), loaded.mesh.areas().end());
    file.groups = loaded.mesh.groups();
    file.group_of = loaded.group_of;
    file.geometry_hash = loaded.mesh.geometry_hash();
    file.preset = options.preset;
    file.method = options.method;
    file.resolution = plan.hemicube.resolution;
    file.eye_points = plan.hemicube.eye_points;
    file.shadow_rays = plan.hybrid ? plan.hybrid->shadow_rays : 0;
    file.seed = plan.hemicube.seed;
    file.enclosure = enclosure_name(loaded.scene.enclosure);
    return file;
}

template <class A, class B>
void check_setting(const CommonOptions& common, const std::filesystem::path& path, const std::string& option,
                   const A& given, const B& stored) {
    if (std::find(common.given.begin(), common.given.end(), option) != common.given.end() &&
        given != stored) {
        throw InvalidArgument(fmt::format("{0} {1} conflicts with --factors {2}, whose rows were made with "
                                          "{0} {3}; leave {0} out, or name another file",
                                          option, given, path.string(), stored));
    }
}

} // namespace

std::string enclosure_name(Enclosure enclosure) {
    switch (enclosure) {
    case Enclosure::closed:
        return "closed";
    case Enclosure::open:
        return "open";
    case Enclosure::automatic:
        break;
    }
    return "auto";
}

LoadedScene load_scene(const SceneOptions& options, const Terminal& terminal) {
    const Stopwatch watch;
    Diagnostics diagnostics;
    Scene scene = io::read_scene(
        options.path, {options.two_sided, options.skip_degenerate, options.allow_outside}, diagnostics);
    terminal.warn(diagnostics);
    check_two_sided_groups(scene, options);
    if (options.enclosure) {
        scene.enclosure = *options.enclosure;
    }
    if (!options.environment.empty()) {
        const std::size_t channels = scene.channels.size();
        if (options.environment.size() != 1 && options.environment.size() != channels) {
            throw InvalidArgument(fmt::format("--environment: {} values; the scene has {}, so give 1 or {}",
                                              options.environment.size(),
                                              plural(channels, "channel", "channels"), channels));
        }
        scene.environment = options.environment;
        scene.environment.resize(channels, options.environment[0]);
        for (const double value : scene.environment) {
            if (!(value >= 0.0)) {
                throw InvalidArgument(fmt::format("--environment {}; must not be negative", value));
            }
        }
    }
    PatchMesh mesh = [&] {
        try {
            return PatchMesh(scene, options.subdivision);
        } catch (const InvalidArgument& error) {
            if (options.subdivision == Subdivision{}) { // the scene's own wish
                throw InputError(fmt::format("{}: {}", options.path.string(), error.what()));
            }
            throw;
        }
    }();
    std::vector<std::uint32_t> group_of(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        group_of[i] = mesh.group(i);
    }
    stop_if_interrupted();
    return {std::move(scene), std::move(mesh), std::move(group_of), watch.seconds()};
}

void refuse_all_but(const CommonOptions& common, std::span<const std::string> allowed,
                    const std::filesystem::path& file) {
    static const std::vector<std::string> always{"--json", "--quiet", "--verbose", "--color"};
    for (const std::string& option : common.given) {
        if (std::find(allowed.begin(), allowed.end(), option) == allowed.end() &&
            std::find(always.begin(), always.end(), option) == always.end()) {
            throw InvalidArgument(
                fmt::format("{} does not apply to {}, which is not a scene", option, file.string()));
        }
    }
}

std::uint64_t memory_limit(const RowOptions& options) {
    if (options.max_memory) {
        return *options.max_memory;
    }
    const std::uint64_t available = available_memory();
    return available / 10 * 8;
}

namespace {

/// The largest square up to `most` of which `hemicubes` allow every patch that many; at least `least`.
std::uint32_t eye_points_for(std::uint32_t hemicubes, std::uint32_t patches, std::uint32_t least,
                             std::uint32_t most) {
    const double side = std::floor(std::sqrt(static_cast<double>(hemicubes) / std::max(patches, 1u)));
    const auto k = static_cast<std::uint32_t>(std::clamp(side, 1.0, 8.0));
    return std::clamp(k * k, least, most);
}

} // namespace

RowPlan plan_rows(const RowOptions& options, std::uint32_t patches) {
    RowPlan plan;
    HemicubeSettings& hemicube = plan.hemicube;
    if (options.preset != "plain") {
        plan.hybrid.emplace();
    }
    // Visibility is as good as the eye points where patches are few and large, and as the texels a patch gets
    // where they are many and small.
    if (options.preset == "fast") {
        hemicube.resolution = 64;
        hemicube.near_eye_points = 4;
    } else if (options.preset == "default") {
        hemicube.eye_points = eye_points_for(6000, patches, 4, 16);
        hemicube.resolution = 64;
        hemicube.near_eye_points = 16;
        plan.hybrid->shadow_rays = 16;
    } else if (options.preset == "exact") {
        hemicube.eye_points = eye_points_for(20000, patches, 4, 64);
        hemicube.resolution = 128;
        hemicube.near_eye_points = 64;
        plan.hybrid->rule = ExchangeRule::exact;
        plan.hybrid->shadow_rays = 64;
    }
    hemicube.resolution = options.resolution.value_or(hemicube.resolution);
    if (options.eye_points) { // every patch as many as were asked for
        hemicube.eye_points = *options.eye_points;
        hemicube.near_eye_points = 1;
    }
    if (plan.hybrid) {
        plan.hybrid->shadow_rays = options.shadow_rays.value_or(plan.hybrid->shadow_rays);
    }
    hemicube.seed = options.seed.value_or(hemicube.seed);
    hemicube.merge_lattices = options.merge;
    return plan;
}

namespace {

EngineSettings engine_settings(const RowOptions& options) {
    EngineSettings settings;
    settings.device = options.device;
    settings.jobs = options.jobs;
    settings.worker_program = find_worker_program();
    return settings;
}

} // namespace

std::unique_ptr<RowProvider> make_engine(const PatchMesh& mesh, const HemicubeSettings& hemicube,
                                         const RowOptions& options) {
    return make_hemicube_engine(mesh, hemicube, engine_settings(options));
}

std::unique_ptr<VisibilityProvider> make_visibility(const PatchMesh& mesh, const HemicubeSettings& hemicube,
                                                    const RowOptions& options) {
    return make_visibility_engine(mesh, hemicube, engine_settings(options));
}

namespace {

/// Whether the hybrid's table of pairs and its matrix fit; says so where they do not.
bool hybrid_fits(VisibilityProvider& visibility, std::span<const std::uint32_t> patches,
                 const RowOptions& options, const Terminal& terminal) {
    const VisibilityWeightedEstimate estimate =
        estimate_visibility_weighted(visibility, patches, patches.size() > sample_above ? sample_rows : 0);
    if (patches.size() > sample_above) {
        terminal.detail(fmt::format("{} rows and their pairs will need about {}, and {} for visibility",
                                    count_text(patches.size()), memory_text(estimate.memory_bytes),
                                    seconds_text(estimate.seconds)));
    }
    const std::uint64_t limit = memory_limit(options);
    if (estimate.memory_bytes <= limit) {
        return true;
    }
    terminal.warn(fmt::format("--preset {} would need {} for the pairs of {} patches; the limit is {}. Plain "
                              "hemicube rows are computed instead",
                              options.preset, memory_text(estimate.memory_bytes),
                              count_text(visibility.size()), memory_text(limit)));
    return false;
}

} // namespace

/// What the raw rows depend on, besides the renderer.
io::CheckpointKey journal_key(const io::FactorFile& file, const RowPlan& plan) {
    const HemicubeSettings& hemicube = plan.hemicube;
    return {{"hemi", HEMI_VERSION},
            {"geometry", fmt::format("{:016x}", file.geometry_hash)},
            {"method", file.method},
            {"rows of", plan.hybrid ? "visibility" : "form factors"},
            {"resolution", std::to_string(hemicube.resolution)},
            {"seed", std::to_string(hemicube.seed)},
            {"eye points", std::to_string(hemicube.eye_points)},
            {"eye points near surfaces", std::to_string(hemicube.near_eye_points)},
            {"merging", hemicube.merge_lattices ? "on" : "off"}};
}

/// The provider itself, or one that keeps its rows.
template <class Row>
struct MaybeKept {
    std::unique_ptr<BasicRowProvider<Row>> keeping;
    BasicRowProvider<Row>& provider;

    MaybeKept(BasicRowProvider<Row>& bare, KeptRows* kept, io::CheckpointKey key)
        : keeping(kept != nullptr && kept->active() ? kept->keep(bare, std::move(key)) : nullptr),
          provider(keeping ? *keeping : bare) {}
};

/// Rows by one of the slow methods.
Rows compute_baseline_rows(const LoadedScene& loaded, std::span<const std::uint32_t> patches,
                           const RowOptions& options, const Terminal& terminal, KeptRows* kept,
                           const RowWatcher& watcher) {
    static const std::map<std::string, BaselineMethod> methods{{"direct", BaselineMethod::direct},
                                                               {"contour", BaselineMethod::contour},
                                                               {"montecarlo", BaselineMethod::montecarlo},
                                                               {"hemisphere", BaselineMethod::hemisphere}};
    BaselineSettings settings;
    settings.method = methods.at(options.method);
    settings.rays = options.rays.value_or(settings.rays);
    settings.resolution = options.resolution.value_or(settings.resolution);
    settings.seed = options.seed.value_or(settings.seed);
    const std::unique_ptr<RowProvider> provider = make_baseline(loaded.mesh, settings);
    RowPlan plan;
    plan.hemicube.seed = settings.seed;
    plan.hemicube.resolution = settings.method == BaselineMethod::hemisphere ? settings.resolution : 0;
    RowOptions named = options;
    named.preset = "none";
    Rows rows;
    rows.file = describe(loaded, named, plan);
    if (settings.method == BaselineMethod::direct || settings.method == BaselineMethod::contour) {
        terminal.note(fmt::format("--method {} finds factors as if nothing lay between", options.method));
    }
    io::CheckpointKey key = journal_key(rows.file, plan);
    key["rays"] = std::to_string(settings.rays);
    const MaybeKept<RowView> source(*provider, kept, std::move(key));
    WatchedRows<RowView> watched(source.provider, watcher);
    ProgressBar bar(terminal, "form factors", "rows");
    rows.file.factors = compute_matrix(watched, patches, bar.callback());
    rows.computed = patches.size() - (kept != nullptr ? kept->reused() : 0);
    rows.file.renderer = provider->renderer();
    rows.file.contacts = find_touching_faces(rows.file.factors, loaded.mesh);
    stop_if_interrupted();
    return rows;
}

Rows compute_rows(const LoadedScene& loaded, std::span<const std::uint32_t> patches,
                  const RowOptions& options, const Terminal& terminal, KeptRows* kept,
                  const RowWatcher& watcher) {
    if (options.method != "hemicube") {
        return compute_baseline_rows(loaded, patches, options, terminal, kept, watcher);
    }
    RowPlan plan = plan_rows(options, loaded.mesh.size());
    Rows rows;
    if (patches.empty()) {
        rows.file = describe(loaded, options, plan);
        rows.file.factors = FormFactorMatrix(loaded.mesh.size());
        rows.file.renderer = "none";
        return rows;
    }
    // What both kinds of rows have in common: kept, shown to the watcher, and timed while they are drawn.
    const auto compute = [&](auto& engine, const auto& factors) {
        using Row = typename std::remove_cvref_t<decltype(engine)>::RowType;
        stop_if_interrupted();
        rows.file = describe(loaded, options, plan);
        const MaybeKept<Row> source(engine, kept, journal_key(rows.file, plan));
        const std::uint64_t hemicubes_before = engine.hemicubes(); // of samples
        WatchedRows<Row> watched(source.provider, watcher);
        const Stopwatch watch;
        ProgressBar bar(terminal, plan.hybrid ? "visibility" : "form factors", "rows");
        const Progress shown = bar.callback();
        rows.file.factors = factors(watched, [&](std::size_t done, std::size_t total) {
            rows.drawing_seconds = watch.seconds();
            return shown(done, total);
        });
        rows.hemicubes = engine.hemicubes() - hemicubes_before;
        rows.computed = patches.size() - (kept != nullptr ? kept->reused() : 0);
        rows.file.renderer = engine.renderer();
        rows.file.contacts = find_touching_faces(rows.file.factors, loaded.mesh);
        stop_if_interrupted();
    };
    if (plan.hybrid) {
        const auto engine = make_visibility(loaded.mesh, plan.hemicube, options);
        if (!hybrid_fits(*engine, patches, options, terminal)) {
            RowOptions plain = options;
            plain.preset = "plain";
            return compute_rows(loaded, patches, plain, terminal, kept, watcher);
        }
        compute(*engine, [&](VisibilityProvider& visibility, const Progress& drawn) {
            // These start their clocks when their turn has come.
            std::optional<ProgressBar> combined;
            std::optional<ProgressBar> paired;
            const auto in_turn = [&terminal](std::optional<ProgressBar>& bar, const char* name) {
                return [&bar, &terminal, name](std::size_t done, std::size_t total) {
                    if (!bar) {
                        bar.emplace(terminal, name, "rows");
                    }
                    return bar->callback()(done, total);
                };
            };
            return compute_visibility_weighted(visibility, loaded.mesh, patches, *plan.hybrid,
                                               loaded.scene.enclosure, drawn, in_turn(combined, "pairs"),
                                               in_turn(paired, "form factors"));
        });
    } else {
        const auto engine = make_engine(loaded.mesh, plan.hemicube, options);
        if (patches.size() > sample_above) {
            const MatrixEstimate estimate = estimate_matrix(*engine, patches, sample_rows);
            terminal.detail(fmt::format("{} rows will need about {} and {}", count_text(patches.size()),
                                        memory_text(estimate.memory_bytes), seconds_text(estimate.seconds)));
            check_memory(estimate, patches.size(), options);
        }
        compute(*engine, [&](RowProvider& provider, const Progress& drawn) {
            return compute_matrix(provider, patches, drawn);
        });
    }
    return rows;
}

Rows reuse_rows(const std::filesystem::path& path, const LoadedScene& loaded, const RowOptions& options,
                const CommonOptions& common) {
    Rows rows;
    rows.file = io::read_hff(path);
    rows.reused = true;
    const io::FactorFile& file = rows.file;
    if (file.geometry_hash != loaded.mesh.geometry_hash() || file.factors.size() != loaded.mesh.size()) {
        throw InputError(fmt::format(
            "{}: these form factors belong to another geometry ({}; this scene has {}); "
            "remove the file or name another one",
            path.string(), plural(file.factors.size(), "patch", "patches"), count_text(loaded.mesh.size())));
    }
    rows.file.enclosure = enclosure_name(loaded.scene.enclosure);
    check_setting(common, path, "--resolution", options.resolution.value_or(0), file.resolution);
    check_setting(common, path, "--seed", options.seed.value_or(0), file.seed);
    check_setting(common, path, "--preset", options.preset, file.preset);
    check_setting(common, path, "--method", options.method, file.method);
    check_setting(common, path, "--eye-points", options.eye_points.value_or(0), file.eye_points);
    check_setting(common, path, "--shadow-rays", options.shadow_rays.value_or(0), file.shadow_rays);
    return rows;
}

std::vector<std::uint32_t> all_patches(std::uint32_t size) {
    std::vector<std::uint32_t> patches(size);
    std::iota(patches.begin(), patches.end(), 0u);
    return patches;
}

void settle_contacts(io::FactorFile& file) {
    const Enclosure enclosure = file.enclosure == "closed" ? Enclosure::closed
                                : file.enclosure == "open" ? Enclosure::open
                                                           : Enclosure::automatic;
    mark_touching_faces_buried(file.factors, file.contacts, enclosure);
}

EnclosureFinding find_leaks(const FormFactorMatrix& factors, const std::string& enclosure,
                            double max_row_error) {
    EnclosureFinding finding;
    finding.declared = enclosure == "closed";
    bool leaks = false;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const double share = factors.known(i) ? factors.row(i).environment : 0.0;
        leaks = leaks || share > 0.0;
        if (finding.declared && share > max_row_error) {
            finding.leaks.push_back(i);
        }
    }
    finding.closed = finding.declared || (enclosure == "auto" && !leaks);
    std::stable_sort(finding.leaks.begin(), finding.leaks.end(), [&](std::uint32_t a, std::uint32_t b) {
        return factors.row(a).environment > factors.row(b).environment;
    });
    return finding;
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
        fmt::format("the enclosure is said to be closed, but {} more than {} into the open. Worst: ",
                    finding.leaks.size() == 1 ? std::string("1 patch loses")
                                              : plural(finding.leaks.size(), "patch", "patches") + " lose",
                    max_row_error);
    for (std::size_t k = 0; k < shown.size(); ++k) {
        message += fmt::format("{}{} {}{}", k == 0 ? "" : "; ", names.describe(shown[k]),
                               number_text(factors.row(shown[k]).environment), towards_text(directions[k]));
    }
    terminal.error(message);
}

void report_covered(const RowSums& sums, const Terminal& terminal) {
    if (sums.covered > 0) {
        terminal.warn(
            fmt::format("{} covered: the centre lies under or inside something (`hemi check` lists them)",
                        plural(sums.covered, "patch is", "patches are")));
    }
}

std::string rows_summary(const Rows& rows, const RowSums& sums, const EnclosureFinding& enclosure) {
    const FormFactorMatrix& factors = rows.file.factors;
    std::string text = summary_line("renderer", rows.file.renderer);
    const std::string rays =
        rows.file.shadow_rays > 0 ? ", " + plural(rows.file.shadow_rays, "shadow ray", "shadow rays") : "";
    std::string cubes =
        fmt::format("resolution {}, {}{}, seed {}", rows.file.resolution,
                    plural(rows.file.eye_points, "eye point", "eye points"), rays, rows.file.seed);
    if (rows.reused) {
        cubes += ", rows from a file";
    } else if (rows.hemicubes > 0) {
        cubes += fmt::format(", {} in {}: {:.0f}/s", count_text(rows.hemicubes),
                             seconds_text(rows.drawing_seconds),
                             static_cast<double>(rows.hemicubes) / std::max(rows.drawing_seconds, 1e-9));
    }
    text += summary_line("hemicubes", cubes);
    const double per_row = static_cast<double>(factors.entries()) / std::max<double>(sums.known, 1.0);
    text += summary_line("entries", fmt::format("{} ({:.0f} a row), {}", count_text(factors.entries()),
                                                per_row, memory_text(factors.memory_bytes())));
    text += summary_line("row sums", row_sum_text(sums));
    text +=
        summary_line("", fmt::format("to the environment up to {}, blocked up to {}{}",
                                     number_text(sums.environment_max), number_text(sums.blocked_max),
                                     sums.covered > 0 ? fmt::format(", {} covered", count_text(sums.covered))
                                                      : std::string()));
    text += summary_line("enclosure", std::string(enclosure.closed ? "closed" : "open") +
                                          (enclosure.declared ? " (declared)" : ""));
    return text;
}

} // namespace hemi::cli
