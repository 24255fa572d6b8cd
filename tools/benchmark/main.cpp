// Times hemicube rows against the naive design. Run by tools/bench.

#include "benchmark/files.hpp"
#include "benchmark/frames.hpp"
#include "benchmark/measurements.hpp"
#include "benchmark/program.hpp"
#include "gl/context.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <thread>

namespace {

using namespace hemi;
using namespace hemi::bench;

struct Options {
    std::string device = "auto";
    std::string scenes = "scenes";
    std::string json;
    bool quick = false;
    bool files = false;
};

void declare(CLI::App& app, Options& options) {
    app.add_option("--device", options.device, "auto, egl, egl:N or osmesa (default auto)");
    app.add_option("--scenes", options.scenes, "folder of the scene files (default scenes)");
    app.add_option("--json", options.json, "write the figures to this file too");
    app.add_flag("--quick", options.quick, "no table, small samples");
    app.add_flag("--files", options.files, "only writers and readers of files");
}

void print_table(Measurements& measurements, const Report& report, const Case& office, const Case& city) {
    report.table_head();
    for (const std::uint32_t patches : {2000u, 10000u, 50000u}) {
        measurements.table(make_room(patches));
    }
    measurements.table(office);
    measurements.table(city);
}

void print_findings(Measurements& measurements, Report& report, const Case& office, const Case& city,
                    const Options& options) {
    report.findings_head();
    measurements.naive_target(10000, 20.0);
    measurements.growth_target(2000, 50000, 1.5);
    measurements.workers_target(10000, 1.8);
    measurements.scene_rate(office);
    measurements.merging_target(city, 3.0);
    measurements.solve_target(this_program().parent_path() / "hemi",
                              std::filesystem::path(options.scenes) / "cornell-box.json",
                              options.quick ? 3 : 5, 3.0);
    frame_target(this_program(), options.device, report);
}

Setup make_setup(const Options& options, unsigned workers) {
    Setup setup;
    setup.device = options.device;
    setup.worker_program = find_worker_program();
    setup.workers = workers;
    setup.effort.seconds = options.quick ? 0.2 : 0.5;
    return setup;
}

Circumstances circumstances_of(const Setup& setup, const std::string& renderer, unsigned cores) {
    return {renderer, cores, setup.workers, setup.seed, setup.effort.seconds, setup.effort.rounds};
}

void run(const Options& options) {
    const std::filesystem::path scenes = options.scenes;
    const Case office = read_case(scenes / "office.json");
    const Case city = read_case(scenes / "city.obj");
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    auto context = gl::make_context(options.device);
    const std::string renderer = context->renderer();
    const Setup setup = make_setup(options, context->software() ? cores : 0);
    context.reset();

    Report report(circumstances_of(setup, renderer, cores));
    const auto write_json = [&] {
        if (!options.json.empty()) {
            report.write_json(options.json);
        }
    };
    write_json(); // a file that cannot be written is told now, not after minutes
    Measurements measurements(setup, report);
    if (!options.quick && !options.files) {
        print_table(measurements, report, office, city);
    }
    if (!options.files) {
        print_findings(measurements, report, office, city, options);
    }
    measure_files(report, setup.effort.rounds);
    write_json();
}

} // namespace

int main(int argc, char** argv) {
    if (argc == 3 && std::string_view(argv[1]) == frames_argument) {
        return run_frames(argv[2]);
    }
    // One thread a context, naive or not; read when the first context is made.
    setenv("LP_NUM_THREADS", "0", 1);
    keep_freed_memory();
    Options options;
    CLI::App app("Times hemicube rows against the naive design", "tools/bench");
    declare(app, options);
    try {
        app.parse(argc, argv);
        run(options);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? EXIT_SUCCESS : 2;
    } catch (const std::exception& error) {
        fmt::print(stderr, "bench: {}\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
