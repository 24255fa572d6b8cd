#include "cli/commands.hpp"
#include "cli/outputs.hpp"
#include "cli/picture_output.hpp"
#include "cli/pipeline.hpp"
#include "cli/repair_rows.hpp"
#include "cli/report.hpp"
#include "cli/solution.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/baked_mesh_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>

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

void write_baked(const BakeArguments& arguments, const PictureSubject& subject, const Terminal& terminal) {
    const auto channels = static_cast<std::uint32_t>(subject.scene.channels.size());
    const PictureMesh mesh =
        make_picture_mesh(subject.mesh, channels, subject.radiosity, subject.blocked,
                          channels_to_show(subject.scene.channels, arguments.picture.show));
    const double exposure =
        arguments.picture.exposure
            ? *arguments.picture.exposure
            : automatic_exposure(subject.mesh, mesh, subject.blocked, subject.exitance, channels);
    const std::filesystem::path& path = *arguments.picture.output;
    const std::vector<float> corners = arguments.picture.flat ? flat_corners(mesh.patches) : mesh.corners;
    (extension_of(path) == ".ply" ? io::write_baked_ply : io::write_baked_glb)(path, subject.mesh, corners,
                                                                               exposure);
    if (arguments.common.json) {
        print_json({{"schema", "hemi/bake/1"},
                    {"output", path.string()},
                    {"patches", subject.mesh.size()},
                    {"exposure", exposure}});
    } else if (!terminal.quiet()) {
        const std::string text = summary_line(
            "baked", fmt::format("{} ({}, exposure {}{})",
                                 is_standard_output(path) ? "standard output" : path.string(),
                                 plural(subject.mesh.size(), "patch", "patches"), number_text(exposure),
                                 arguments.picture.exposure ? "" : ", automatic"));
        if (is_standard_output(path)) {
            std::fputs(text.c_str(), stderr);
        } else {
            print(text);
        }
    }
}

ExitStatus bake_scene(const BakeArguments& arguments, const Terminal& terminal) {
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    (void)channels_to_show(loaded.scene.channels, arguments.picture.show);
    Rows rows = compute_rows(loaded, reflecting_patches(loaded), arguments.rows, terminal);
    settle_contacts(rows.file);
    const EnclosureFinding enclosure =
        find_leaks(rows.file.factors, enclosure_name(loaded.scene.enclosure), arguments.rows.max_row_error);
    (void)repair_rows(rows.file, arguments.rows.repair);
    report_covered(row_sums(rows.file.factors), terminal);
    const Solution solution = solve_scene(loaded, rows.file.factors, arguments.solver, false, terminal);
    write_baked(arguments,
                {loaded.scene, loaded.mesh, solution.radiosity, solution.exitance, solution.blocked},
                terminal);
    report_leaks(enclosure, rows.file.factors, loaded.names(), &loaded.mesh, arguments.rows.max_row_error,
                 terminal);
    return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

void bake_result(const BakeArguments& arguments, const Terminal& terminal) {
    const std::filesystem::path& path = arguments.scene.path;
    if (extension_of(path) != ".hres") {
        throw InvalidArgument(fmt::format("{}: bake needs a scene ({}) or a stored solution (.hres)",
                                          path.string(), io::scene_extensions()));
    }
    refuse_all_but(arguments.common, std::vector<std::string>{"--output", "--show", "--flat", "--exposure"},
                   path);
    const io::ResultFile result = io::read_hres(path);
    const PatchMesh mesh(result.scene, result.subdivision);
    write_baked(arguments,
                {result.scene, mesh, result.radiosity, patch_exitance(result.scene, mesh), result.blocked},
                terminal);
}

} // namespace

ExitStatus run(const BakeArguments& arguments, const Terminal& terminal) {
    Outputs outputs;
    outputs.keep(arguments.scene.path);
    outputs.add("-o", *arguments.picture.output, {".glb", ".ply"}, true);
    if (outputs.uses_standard_output() && arguments.common.json) {
        throw InvalidArgument("--json and an output to - cannot both go to standard output");
    }
    if (io::is_scene_file(arguments.scene.path)) {
        return bake_scene(arguments, terminal);
    }
    bake_result(arguments, terminal);
    return ExitStatus::ok;
}

} // namespace hemi::cli
