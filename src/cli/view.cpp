#include "cli/coarse_light.hpp"
#include "cli/commands.hpp"
#include "cli/error_report.hpp"
#include "cli/outputs.hpp"
#include "cli/picture_output.hpp"
#include "cli/pipeline.hpp"
#include "cli/repair_rows.hpp"
#include "cli/solution.hpp"
#include "engine/gathering.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "viewer/command_line.hpp"
#include "viewer/viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
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
    static const std::vector<std::string> names{"--size",         "--camera",       "--flat",    "--exposure",
                                                "--tone-mapping", "--orthographic", "--backs",   "--outlines",
                                                "--samples",      "--script",       "--controls"};
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
std::string given_options(const CommonOptions& common) {
    std::string text;
    for (const auto& [name, values] : common.words) {
        if (std::find(window_options().begin(), window_options().end(), name) != window_options().end()) {
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

/// Rows of F with all that belongs to them: once found, they do for every scene of the same geometry.
struct KeptRows {
    std::mutex mutex;
    std::shared_ptr<const Rows> rows;

    std::shared_ptr<const Rows> of(const LoadedScene& loaded) {
        const std::lock_guard lock(mutex);
        const bool same = rows && rows->file.geometry_hash == loaded.mesh.geometry_hash() &&
                          rows->file.enclosure == enclosure_name(loaded.scene.enclosure);
        return same ? rows : nullptr;
    }
    void keep(std::shared_ptr<const Rows> found) {
        const std::lock_guard lock(mutex);
        rows = std::move(found);
    }
};

/// Reads what the window shows, as often as it wants to.
class ViewSource {
public:
    ViewSource(const ViewArguments& arguments, const Terminal& terminal)
        : arguments_(arguments), terminal_(terminal), kept_(std::make_shared<KeptRows>()) {}

    [[nodiscard]] viewer::ViewerInput open(const std::filesystem::path& path) const {
        if (io::is_scene_file(path)) {
            return scene(path);
        }
        if (extension_of(path) == ".hres") {
            return result(path);
        }
        throw InvalidArgument(fmt::format("{}: view shows a scene ({}) or a stored solution (.hres)",
                                          path.string(), io::scene_extensions()));
    }

private:
    /// All that does not depend on where the solution comes from.
    [[nodiscard]] viewer::ViewerInput describe(const std::filesystem::path& path,
                                               std::shared_ptr<const Scene> scene,
                                               std::shared_ptr<const PatchMesh> mesh) const {
        const PictureOptions& options = arguments_.picture;
        viewer::ViewerInput input;
        input.file = path;
        input.title = scene->name.empty() ? path.filename().string() : scene->name;
        input.reflectance = patch_reflectance(*scene, *mesh);
        input.exitance = patch_exitance(*scene, *mesh);
        input.channels = static_cast<std::uint32_t>(scene->channels.size());
        input.show = channels_to_show(scene->channels, options.show);
        input.environment = shown_environment(*scene, input.show);
        input.camera = choose_camera(*scene, *mesh, options);
        input.picture = picture_settings(options);
        input.automatic_exposure = !options.exposure;
        input.scene = std::move(scene);
        input.mesh = std::move(mesh);
        return input;
    }

    [[nodiscard]] viewer::ViewerInput scene(const std::filesystem::path& path) const {
        SceneOptions options = arguments_.scene;
        options.path = path;
        const auto loaded = std::make_shared<const LoadedScene>(load_scene(options, terminal_));
        viewer::ViewerInput input = describe(path, std::shared_ptr<const Scene>(loaded, &loaded->scene),
                                             std::shared_ptr<const PatchMesh>(loaded, &loaded->mesh));
        input.command = "hemi solve " + viewer::quoted(path.string()) + given_options(arguments_.common);
        input.radiosity = input.exitance;
        input.hemicube = plan_rows(arguments_.rows, loaded->mesh.size()).hemicube;
        input.solver = arguments_.solver;
        input.find_rows = [this, loaded](const viewer::RowListener& listener) {
            return find_rows(*loaded, listener);
        };
        input.save_result = [this, loaded, options](const std::filesystem::path& file,
                                                    const viewer::SolvedLight& light) {
            save(*loaded, options, file, light);
        };
        return input;
    }

    [[nodiscard]] viewer::ViewerInput result(const std::filesystem::path& path) const {
        io::ResultFile result = io::read_hres(path);
        const auto scene = std::make_shared<const Scene>(std::move(result.scene));
        viewer::ViewerInput input =
            describe(path, scene, std::make_shared<const PatchMesh>(*scene, result.subdivision));
        input.command = "hemi render " + viewer::quoted(path.string());
        if (!arguments_.picture.show.empty()) {
            input.command += fmt::format(" --show {}", fmt::join(arguments_.picture.show, ","));
        }
        input.radiosity = std::move(result.radiosity);
        input.rows.row_sum = std::move(result.row_sum);
        input.rows.environment_share = std::move(result.environment);
        input.rows.blocked = std::move(result.blocked);
        if (result.radiosity_error) {
            input.radiosity_error = std::move(result.radiosity_error->patches);
        }
        return input;
    }

    /// Of all patches, so that every one can be picked, and may begin to reflect.
    [[nodiscard]] viewer::FoundRows find_rows(const LoadedScene& loaded,
                                              const viewer::RowListener& listener) const {
        std::shared_ptr<const Rows> rows = kept_->of(loaded);
        if (!rows) {
            Terminal listening = terminal_;
            listening.set_progress_listener(
                [&listener](std::string_view, std::string_view, std::size_t done, std::size_t total) {
                    return listener.progress("coarse preview", "", done, total);
                });
            const auto light = coarse_light(loaded, arguments_.rows, arguments_.solver, listening);
            if (light) {
                listener.preview(*light);
            }
            listening.set_progress_listener(listener.progress);
            auto found =
                std::make_shared<Rows>(compute_rows(loaded, all_patches(loaded.mesh.size()), arguments_.rows,
                                                    listening, nullptr, gatherer(loaded, light, listener)));
            if (!listener.progress("estimate of errors", "", 0, 1)) {
                throw Cancelled();
            }
            add_reference(*found, loaded, arguments_.rows, listening);
            settle_contacts(found->file);
            (void)repair_rows(found->file, arguments_.rows.repair);
            estimate_rows(found->file);
            kept_->keep(found);
            rows = std::move(found);
        }
        const io::FactorFile& file = rows->file;
        viewer::FoundRows found;
        found.factors = std::shared_ptr<const FormFactorMatrix>(rows, &file.factors);
        if (file.reference.entries() > 0) {
            found.reference = std::shared_ptr<const FormFactorMatrix>(rows, &file.reference);
        }
        for (std::uint32_t i = 0; i < file.factors.size(); ++i) {
            const RowView row = file.factors.row(i);
            found.row_sum.push_back(row.sum());
            found.environment_share.push_back(row.environment);
            found.blocked.push_back(row.blocked);
        }
        return found;
    }

    /// Tells the listener what every patch has of the light that is shown while rows come in: that of
    /// `preview`, or of the lamps.
    [[nodiscard]] static RowWatcher gatherer(const LoadedScene& loaded,
                                             const std::optional<std::vector<double>>& preview,
                                             const viewer::RowListener& listener) {
        struct State {
            std::vector<double> exitance, reflectance, shown, light;
            std::optional<Gathering> gathering; ///< made with the first row
        };
        const auto state = std::make_shared<State>();
        state->exitance = patch_exitance(loaded.scene, loaded.mesh);
        state->reflectance = patch_reflectance(loaded.scene, loaded.mesh);
        state->shown = preview.value_or(state->exitance);
        state->light.resize(loaded.scene.channels.size());
        return [state, &loaded, &listener](std::uint32_t patch, const auto& any_row) {
            const std::size_t channels = state->light.size();
            if (!state->gathering) {
                state->gathering.emplace(loaded.mesh, static_cast<std::uint32_t>(channels),
                                         std::move(state->shown), loaded.scene.environment);
            }
            const double blocked = std::visit(
                [&](const auto& row) {
                    state->gathering->gather(patch, row, state->light);
                    return row.blocked;
                },
                any_row);
            for (std::size_t c = 0; c < channels; ++c) {
                const std::size_t at = patch * channels + c;
                state->light[c] = state->exitance[at] + state->reflectance[at] * state->light[c];
            }
            listener.gathered(patch, state->light, blocked);
        };
    }

    void save(const LoadedScene& loaded, const SceneOptions& options, const std::filesystem::path& path,
              const viewer::SolvedLight& light) const {
        const std::shared_ptr<const Rows> rows = kept_->of(loaded);
        LoadedScene changed = loaded;
        changed.scene.materials = light.materials;
        Solution solution;
        solution.channels = static_cast<std::uint32_t>(loaded.scene.channels.size());
        solution.exitance = patch_exitance(changed.scene, changed.mesh);
        solution.radiosity = light.radiosity;
        const std::vector<double> reflectance = patch_reflectance(changed.scene, changed.mesh);
        solution.irradiance = irradiance({&rows->file.factors, solution.channels, reflectance,
                                          solution.exitance, changed.scene.environment, changed.mesh.areas()},
                                         light.radiosity);
        solution.solver = light.solver;
        solution.sweeps = light.sweeps;
        solution.residual = light.residual;
        solution.error = light.error;
        io::write_hres(path, make_result(changed, options, *rows, solution));
    }

    const ViewArguments& arguments_;
    const Terminal& terminal_;
    std::shared_ptr<KeptRows> kept_;
};

} // namespace

ExitStatus run(const ViewArguments& arguments, const Terminal& terminal) {
    check_display();
    const std::filesystem::path& path = arguments.scene.path;
    if (extension_of(path) == ".hres") {
        std::vector<std::string> allowed = window_options();
        allowed.emplace_back("--show");
        refuse_all_but(arguments.common, allowed, path);
    }
    const ViewSource source(arguments, terminal);
    viewer::ViewerSettings settings;
    settings.controls = arguments.controls;
    settings.script = arguments.script;
    settings.open = [&source](const std::filesystem::path& file) { return source.open(file); };
    viewer::run_viewer(source.open(path), settings);
    return ExitStatus::ok;
}

} // namespace hemi::cli
