#include "cli/cluster_settings.hpp"
#include "cli/commands.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/output_paths.hpp"
#include "cli/picture_output.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/error.hpp"
#include "hemi/display/lightmap.hpp"
#include "hemi/io/baked_mesh_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/pipeline/vertex_gather.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::cli {

namespace {

/// Corner values of a flat picture: the patch's own at all four.
std::vector<float> flat_corners(const std::vector<float>& patches) {
    std::vector<float> corners;
    corners.reserve(4 * patches.size());
    for (auto patch = patches.begin(); patch != patches.end(); patch += 3) {
        for (int corner = 0; corner < 4; ++corner) {
            corners.insert(corners.end(), patch, patch + 3);
        }
    }
    return corners;
}

bool has_lightmap(const BakeArguments& arguments) {
    const std::vector<std::string>& given = arguments.common.given;
    return std::find(given.begin(), given.end(), "--lightmap") != given.end();
}

void write_baked(const BakeArguments& arguments, const Outputs& outputs, const Scene& scene,
                 const PatchMesh& mesh, const Solution& solution, const Terminal& terminal) {
    const PictureMesh picture = make_picture_mesh(
        mesh, solution.channels, solution.radiosity, solution.back_face_share,
        channels_to_show(scene.channels, arguments.picture.show, false), solution.vertex_radiosity);
    const double exposure = arguments.picture.exposure
                                ? *arguments.picture.exposure
                                : automatic_exposure(mesh, picture, solution.back_face_share,
                                                     solution.exitance, solution.channels);
    const std::filesystem::path& path = *arguments.picture.output;
    const std::vector<float> corners =
        arguments.picture.flat ? flat_corners(picture.patches) : picture.corners;
    Report report;
    report.json["lightmap"] = nullptr;
    if (has_lightmap(arguments)) {
        const Lightmap lightmap = make_lightmap(mesh, corners, arguments.picture.size[0]);
        io::write_lightmapped_glb(path, mesh, corners, exposure,
                                  {lightmap.size, lightmap.texels, lightmap.coordinates});
        report.add("lightmap",
                   fmt::format("{0} x {0} texels, {1} along the edge of a patch", lightmap.size,
                               lightmap.patch_size),
                   {{"lightmap", {{"size", lightmap.size}, {"patch_size", lightmap.patch_size}}}});
    } else {
        (extension_of(path) == ".ply" ? io::write_baked_ply : io::write_baked_glb)(path, mesh, corners,
                                                                                   exposure);
    }
    report.add("baked",
               fmt::format("{} ({}, exposure {}{})",
                           is_standard_output(path) ? "standard output" : path.string(),
                           plural(mesh.size(), "patch", "patches"), number_text(exposure),
                           arguments.picture.exposure ? "" : ", automatic"),
               {{"output", path.string()}, {"patches", mesh.size()}, {"exposure", exposure}});
    report.select("hemi/bake/1", {"output", "patches", "exposure", "lightmap"});
    outputs.show(report, arguments.common.json, terminal);
}

ExitStatus bake_scene(const BakeArguments& given, const Outputs& outputs, const Terminal& terminal) {
    BakeArguments arguments = given;
    settle_clusters(arguments.common, arguments.rows, obstacle_of_solver(arguments.solver));
    TerminalObserver observer(terminal);
    const auto loaded = load_scene(arguments.scene, terminal);
    (void)channels_to_show(loaded.scene.channels, arguments.picture.show, false);
    advise_patch_size(loaded, terminal);
    FactorSettings settings = arguments.rows.factors;
    settings.estimate_error = false;
    FormFactors factors = compute_raw_form_factors(
        loaded.scene, loaded.mesh, reflecting_patches(loaded.scene, loaded.mesh), settings, observer);
    prepare_form_factors(factors, settings.repair, observer);
    const EnclosureFinding enclosure = find_leaks(factors, arguments.rows.max_row_error);
    report_buried(row_sums(factors.matrix), terminal);
    Solution solution =
        solve_radiosity(loaded.scene, loaded.mesh, factors, arguments.solver, observer, false);
    if (!arguments.picture.flat) {
        gather_at_vertices(loaded.scene, loaded.mesh, settings, arguments.gather, solution, observer);
    }
    write_baked(arguments, outputs, loaded.scene, loaded.mesh, solution, terminal);
    report_leaks(enclosure, factors.matrix, loaded.names(), &loaded.mesh, arguments.rows.max_row_error,
                 terminal);
    return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

void bake_result(const BakeArguments& arguments, const Outputs& outputs, const Terminal& terminal) {
    const std::filesystem::path& path = arguments.scene.path;
    if (extension_of(path) != ".hres") {
        throw InvalidArgument(fmt::format("{}: bake needs a scene ({}) or a stored solution (.hres)",
                                          path.string(), io::scene_extensions()));
    }
    refuse_all_but(arguments.common,
                   std::vector<std::string>{"--output", "--show", "--flat", "--exposure", "--lightmap"},
                   path);
    io::ResultFile result = io::read_hres(path);
    if (!result.solution.temperature.empty()) {
        throw InvalidArgument(
            fmt::format("{}: has heat, which is no light to bake; `hemi render` draws it, and "
                        "`hemi convert` makes a .vtp of it",
                        path.string()));
    }
    const PatchMesh mesh(result.scene, result.subdivision);
    io::complete_solution(result, mesh);
    write_baked(arguments, outputs, result.scene, mesh, result.solution, terminal);
}

} // namespace

ExitStatus run(const BakeArguments& arguments, const Terminal& terminal) {
    Outputs outputs;
    outputs.keep(arguments.scene.path);
    outputs.add("-o", *arguments.picture.output, {".glb", ".ply"}, true);
    if (has_lightmap(arguments) && extension_of(*arguments.picture.output) == ".ply") {
        throw InvalidArgument("--lightmap: a .ply has no texture; -o OUT.glb does");
    }
    outputs.refuse_with_json(arguments.common.json);
    if (io::is_scene_file(arguments.scene.path)) {
        return bake_scene(arguments, outputs, terminal);
    }
    bake_result(arguments, outputs, terminal);
    return ExitStatus::ok;
}

} // namespace hemi::cli
