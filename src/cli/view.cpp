#include "cli/commands.hpp"
#include "cli/outputs.hpp"
#include "cli/picture_output.hpp"
#include "cli/pipeline.hpp"
#include "cli/repair_rows.hpp"
#include "cli/solution.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "viewer/viewer.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <memory>
#include <utility>

namespace hemi::cli {

namespace {

void check_display() {
    const auto is_set = [](const char* variable) {
        const char* value = std::getenv(variable);
        return value != nullptr && *value != '\0';
    };
    if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY")) {
        throw NoDevice("no display to open a window on (DISPLAY is not set); `hemi render` and `hemi solve "
                       "-o` need none");
    }
}

/// All that does not depend on where the solution comes from.
viewer::ViewerInput make_input(const ViewArguments& arguments, const Scene& scene, const PatchMesh& mesh) {
    const PictureOptions& options = arguments.picture;
    viewer::ViewerInput input;
    input.title = scene.name.empty() ? arguments.scene.path.filename().string() : scene.name;
    input.file_stem = arguments.scene.path.stem().string();
    input.scene = &scene;
    input.mesh = &mesh;
    input.reflectance = patch_reflectance(scene, mesh);
    input.channels = static_cast<std::uint32_t>(scene.channels.size());
    input.show = channels_to_show(scene.channels, options.show);
    input.environment = shown_environment(scene, input.show);
    input.camera = choose_camera(scene, mesh, options.camera);
    input.picture.width = options.size[0];
    input.picture.height = options.size[1];
    input.picture.shading = options.flat ? Shading::flat : Shading::gouraud;
    input.picture.tone_mapping = options.tone_mapping;
    input.picture.exposure = options.exposure.value_or(1.0);
    input.automatic_exposure = !options.exposure;
    input.script = arguments.script;
    return input;
}

viewer::Solved solve_for_view(const LoadedScene& loaded, const ViewArguments& arguments,
                              const Terminal& terminal) {
    Rows rows = compute_rows(loaded, reflecting_patches(loaded), arguments.rows, terminal);
    settle_contacts(rows.file);
    (void)repair_rows(rows.file, arguments.rows.repair);
    viewer::Solved solved;
    solved.factors = std::make_shared<const FormFactorMatrix>(std::move(rows.file.factors));
    const FormFactorMatrix& factors = *solved.factors;
    solved.radiosity = solve_scene(loaded, factors, arguments.solver, false, terminal).radiosity;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        solved.row_sum.push_back(row.sum());
        solved.environment_share.push_back(row.environment);
        solved.blocked.push_back(row.blocked);
    }
    return solved;
}

void view_scene(const ViewArguments& arguments, const Terminal& terminal) {
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    viewer::ViewerInput input = make_input(arguments, loaded.scene, loaded.mesh);
    input.exitance = patch_exitance(loaded.scene, loaded.mesh);
    input.radiosity = input.exitance;
    input.hemicube = plan_rows(arguments.rows, loaded.mesh.size()).hemicube;
    input.solver = arguments.solver;
    input.solve = [&](const viewer::SolveProgress& progress) {
        Terminal listening = terminal;
        listening.set_progress_listener(progress);
        return solve_for_view(loaded, arguments, listening);
    };
    viewer::run_viewer(input);
}

void view_result(const ViewArguments& arguments) {
    const std::filesystem::path& path = arguments.scene.path;
    if (extension_of(path) != ".hres") {
        throw InvalidArgument(fmt::format("{}: view shows a scene ({}) or a stored solution (.hres)",
                                          path.string(), io::scene_extensions()));
    }
    refuse_all_but(arguments.common,
                   std::vector<std::string>{"--size", "--show", "--camera", "--flat", "--exposure",
                                            "--tone-mapping", "--script"},
                   path);
    const io::ResultFile result = io::read_hres(path);
    const PatchMesh mesh(result.scene, result.subdivision);
    viewer::ViewerInput input = make_input(arguments, result.scene, mesh);
    input.radiosity = result.radiosity;
    input.exitance = patch_exitance(result.scene, mesh);
    input.row_sum = result.row_sum;
    input.environment_share = result.environment;
    input.blocked = result.blocked;
    if (result.radiosity_error) {
        input.radiosity_error = result.radiosity_error->patches;
    }
    viewer::run_viewer(input);
}

} // namespace

ExitStatus run(const ViewArguments& arguments, const Terminal& terminal) {
    check_display();
    if (io::is_scene_file(arguments.scene.path)) {
        view_scene(arguments, terminal);
    } else {
        view_result(arguments);
    }
    return ExitStatus::ok;
}

} // namespace hemi::cli
