#include "cli/cluster_settings.hpp"
#include "cli/commands.hpp"
#include "cli/factor_source.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/output_paths.hpp"
#include "cli/picture_output.hpp"
#include "cli/point_source.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "viewer/command_line.hpp"
#include "viewer/viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace hemi::cli {

namespace {

/// Options that say how to begin: a command line that draws what the window shows has its own.
const std::vector<std::string>& window_options() {
    static const std::vector<std::string> names{"--size",         "--camera",       "--flat",   "--exposure",
                                                "--tone-mapping", "--orthographic", "--backs",  "--outlines",
                                                "--samples",      "--background",   "--script", "--controls",
                                                "--up",           "--show",         "--points", "--column",
                                                "--hide",         "--outlines-of",  "--clip"};
    return names;
}

/// Options that say how patches are cut: rows that are stored have that.
const std::vector<std::string>& of_refinement() {
    static const std::vector<std::string> names{"--error-target", "--error-target-of", "--refine",
                                                "--budget"};
    return names;
}

/// Options that `hemi heat` does not have.
std::vector<std::string> of_light_alone() {
    std::vector<std::string> names = of_refinement();
    names.insert(names.end(), {"--solver", "--tolerance", "--gather", "--environment"});
    return names;
}

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

/// The options that were given, as words of a command line; without those of the window.
/// @param also  more that are left out
std::string given_options(const CommonOptions& common, const std::vector<std::string>& also = {}) {
    std::string text;
    for (const auto& [name, values] : common.words) {
        if (name == "--factors" || // which a dropped file replaces
            std::find(window_options().begin(), window_options().end(), name) != window_options().end() ||
            std::find(also.begin(), also.end(), name) != also.end()) {
            continue;
        }
        text += ' ';
        text += name;
        for (const std::string& value : values) {
            text += ' ';
            text += viewer::quoted(value);
        }
    }
    return text;
}

/// `--up`, where a sun or a sky goes by it.
std::string upwards_option(const SceneOptions& options, const Scene& scene) {
    return options.reader.up && (scene.sun || scene.sky)
               ? fmt::format(" --up {}", to_word(*options.reader.up))
               : "";
}

/// Reads what the window shows, as often as it wants to.
class ViewSource {
public:
    ViewSource(const ViewArguments& arguments, const Terminal& terminal)
        : arguments_(arguments), terminal_(terminal) {}

    [[nodiscard]] viewer::ViewerInput open(const viewer::FilesToOpen& files) const {
        viewer::ViewerInput input = open(files.file, files.factors);
        if (!files.compared.empty()) {
            input.compared = compared(files.compared, *input.mesh);
        }
        return input;
    }

private:
    /// @param factors  stored rows of the scene; empty: none
    [[nodiscard]] viewer::ViewerInput open(const std::filesystem::path& path,
                                           const std::filesystem::path& factors) const {
        if (!factors.empty() && !io::is_scene_file(path)) {
            throw InvalidArgument(
                fmt::format("{}: rows are of a scene, and {} is none", factors.string(), path.string()));
        }
        if (io::is_scene_file(path)) {
            return scene(path, factors);
        }
        if (extension_of(path) == ".hres") {
            return result(path);
        }
        throw InvalidArgument(fmt::format("{}: view shows a scene ({}) or a stored solution (.hres)",
                                          path.string(), io::scene_extensions()));
    }

    /// @param mesh  that is shown
    [[nodiscard]] static std::shared_ptr<const viewer::Compared> compared(const std::filesystem::path& path,
                                                                          const PatchMesh& mesh) {
        io::ResultFile result = io::read_hres(path);
        auto other = std::make_shared<const PatchMesh>(result.scene, result.subdivision);
        io::complete_solution(result, *other);
        PatchPairs pairs = pair_patches(mesh, *other);
        return std::make_shared<const viewer::Compared>(
            viewer::Compared{path, std::make_shared<const Scene>(std::move(result.scene)), std::move(other),
                             std::move(result.solution), std::move(pairs)});
    }

    /// All that does not depend on where the solution comes from.
    [[nodiscard]] viewer::ViewerInput describe(const std::filesystem::path& path,
                                               std::shared_ptr<const Scene> scene,
                                               std::shared_ptr<const PatchMesh> mesh,
                                               Solution solution) const {
        const PictureOptions& options = arguments_.picture;
        viewer::ViewerInput input;
        input.file = path;
        input.show = channels_to_show(scene->channels, options.show, false);
        if (!options.show.empty()) {
            input.show_option = " --show " + viewer::quoted(fmt::format("{}", fmt::join(options.show, ",")));
        }
        input.camera = choose_camera(*scene, *mesh, options);
        input.picture = picture_settings(options);
        input.automatic_exposure = !options.exposure;
        input.max_row_error = arguments_.rows.max_row_error;
        input.solution = std::move(solution);
        if (input.solution.exitance.empty()) {
            input.solution.exitance = patch_values(*mesh, scene->materials, &Material::exitance);
        }
        input.scene = std::move(scene);
        input.mesh = std::move(mesh);
        if (arguments_.dots.points) {
            auto points = std::make_shared<const PointTable>(
                read_point_table(*arguments_.dots.points, arguments_.dots.column));
            input.dots_column = dots_column(arguments_.dots, *points);
            input.points = std::move(points);
            input.points_file = *arguments_.dots.points;
        }
        return input;
    }

    [[nodiscard]] viewer::ViewerInput scene(const std::filesystem::path& path,
                                            const std::filesystem::path& factors) const {
        SceneOptions options = arguments_.scene;
        if (path != options.path) { // opened in the window
            options.path = path;
            options.also.clear();
        }
        auto loaded = std::make_shared<LoadedScene>(load_scene(options, terminal_));
        std::function<void(viewer::ViewerInput&, PatchMesh)> adopt;
        if (!factors.empty()) {
            adopt_mesh_of_rows(*loaded, options, factors);
        } else if (arguments_.refinement.asked(arguments_.rows)) {
            const CoarseMesh begin = coarse_begin(*loaded, options);
            adopt = [whole = *loaded, begin](viewer::ViewerInput& input, PatchMesh mesh) {
                const auto finer = std::make_shared<LoadedScene>(whole);
                finer->adopt(std::move(mesh), begin, false);
                adopt_scene(input, finer);
            };
            loaded->adopt(begin.mesh, begin, false);
        }
        Solution lamps;
        lamps.channels = static_cast<std::uint32_t>(loaded->scene.channels.size());
        viewer::ViewerInput input =
            describe(path, std::shared_ptr<const Scene>(loaded, &loaded->scene),
                     std::shared_ptr<const PatchMesh>(loaded, &loaded->mesh), std::move(lamps));
        adopt_scene(input, loaded);
        input.adopt = std::move(adopt);
        input.solution.radiosity = input.solution.exitance;
        input.command = "hemi solve " + viewer::quoted(path.string());
        for (const std::filesystem::path& more : options.also) {
            input.command += " " + viewer::quoted(more.string());
        }
        input.command +=
            given_options(arguments_.common, factors.empty() ? std::vector<std::string>() : of_refinement());
        input.command += upwards_option(options, loaded->scene);
        input.factor_settings = arguments_.rows.factors;
        input.solver = arguments_.solver;
        input.gather = arguments_.gather;
        if (!factors.empty()) {
            input.factor_file = factors;
            input.command += " --factors " + viewer::quoted(factors.string());
            input.factors = std::make_shared<const FormFactors>(stored_factors(factors, *loaded));
            input.factor_settings->preset =
                input.factors->provenance.preset.value_or(input.factor_settings->preset);
            input.factor_settings->method = input.factors->provenance.method;
        }
        if (input.adopt) {
            input.refinement = arguments_.refinement.goal(arguments_.rows, arguments_.gather);
        }
        input.observer = std::make_shared<TerminalObserver>(terminal_);
        if (loaded->thermal && input.adopt) {
            terminal_.warn(
                "no temperatures in the window while it cuts patches; store the rows by `hemi solve "
                "--factors FILE.hff` with the same options, and give the window that file");
        } else if (loaded->thermal) {
            add_heat(options, input);
        }
        return input;
    }

    /// Prepared, of all patches.
    [[nodiscard]] FormFactors stored_factors(const std::filesystem::path& path,
                                             const LoadedScene& loaded) const {
        FormFactors factors = read_rows(path, loaded, arguments_.rows.factors, arguments_.common);
        if (!factors.matrix.all_known()) {
            throw InputError(
                fmt::format("{}: rows are missing; the window needs those of all patches", path.string()));
        }
        prepare_form_factors(factors, arguments_.rows.factors.repair);
        return factors;
    }

    /// Scene, mesh and what results hold of them.
    static void adopt_scene(viewer::ViewerInput& input, const std::shared_ptr<const LoadedScene>& loaded) {
        input.scene = std::shared_ptr<const Scene>(loaded, &loaded->scene);
        input.mesh = std::shared_ptr<const PatchMesh>(loaded, &loaded->mesh);
        io::ResultFile stored = loaded->result({});
        input.subdivision = loaded->subdivision;
        input.surfaces_as_read = std::move(stored.surfaces_as_read);
        input.parts = std::move(stored.parts);
    }

    /// What the scene says of heat; where that cannot be solved for, the window shows light alone.
    void add_heat(SceneOptions options, viewer::ViewerInput& input) const {
        options.reader.adiabatic = true;
        options.environment.clear();                               // which is of light
        LoadedScene thermal = load_scene(options, Terminal(true)); // which has told what there is to tell
        if (!input.factor_file.empty()) {
            adopt_mesh_of_rows(thermal, options, input.factor_file);
        }
        try {
            input.heat = std::make_shared<const HeatProblem>(
                heat_problem(thermal.scene, thermal.mesh, *input.observer));
        } catch (const InputError& error) {
            terminal_.warn(fmt::format("no temperatures in the window: {}", error.what()));
        }
        input.heat_command = "hemi heat " + viewer::quoted(options.path.string());
        for (const std::filesystem::path& more : options.also) {
            input.heat_command += " " + viewer::quoted(more.string());
        }
        input.heat_command += given_options(arguments_.common, of_light_alone());
        input.heat_command += upwards_option(options, thermal.scene);
        if (!input.factor_file.empty()) {
            input.heat_command += " --factors " + viewer::quoted(input.factor_file.string());
        }
    }

    [[nodiscard]] viewer::ViewerInput result(const std::filesystem::path& path) const {
        io::ResultFile result = io::read_hres(path);
        const auto scene = std::make_shared<const Scene>(std::move(result.scene));
        viewer::ViewerInput input =
            describe(path, scene, std::make_shared<const PatchMesh>(*scene, result.subdivision),
                     std::move(result.solution));
        input.command = input.heat_command = "hemi render " + viewer::quoted(path.string());
        return input;
    }

    const ViewArguments& arguments_;
    const Terminal& terminal_;
};

/// What of `view` keeps rows from being those of clusters.
std::optional<ClusterObstacle> cluster_obstacle(const ViewArguments& arguments) {
    if (arguments.refinement.asked(arguments.rows)) {
        return {{"--error-target and --refine", "which need the pairs of patches"}};
    }
    return obstacle_of_solver(arguments.solver);
}

} // namespace

ExitStatus run(const ViewArguments& given, const Terminal& terminal) {
    ViewArguments arguments = given;
    settle_clusters(arguments.common, arguments.rows, cluster_obstacle(arguments));
    check_budget(arguments.refinement, arguments.rows);
    if (arguments.rows.error_target && arguments.rows.error_of == ErrorOf::factors) {
        throw InvalidArgument(
            "--error-target-of factors: the window cuts patches until an error of vertices, "
            "field or groups is met; `hemi solve` chooses settings for form factors");
    }
    check_display();
    const std::filesystem::path& path = arguments.scene.path;
    if (extension_of(path) == ".hres") {
        refuse_all_but(arguments.common, window_options(), path);
    }
    const ViewSource source(arguments, terminal);
    viewer::ViewerSettings settings;
    settings.controls = arguments.controls;
    settings.script = arguments.script;
    settings.open = [&source](const viewer::FilesToOpen& files) { return source.open(files); };
    const bool compares = extension_of(path) == ".hres" && !arguments.scene.also.empty();
    viewer::ViewerInput input =
        source.open({path, arguments.factors.value_or(std::filesystem::path()),
                     compares ? arguments.scene.also.front() : std::filesystem::path()});
    input.picture.cut = picture_cut(arguments.picture, input.mesh->groups()); // of the first scene alone
    viewer::run_viewer(std::move(input), settings);
    return ExitStatus::ok;
}

} // namespace hemi::cli
