#include "cli/arguments/scene_arguments.hpp"

#include "cli/arguments/arguments.hpp"
#include "cli/arguments/options.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>

namespace hemi::cli {

void add_scene_options(CLI::App& app, SceneOptions& scene) {
    Options options(app, "Scene");
    auto* size = options.value("--patch-size", "S", "patch edges no longer than S scene units",
                               [&scene](const std::string& text) {
                                   scene.subdivision.patch_size = parse_positive("--patch-size", text);
                               });
    options
        .value("--patches-per-face", "N", "about N patches a face (k x k, smallest k*k >= N)",
               [&scene](const std::string& text) {
                   scene.subdivision.patches_per_face =
                       static_cast<std::uint32_t>(parse_whole("--patches-per-face", text, 1, 100'000'000));
               })
        ->excludes(size);
    options.flag("--strict", scene.reader.strict,
                 "refuse faces without area or out of plane, which are mended otherwise");
    options.value(
        "--planarity", "T",
        "cut faces into triangles whose corners are off their planes by more than T of the longest "
        "edge (1e-5)",
        [&scene](const std::string& text) { scene.reader.planarity = parse_share("--planarity", text); });
    options.flag("--allow-outside", scene.reader.allow_outside,
                 "open files outside the scene's folder that the scene names");
    options.flag("--no-imprint", scene.imprint, "leave faces as they are where others touch or cover them",
                 false);
    options.value("--zone", "NAME",
                  "the zone of an .epJSON file that is the scene; needed where it has several",
                  [&scene](const std::string& text) { scene.reader.zone = text; });
    options.groups("--two-sided", scene.reader.two_sided_groups,
                   "faces of GROUP radiate on both sides (not for .json); * for all; repeatable");
    options.groups("--one-sided-group", scene.reader.one_sided_groups,
                   "only the fronts of GROUP's faces count, whatever the file says; * for all; repeatable");
    options.choice<Orientation>(
        "--orient", "in|out",
        "turn faces: outermost bodies to their inside or outside, what is in them the "
        "other way round",
        scene.reader.orientation);
    options.groups("--flip-group", scene.reader.flipped_groups,
                   "turn the faces of GROUP round; * for all; repeatable");
    app.add_flag_callback(
           "--flip", [&scene] { scene.reader.flipped_groups = {"*"}; }, "turn all faces round")
        ->option_text(" ")
        ->group("Scene")
        ->excludes(app.get_option("--flip-group"));
}

void add_up(CLI::App& app, SceneOptions& scene, const std::string& help) {
    Options(app, "Scene").choice<UpAxis>("--up", "y|z", help, [&scene](UpAxis up) { scene.reader.up = up; });
}

void check_files(const SceneOptions& scene) {
    std::vector<std::filesystem::path> files = scene.also;
    files.insert(files.begin(), scene.path);
    for (const std::filesystem::path& file : files) {
        if (files.size() > 1 && !io::is_scene_file(file)) {
            throw InvalidArgument(
                fmt::format("unexpected argument: {}; of several files all must be meshes ({})",
                            file.string(), io::scene_extensions()));
        }
    }
}

} // namespace hemi::cli
