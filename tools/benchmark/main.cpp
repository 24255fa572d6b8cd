// Times hemicube rows against the naive design. Run by tools/bench.

#include "benchmark/files.hpp"
#include "benchmark/frames.hpp"
#include "benchmark/measurements.hpp"
#include "benchmark/program.hpp"
#include "benchmark/refinement.hpp"
#include "engine/workers/worker_pool.hpp"
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
    std::string meshes;
    std::string json;
    bool quick = false;
    bool files = false;
    bool refinement = false;
};

void declare(CLI::App& app, Options& options) {
    app.add_option("--device", options.device, "OpenGL: auto, egl, egl:N or osmesa (default auto)");
    app.add_option("--meshes", options.meshes, "folder of the meshes that tools/bench makes")->required();
    app.add_option("--scenes", options.scenes, "folder of the scene files (default scenes)");
    app.add_option("--json", options.json, "write the figures to this file too");
    app.add_flag("--quick", options.quick, "no table, small samples");
    app.add_flag("--files", options.files, "only writers and readers of files");
    app.add_flag("--refinement", options.refinement, "only patches that are cut until an error is met");
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
    for (const auto& [preset, most_seconds] : {std::pair("plain", 3.0), std::pair("default", 2.0)}) {
        measurements.solve_target(this_program().parent_path() / "hemi",
                                  std::filesystem::path(options.scenes) / "cornell-box.json", preset,
                                  options.quick ? 3 : 5, most_seconds);
    }
    frame_target(this_program(), options.device, report);
}

Case read_mesh(const Options& options, const char* name) {
    return read_case(std::filesystem::path(options.meshes) / name);
}

/// The CPU rasteriser: meshes without flat lattices, and merged scenes.
void print_cpu_findings(Measurements& measurements, const Case& office, const Options& options) {
    const Case bumpy_5k = read_mesh(options, "bumpy-5k.obj");
    const Case bumpy_20k = read_mesh(options, "bumpy-20k.obj");
    const Case bumpy_80k = read_mesh(options, "bumpy-80k.obj");
    measurements.cpu_target(bumpy_5k, 200, 6.0, 4.0);
    measurements.cpu_target(bumpy_20k, 200, 5.0, 8.0);
    if (!options.quick) {
        measurements.cpu_target(bumpy_80k, 200, 0.0, 0.0);
    }
    measurements.cpu_growth_target(bumpy_20k, bumpy_80k, 64, 2.2);
    measurements.cpu_rates(bumpy_20k, 200, 1500.0, 1.85);
    for (const std::uint32_t resolution : {64u, 128u}) {
        const Case box = read_case(std::filesystem::path(options.scenes) / "cornell-box.json");
        for (const Case& scene : {box, make_room(10000), office}) {
            measurements.cpu_target(scene, resolution, 0.0, 2.0);
        }
    }
}

/// The CPU rasteriser on cities of many triangles.
void print_city_findings(Measurements& measurements, const Options& options) {
    for (const char* name : {"city-22k.obj", "city-100k.obj"}) {
        const Case city = read_mesh(options, name);
        for (const std::uint32_t resolution : {64u, 128u}) {
            measurements.cpu_target(city, resolution, 0.0, 0.0);
        }
    }
    if (!options.quick) {
        measurements.cpu_target(read_mesh(options, "city-1000k.obj"), 32, 0.0, 10.0);
    }
}

/// The whole program on dense meshes, by the default preset.
void print_program_findings(Measurements& measurements, const Options& options) {
    const std::filesystem::path hemi = this_program().parent_path() / "hemi";
    const std::filesystem::path meshes = options.meshes;
    measurements.factors_target(hemi, meshes / "pillars-18k.obj", options.quick ? 1 : 3, 40.0, 0.0);
    measurements.factors_target(hemi, meshes / "bumpy-20k.obj", 1, 0.0, options.quick ? 0.0 : 8.0);
}

/// Patches that follow from the solution.
void print_refinement_findings(Report& report, const Options& options) {
    const std::filesystem::path scenes = options.scenes;
    refinement_target(scenes / "cornell-box.json", 0.01, 0.25, 1.0 / 3.0, report);
    refinement_target(scenes / "l-room.json", 0.01, 0.25, 1.0 / 3.0, report);
    refinement_target(scenes / "office.json", 0.02, 1.0 / 3.0, 0.0, report);
}

Setup make_setup(const Options& options, const gl::Context& context, unsigned cores) {
    Setup setup;
    setup.device = context.name();
    setup.software = context.software();
    setup.worker_program = find_worker_program();
    setup.workers = context.software() ? cores : std::min(cores, gpu_processes);
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
    const Setup setup = make_setup(options, *context, cores);
    context.reset();

    Report report(circumstances_of(setup, renderer, cores));
    const auto write_json = [&] {
        if (!options.json.empty()) {
            report.write_json(options.json);
        }
    };
    write_json(); // a file that cannot be written is told now, not after minutes
    Measurements measurements(setup, report);
    const bool all = !options.files && !options.refinement;
    if (!options.quick && all) {
        print_table(measurements, report, office, city);
    }
    if (all) {
        print_findings(measurements, report, office, city, options);
        print_cpu_findings(measurements, office, options);
        print_city_findings(measurements, options);
        print_program_findings(measurements, options);
    }
    if (options.refinement || (all && !options.quick)) {
        print_refinement_findings(report, options);
    }
    if (!options.refinement) {
        measure_files(report, setup.effort.rounds);
    }
    write_json();
}

} // namespace

int main(int argc, char** argv) try {
    if ((argc == 3 || argc == 4) && std::string_view(argv[1]) == frames_argument) {
        return run_frames(argv[2], argc == 4 ? argv[3] : "");
    }
    // One thread a context, naive or not; read when the first context is made.
    setenv("LP_NUM_THREADS", "0", 1);
    keep_freed_memory();
    Options options;
    CLI::App app("Times hemicube rows against the naive design", "tools/bench");
    declare(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? EXIT_SUCCESS : 2;
    }
    run(options);
    return EXIT_SUCCESS;
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench: %s\n", error.what());
    return EXIT_FAILURE;
}
