#include "benchmark/refinement.hpp"

#include "hemi/core/diagnostics.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/coarse_mesh.hpp"
#include "hemi/pipeline/patch_size_error.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/pipeline/refinement.hpp"
#include "hemi/scene/imprint.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hemi::bench {

namespace {

/// Of evenly cut patches: N goes up by 1.4 from one to the next.
constexpr double next_size = 0.84;
/// As large as pairs of patches fit these machines.
constexpr std::uint32_t most_patches = 40000;

struct Solved {
    double error = 0.0; ///< estimated
    double seconds = 0.0;
};

/// As `hemi solve --patch-size` would do it, with as large a sample for the error as refinement takes.
Solved solve_evenly(const Scene& scene, const PatchMesh& mesh, const FactorSettings& settings) {
    const Stopwatch watch;
    const FormFactors factors = compute_form_factors(scene, mesh, settings);
    Solution solution = solve_radiosity(scene, mesh, factors);
    gather_at_vertices(scene, mesh, settings, Gather::automatic, solution);
    solution.patch_size_error =
        estimate_patch_size_error(scene, mesh, factors, solution, settings, no_observer(), {.effort = 2.0});
    const auto error = solution_error(solution);
    if (!error) {
        throw Error("the error of a scene of the benchmark cannot be estimated");
    }
    return {error->vertices.rms, watch.seconds()};
}

} // namespace

void refinement_target(const std::filesystem::path& scene_file, double error, double most_rows,
                       double most_seconds, Report& report) {
    Diagnostics diagnostics;
    const Scene scene = io::read_scene(scene_file, {}, diagnostics);
    FactorSettings settings;
    settings.engine.device = cpu_device;
    RefinementGoal goal;
    goal.error = error;
    const Stopwatch watch;
    const Refinement cut = solve_refined(scene, coarse_mesh(scene, true).mesh, settings, {}, goal);
    const double seconds = watch.seconds();
    std::uint64_t rows = 0;
    for (const Refinement::Step& step : cut.steps) {
        rows += step.rows;
    }
    const std::string name = scene_file.stem().string();
    report.finding({fmt::format("{} at {:.0f} % of vertices, {} cut patches{}", name, 100.0 * error,
                                cut.mesh.size(), cut.stopped.empty() ? "" : " (not met)"),
                    seconds, "s"});
    double area = 0.0;
    for (const double patch : cut.mesh.areas()) {
        area += patch;
    }
    Subdivision subdivision;
    subdivision.patch_size = std::sqrt(area / cut.mesh.size());
    for (;;) {
        const auto without_hidden = imprint(scene, subdivision);
        const PatchMesh mesh =
            without_hidden ? PatchMesh(without_hidden->scene) : PatchMesh(scene, subdivision);
        if (mesh.size() > most_patches) {
            report.finding(
                {fmt::format("  evenly cut ones do not meet it with {} patches", most_patches), 0.0, ""});
            return;
        }
        const Solved even = solve_evenly(scene, mesh, settings);
        if (even.error <= error) {
            report.finding({fmt::format("  rows, of those of {} evenly cut patches", mesh.size()),
                            static_cast<double>(rows) / mesh.size(), "", Bound::at_most, most_rows});
            report.finding({"  time, of theirs", seconds / even.seconds, "",
                            most_seconds > 0.0 ? Bound::at_most : Bound::none, most_seconds});
            return;
        }
        *subdivision.patch_size *= next_size;
    }
}

} // namespace hemi::bench
