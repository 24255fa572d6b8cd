#include "cli/arguments/scene_arguments.hpp"

#include "cli/arguments/arguments.hpp"
#include "cli/arguments/options.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/length_unit.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::cli {

namespace {

Vec3 parse_vector(std::string_view option, const std::string& text) {
    const std::vector<std::string> parts = parse_list(text);
    if (parts.size() != 3) {
        throw InvalidArgument(fmt::format("{} {}; must be three numbers DX,DY,DZ", option, text));
    }
    Vec3 vector(0.0);
    for (int k = 0; k < 3; ++k) {
        vector[k] = parse_number(option, parts[static_cast<std::size_t>(k)]);
    }
    return vector;
}

RotationAxis parse_rotation(std::string_view option, const std::string& text) {
    const std::vector<std::string> parts = parse_list(text);
    const std::optional<int> axis = parts.size() == 2 ? axis_from_text(parts[0]) : std::nullopt;
    if (!axis) {
        throw InvalidArgument(fmt::format("{} {}; must be an axis and a number, as z,6", option, text));
    }
    return {*axis, parse_index(option, parts[1], 2, 360)};
}

/// What the scene repeats itself by.
void add_symmetry(CLI::App& app, io::SymmetryOptions& symmetry) {
    Options options(app, "Scene");
    const auto each = [&app](const std::string& name, const std::string& form, const std::string& help,
                             const std::function<void(const std::string&)>& read) {
        app.add_option_function<std::vector<std::string>>(
               name,
               [read](const std::vector<std::string>& texts) {
                   for (const std::string& text : texts) {
                       read(text);
                   }
               },
               help)
            ->allow_extra_args(false)
            ->option_text(form)
            ->group("Scene");
    };
    each("--mirror", "AXIS=VALUE",
         "the scene is one side of what there is, mirrored in the plane, as x=0; repeatable for up to three",
         [&symmetry](const std::string& text) {
             const std::optional<MirrorPlane> plane = plane_from_text(text);
             if (!plane) {
                 throw InvalidArgument(
                     fmt::format("--mirror {}; must be a plane across an axis, as x=0", text));
             }
             symmetry.mirrors.push_back(*plane);
         });
    options.value(
        "--rotate", "AXIS,N", "the scene is one Nth of what there is, turned about an axis, as z,6",
        [&symmetry](const std::string& text) { symmetry.rotation = parse_rotation("--rotate", text); });
    each("--periodic", "DX,DY,DZ",
         "the scene repeats by a translation and its opposite; repeatable for up to three",
         [&symmetry](const std::string& text) {
             symmetry.periods.push_back(parse_vector("--periodic", text));
         });
    options.value("--images", "N", fmt::format("images each way along a translation ({})", usual_images),
                  [&symmetry](const std::string& text) {
                      symmetry.images = parse_index("--images", text, 1, most_images);
                  });
}

} // namespace

void add_scene_options(CLI::App& app, SceneOptions& scene) {
    add_symmetry(app, scene.reader.symmetry);
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

void add_unit(CLI::App& app, SceneOptions& scene) {
    Options(app, "Scene")
        .choice<LengthUnit>("--unit", "UNIT", "unit of the scene's lengths: m, cm, mm, in or ft",
                            [&scene](LengthUnit unit) { scene.reader.unit = metres(unit); });
}

void check_files(const SceneOptions& scene, bool two_results) {
    std::vector<std::filesystem::path> files = scene.also;
    files.insert(files.begin(), scene.path);
    if (two_results && files.size() == 2 && files[0].extension() == ".hres" &&
        files[1].extension() == ".hres") {
        return;
    }
    for (const std::filesystem::path& file : files) {
        if (files.size() > 1 && !io::is_scene_file(file)) {
            throw InvalidArgument(
                fmt::format("unexpected argument: {}; of several files all must be meshes ({})",
                            file.string(), io::scene_extensions()));
        }
    }
}

} // namespace hemi::cli
