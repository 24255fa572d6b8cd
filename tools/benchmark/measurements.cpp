#include "benchmark/measurements.hpp"

#include "benchmark/embree_rows.hpp"
#include "benchmark/naive_rows.hpp"
#include "benchmark/program.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/baselines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include <unistd.h>

namespace hemi::bench {

namespace {

constexpr std::uint32_t usual_resolution = 128;
constexpr std::uint32_t compared_rows = 48;

// Blocks of rows for each worker: the more, the less it weighs that one ends before the other.
constexpr std::uint32_t few_blocks = 4;
constexpr std::uint32_t many_blocks = 16;

double per_second(const Series& seconds_per_row) {
    return 1.0 / median(seconds_per_row);
}

std::string workers_text(std::uint32_t workers) {
    return workers == 0 ? "one core" : fmt::format("{} worker{}", workers, workers == 1 ? "" : "s");
}

/// A file name of its own in the temporary folder; the file goes when this does.
class TemporaryPicture {
public:
    TemporaryPicture()
        : path_(std::filesystem::temp_directory_path() / fmt::format("hemi-bench-{}.png", getpid())) {}
    ~TemporaryPicture() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    TemporaryPicture(const TemporaryPicture&) = delete;
    TemporaryPicture& operator=(const TemporaryPicture&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

private:
    std::filesystem::path path_;
};

} // namespace

HemicubeSettings Measurements::settings(std::uint32_t resolution) const {
    HemicubeSettings settings;
    settings.resolution = resolution;
    settings.seed = setup_.seed;
    return settings;
}

std::unique_ptr<RowProvider> Measurements::engine(const Case& scene, const HemicubeSettings& settings,
                                                  std::uint32_t workers) const {
    EngineSettings where;
    where.device = setup_.device;
    where.jobs = workers;
    where.worker_program = workers == 0 ? std::filesystem::path() : setup_.worker_program;
    return make_hemicube_engine(scene.mesh, settings, where);
}

std::vector<std::uint32_t> Measurements::rows_for(RowProvider& single, std::uint32_t blocks_a_worker) const {
    // Whole blocks of the matrix, as workers are given them.
    constexpr std::uint32_t together = FormFactorMatrix::block_rows;
    const std::uint32_t least = std::max(1u, setup_.workers) * blocks_a_worker * together;
    return spread_rows(single.size(), rows_within(single, setup_.effort.seconds, least), together);
}

Subject Measurements::subject(RowProvider& provider, std::vector<std::uint32_t> rows) const {
    return row_subject(provider, std::move(rows), setup_.effort.seconds);
}

void Measurements::compare_rows(const Case& scene) {
    const HemicubeSettings compared = settings(usual_resolution);
    const auto ours = engine(scene, compared, 0);
    NaiveRows naive(scene.mesh, compared, setup_.device);
    EmbreeRows embree(scene.mesh, compared, EmbreeRows::Rays::texels);
    const auto rows = spread_rows(scene.mesh.size(), compared_rows, 1);
    const double naive_difference = row_difference(naive, *ours, rows);
    const double embree_difference = row_difference(embree, *ours, rows);
    double random_difference = 0.0;
    if (scene.mesh.size() <= max_baseline_patches) {
        EmbreeRows monte_carlo(scene.mesh, compared, EmbreeRows::Rays::monte_carlo);
        BaselineSettings rays;
        rays.method = Method::montecarlo;
        rays.rays = monte_carlo.rays_a_row();
        rays.seed = compared.seed;
        random_difference = row_difference(monte_carlo, *make_baseline(scene.mesh, rays), rows);
    }
    report_.scene(scene.name, scene.mesh.size(), scene.mesh.surfaces().size(), naive_difference,
                  embree_difference);
    for (const double difference : {naive_difference, embree_difference, random_difference}) {
        if (difference > most_difference) {
            throw Error(
                fmt::format("{}: rows differ by {:.1e} of a row from the engine's, more than {:g}: they "
                            "are not the same work, so their times cannot be compared",
                            scene.name, difference, most_difference));
        }
    }
}

Cell Measurements::cell(const Case& scene, std::uint32_t resolution) const {
    const HemicubeSettings timed = settings(resolution);
    const auto single = engine(scene, timed, 0);
    NaiveRows naive(scene.mesh, timed, setup_.device);
    const auto rows = rows_for(*single, few_blocks);
    EmbreeRows embree(scene.mesh, timed, EmbreeRows::Rays::texels);
    EmbreeRows monte_carlo(scene.mesh, timed, EmbreeRows::Rays::monte_carlo);
    std::vector<Subject> subjects{subject(*single, rows)};
    const auto add_slow = [&](RowProvider& provider) {
        subjects.push_back(
            subject(provider, spread_rows(provider.size(), rows_within(provider, setup_.effort.seconds), 1)));
    };
    add_slow(naive);
    add_slow(embree);
    add_slow(monte_carlo);
    std::vector<std::unique_ptr<RowProvider>> pools;
    for (const std::uint32_t workers : {1u, setup_.workers}) {
        pools.push_back(engine(scene, timed, workers));
        static_cast<void>(rows_within(*pools.back(), 0.0)); // starts the workers
        subjects.push_back(subject(*pools.back(), rows));
    }
    const auto series = time_interleaved(subjects, setup_.effort.rounds);

    Cell result{scene.name, scene.mesh.size(), resolution, per_second(series[0])};
    result.naive = per_second(series[1]);
    result.ratio = median_ratio(series[1], series[0]);
    result.embree = per_second(series[2]);
    result.monte_carlo = per_second(series[3]);
    result.one_worker = per_second(series[4]);
    result.all_workers = per_second(series[5]);
    return result;
}

void Measurements::table(const Case& scene) {
    compare_rows(scene);
    for (const std::uint32_t resolution : {64u, 128u, 256u, 512u}) {
        report_.cell(cell(scene, resolution));
    }
}

void Measurements::naive_target(std::uint32_t patches, double least_ratio) {
    const Case room = make_room(patches);
    const HemicubeSettings timed = settings(usual_resolution);
    const auto single = engine(room, timed, 0);
    NaiveRows naive(room.mesh, timed, setup_.device);
    const auto compared = spread_rows(room.mesh.size(), compared_rows, 1);
    const double difference = row_difference(naive, *single, compared);
    report_.finding({fmt::format("naive and engine rows differ, {} patches", room.mesh.size()),
                     100.0 * difference, "%", Bound::at_most, 100.0 * most_difference});
    const std::array<Subject, 2> subjects{
        subject(*single, rows_for(*single, few_blocks)),
        subject(naive, spread_rows(naive.size(), rows_within(naive, setup_.effort.seconds), 1))};
    const CoreShare share;
    const auto series = time_interleaved(subjects, setup_.effort.rounds);
    const double core_percent = 100.0 * share.so_far();
    report_.finding({fmt::format("speed over naive, {} patches, one core each", room.mesh.size()),
                     median_ratio(series[1], series[0]), "x", software_bound(), least_ratio});
    report_.finding(
        {"  of that core, this program got (less than 95: the machine is busy)", core_percent, "%"});
}

void Measurements::growth_target(std::uint32_t few, std::uint32_t many, double most_ratio) {
    const Case room_of_few = make_room(few);
    const Case room_of_many = make_room(many);
    report_.finding({"fresh memory is written at", 1e-9 * fresh_memory_rate(), "GB/s"});
    growth(0, room_of_few, room_of_many, most_ratio);
    if (setup_.workers > 1) {
        growth(setup_.workers, room_of_few, room_of_many, most_ratio);
    }
}

void Measurements::growth(std::uint32_t workers, const Case& few, const Case& many, double most_ratio) {
    const HemicubeSettings timed = settings(usual_resolution);
    const auto with_few = engine(few, timed, workers);
    const auto with_many = engine(many, timed, workers);
    const std::array<Subject, 2> subjects{subject(*with_few, rows_for(*with_few, many_blocks)),
                                          subject(*with_many, rows_for(*with_many, many_blocks))};
    const auto ratio = [&] {
        const auto series = time_interleaved(subjects, setup_.effort.rounds);
        return median_ratio(series[1], series[0]);
    };
    const std::string what = fmt::format("cost of a row, {} patches over {}, {}", many.mesh.size(),
                                         few.mesh.size(), workers_text(workers));
    static_cast<void>(subjects[1]()); // touches what the runs that count write
    report_.finding({what + ", memory touched before", ratio(), "x"});
    const FreshMemory fresh;
    report_.finding({"  the same, every matrix in fresh memory", ratio(), "x", Bound::at_most, most_ratio});
}

void Measurements::workers_target(std::uint32_t patches, double least_ratio) {
    if (setup_.workers < 2) {
        return;
    }
    const Case room = make_room(patches);
    const HemicubeSettings timed = settings(usual_resolution);
    const auto one = engine(room, timed, 1);
    const auto two = engine(room, timed, 2);
    const auto rows = rows_for(*one, many_blocks);
    static_cast<void>(rows_within(*two, 0.0)); // starts the workers
    const std::array<Subject, 2> subjects{subject(*one, rows), subject(*two, rows)};
    const auto series = time_interleaved(subjects, setup_.effort.rounds);
    report_.finding({fmt::format("speed of two workers over one, {} patches", room.mesh.size()),
                     median_ratio(series[0], series[1]), "x", software_bound(), least_ratio});
}

void Measurements::scene_rate(const Case& scene) {
    const HemicubeSettings timed = settings(usual_resolution);
    const auto provider = engine(scene, timed, setup_.workers);
    const auto rows = rows_for(*provider, many_blocks);
    const std::array<Subject, 1> subjects{subject(*provider, rows)};
    const auto series = time_interleaved(subjects, setup_.effort.rounds);
    report_.finding(
        {fmt::format("{}, {} patches, {}", scene.name, scene.mesh.size(), workers_text(setup_.workers)),
         per_second(series[0]), "rows/s"});
}

void Measurements::merging_target(const Case& scene, double least_ratio) {
    const HemicubeSettings merged = settings(usual_resolution);
    HemicubeSettings unmerged = merged;
    unmerged.merge_lattices = false;
    const auto fast = engine(scene, merged, setup_.workers);
    const auto slow = engine(scene, unmerged, setup_.workers);
    const auto rows = rows_for(*slow, many_blocks);
    static_cast<void>(rows_within(*fast, 0.0)); // starts the workers
    const std::array<Subject, 2> subjects{subject(*fast, rows), subject(*slow, rows)};
    const auto series = time_interleaved(subjects, setup_.effort.rounds);
    const std::string what =
        fmt::format("{}, {} patches, {}", scene.name, scene.mesh.size(), workers_text(setup_.workers));
    report_.finding({what + ", merging", per_second(series[0]), "rows/s"});
    report_.finding({what + ", merging off", per_second(series[1]), "rows/s"});
    report_.finding({scene.name + ", speed with merging over without", median_ratio(series[1], series[0]),
                     "x", Bound::at_least, least_ratio});
}

void Measurements::solve_target(const std::filesystem::path& hemi, const std::filesystem::path& scene,
                                const std::string& preset, unsigned runs, double most_seconds) {
    const TemporaryPicture picture;
    const std::vector<std::string> arguments{"solve", scene.string(),         "-q", "--preset", preset,
                                             "-o",    picture.path().string()};
    const std::array<Subject, 1> subjects{[&] { return run_timed(hemi, arguments); }};
    const auto series = time_interleaved(subjects, runs);
    report_.finding({fmt::format("hemi solve {} --preset {}, wall time, median of {}",
                                 scene.filename().string(), preset, runs),
                     median(series[0]), "s", Bound::at_most, most_seconds});
}

void Measurements::factors_target(const std::filesystem::path& hemi, const std::filesystem::path& mesh,
                                  unsigned runs, double most_seconds, double least_over_osmesa) {
    const auto run_on = [&](const char* device) {
        return Subject([=] { return run_timed(hemi, {"factors", mesh.string(), "-q", "--device", device}); });
    };
    const auto what = [&](const char* device) {
        return fmt::format("hemi factors {} --device {}, wall time, median of {}", mesh.filename().string(),
                           device, runs);
    };
    const bool with_osmesa = least_over_osmesa > 0.0;
    std::vector<Subject> subjects{run_on(cpu_device)};
    if (with_osmesa) {
        subjects.push_back(run_on("osmesa"));
    }
    const auto series = time_interleaved(subjects, runs);
    report_.finding({what(cpu_device), median(series[0]), "s",
                     most_seconds > 0.0 ? Bound::at_most : Bound::none, most_seconds});
    if (with_osmesa) {
        report_.finding({what("osmesa"), median(series[1]), "s"});
        report_.finding({"  speed on cpu over it", median_ratio(series[1], series[0]), "x", Bound::at_least,
                         least_over_osmesa});
    }
}

std::unique_ptr<RowProvider> Measurements::cpu_engine(const Case& scene, std::uint32_t resolution,
                                                      std::uint32_t threads) const {
    return make_hemicube_engine(scene.mesh, settings(resolution), {cpu_device, threads, {}});
}

void Measurements::cpu_target(const Case& scene, std::uint32_t resolution, double least_over_embree,
                              double least_over_gl) {
    const auto cpu = cpu_engine(scene, resolution, 1);
    const auto drawn = engine(scene, settings(resolution), 0);
    EmbreeRows embree(scene.mesh, settings(resolution), EmbreeRows::Rays::texels);
    const auto compared = spread_rows(scene.mesh.size(), compared_rows, 1);
    for (RowProvider* const other : {drawn.get(), static_cast<RowProvider*>(&embree)}) {
        if (const double difference = row_difference(*other, *cpu, compared); difference > most_difference) {
            throw Error(fmt::format("{}: rows of {} differ by {:.1e} of a row from those of {}", scene.name,
                                    other->renderer(), difference, cpu->renderer()));
        }
    }
    const auto rows_of = [&](RowProvider& provider) {
        return spread_rows(provider.size(), rows_within(provider, setup_.effort.seconds), 1);
    };
    const std::array<Subject, 3> subjects{subject(*cpu, rows_of(*cpu)), subject(embree, rows_of(embree)),
                                          subject(*drawn, rows_of(*drawn))};
    const auto series = time_interleaved(subjects, setup_.effort.rounds);
    const std::string what =
        fmt::format("{}, {} patches, resolution {}, one core", scene.name, scene.mesh.size(), resolution);
    report_.finding({fmt::format("{}: {}", what, cpu->renderer()), per_second(series[0]), "hemicubes/s"});
    report_.finding({"  over " + embree.renderer(), median_ratio(series[1], series[0]), "x",
                     least_over_embree > 0.0 ? Bound::at_least : Bound::none, least_over_embree});
    report_.finding({"  over " + drawn->renderer(), median_ratio(series[2], series[0]), "x",
                     least_over_gl > 0.0 ? software_bound() : Bound::none, least_over_gl});
}

void Measurements::cpu_rates(const Case& scene, std::uint32_t resolution, double least_rate,
                             double least_ratio) {
    const auto one = cpu_engine(scene, resolution, 1);
    const auto two = cpu_engine(scene, resolution, 2);
    const auto all = cpu_engine(scene, resolution, 0);
    const auto rows = rows_for(*one, many_blocks);
    const std::array<Subject, 3> subjects{subject(*one, rows), subject(*two, rows), subject(*all, rows)};
    const auto series = time_interleaved(subjects, setup_.effort.rounds);
    report_.finding({fmt::format("{}, {} patches, resolution {}, all cores: {}", scene.name,
                                 scene.mesh.size(), resolution, all->renderer()),
                     per_second(series[2]), "hemicubes/s", Bound::at_least, least_rate});
    report_.finding(
        {"  two threads over one", median_ratio(series[0], series[1]), "x", Bound::at_least, least_ratio});
}

void Measurements::cpu_growth_target(const Case& few, const Case& many, std::uint32_t resolution,
                                     double most_ratio) {
    const auto with_few = cpu_engine(few, resolution, 1);
    const auto with_many = cpu_engine(many, resolution, 1);
    const std::array<Subject, 2> subjects{subject(*with_few, rows_for(*with_few, few_blocks)),
                                          subject(*with_many, rows_for(*with_many, few_blocks))};
    const auto series = time_interleaved(subjects, setup_.effort.rounds);
    report_.finding(
        {fmt::format("cost of a row on the CPU, {} over {}, resolution {}", many.name, few.name, resolution),
         median_ratio(series[1], series[0]), "x", Bound::at_most, most_ratio});
}

} // namespace hemi::bench
