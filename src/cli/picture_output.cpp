#include "cli/picture_output.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/display/picture.hpp"
#include "hemi/pipeline/picture.hpp"
#include "hemi/pipeline/quantities.hpp"
#include "hemi/scene/image_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::cli {

namespace {

/// A word of `--show` that means nothing.
[[noreturn]] void refuse_shown(const std::string& word, const std::vector<std::string>& channels,
                               bool quantities) {
    if (!quantities) {
        throw InvalidArgument(fmt::format("--show: there is no channel '{}' among {}{}", word,
                                          fmt::join(channels, ", "), did_you_mean(word, channels)));
    }
    const std::vector<std::string> of_quantities = words<Quantity>();
    std::vector<std::string> known = channels;
    known.insert(known.end(), of_quantities.begin(), of_quantities.end());
    throw InvalidArgument(fmt::format("--show {}: is neither a channel ({}) nor a quantity ({}){}", word,
                                      fmt::join(channels, ", "), fmt::join(of_quantities, ", "),
                                      did_you_mean(word, known)));
}

} // namespace

void add_picture_output(Outputs& outputs, const PictureOptions& options, bool heat) {
    if (!options.quantity &&
        (!options.of_quantities.empty() || options.logarithmic || options.iso_lines || !options.legend)) {
        throw InvalidArgument(
            fmt::format("{} needs --show with a quantity, such as irradiance{}",
                        !options.of_quantities.empty() ? options.of_quantities[0]
                        : options.logarithmic          ? "--log"
                        : options.iso_lines            ? "--iso-lines"
                                                       : "--no-legend",
                        options.show.size() == 1 ? did_you_mean(options.show[0], words<Quantity>()) : ""));
    }
    if (options.quantity && (options.exposure || options.tone_mapping_given)) {
        throw InvalidArgument("--exposure and --tone-mapping do not apply to quantities; --range does");
    }
    if (options.celsius && options.quantity != Quantity::temperature) {
        throw InvalidArgument("--celsius needs --show temperature");
    }
    if (!heat && options.quantity && is_of_heat(*options.quantity)) {
        throw InvalidArgument(fmt::format("--show {}: `hemi heat SCENE -o FILE.png --show {}` finds it",
                                          to_word(*options.quantity), to_word(*options.quantity)));
    }
    if (options.quantity && options.output && extension_of(*options.output) == ".hdr") {
        throw InvalidArgument("a quantity is drawn as .png: .hdr holds light");
    }
    if (options.output) {
        outputs.add("-o", *options.output, {".png", ".hdr"}, true);
        if (extension_of(*options.output) == ".hdr" &&
            (options.exposure || options.tone_mapping_given || options.background)) {
            throw InvalidArgument("--exposure, --tone-mapping and --background do not apply to .hdr, which "
                                  "holds the radiosity as it is");
        }
    }
}

std::array<std::uint32_t, 3> channels_to_show(const std::vector<std::string>& channels,
                                              const std::vector<std::string>& show, bool quantities) {
    if (show.empty()) {
        if (channels.size() == 1) {
            return {0, 0, 0};
        }
        if (channels.size() == 3) {
            return {0, 1, 2};
        }
        throw InvalidArgument(fmt::format("a picture of {} channels needs --show, with one or three of: {}",
                                          channels.size(), fmt::join(channels, ", ")));
    }
    if (show.size() != 1 && show.size() != 3) {
        throw InvalidArgument(fmt::format("--show {}: must name one channel or three", fmt::join(show, ",")));
    }
    std::array<std::uint32_t, 3> indices{};
    for (std::size_t k = 0; k < 3; ++k) {
        const std::string& name = show[show.size() == 1 ? 0 : k];
        const auto found = std::find(channels.begin(), channels.end(), name);
        if (found == channels.end()) {
            refuse_shown(name, channels, quantities && show.size() == 1);
        }
        indices[k] = static_cast<std::uint32_t>(found - channels.begin());
    }
    return indices;
}

Camera choose_camera(const Scene& scene, const PatchMesh& mesh, const PictureOptions& options) {
    const std::optional<CameraOption>& option = options.camera;
    const bool of_sky = scene.sun || scene.sky; // which it says something of, too
    if (option && option->up && options.up && !of_sky) {
        throw InvalidArgument("--up: --camera names an up direction, too; leave one out");
    }
    const UpAxis up = options.up.value_or(scene.up);
    const Bounds bounds = ImageMesh(mesh).mesh().bounds();
    Camera camera = scene.camera ? *scene.camera
                    : option     ? default_camera(bounds, up)
                                 : interior_camera(mesh, up).value_or(default_camera(bounds, up));
    camera.orthographic = options.orthographic || (camera.orthographic && !option);
    if (option) {
        camera.eye = option->eye;
        camera.target = option->target;
        camera.up = option->up.value_or(camera.up);
        camera.fov = option->fov.value_or(camera.fov);
    }
    if (options.up && !(option && option->up)) {
        camera.up = upwards(up);
    }
    const Vec3 view = camera.target - camera.eye;
    const double sine = glm::length(glm::cross(view, camera.up));
    if ((option || options.up) && !(sine > 1e-9 * glm::length(view) * glm::length(camera.up))) {
        throw InvalidArgument(option ? "--camera: looks along its up direction; name another, as in "
                                       "EYE:TARGET:0,1,0"
                                     : "--up: the scene's camera looks that way; name the other axis");
    }
    return camera;
}

PictureCut picture_cut(const PictureOptions& options, std::span<const std::string> groups) {
    PictureCut cut;
    cut.clip = options.clip;
    const auto set = [&cut, groups](const std::string& name, const char* option, Visibility visibility) {
        const std::uint32_t group = group_by_name(groups, name, option);
        cut.groups.resize(groups.size(), Visibility::shown);
        if (cut.groups[group] != Visibility::shown && cut.groups[group] != visibility) {
            throw InvalidArgument(fmt::format("--hide and --outlines-of both name {}; leave one out", name));
        }
        cut.groups[group] = visibility;
    };
    for (const std::string& name : options.hidden_groups) {
        set(name, "--hide", Visibility::hidden);
    }
    for (const std::string& name : options.outlined_groups) {
        set(name, "--outlines-of", Visibility::outlines);
    }
    return cut;
}

PictureSettings picture_settings(const PictureOptions& options) {
    PictureSettings settings;
    settings.width = options.size[0];
    settings.height = options.size[1];
    settings.samples = options.samples;
    settings.shading = options.flat ? Shading::flat : Shading::gouraud;
    settings.tone_mapping = options.tone_mapping;
    settings.outlines = options.outlines;
    settings.backs = options.backs;
    settings.background = options.background;
    settings.exposure = options.exposure.value_or(settings.exposure);
    return settings;
}

Report write_false_colours(const Scene& scene, const PatchMesh& mesh, FalseColours shown,
                           const PictureOptions& options, const std::string& device, std::string_view word,
                           const Dots* dots) {
    if (options.celsius) {
        show_in_celsius(shown);
    }
    const bool centred = shown.range && (*shown.range)[0] == -(*shown.range)[1];
    shown.range = options.range                                                              ? options.range
                  : options.logarithmic || (options.map == ColourMap::cool_warm && !centred) ? std::nullopt
                                                                                             : shown.range;
    shown.map = options.map;
    shown.logarithmic = options.logarithmic;
    shown.legend = options.legend;
    shown.bands = options.bands;
    shown.iso_lines = options.iso_lines;
    PictureSettings settings = picture_settings(options);
    settings.cut = picture_cut(options, mesh.groups());
    const Picture picture = draw_false_colours(mesh, shown, choose_camera(scene, mesh, options), settings,
                                               device == "cpu" ? "auto" : device, dots);
    hemi::write_picture(*options.output, picture);
    const std::string path = options.output->string();
    Report report;
    report.add("picture",
               fmt::format("{} ({} x {}, {})", is_standard_output(*options.output) ? "standard output" : path,
                           picture.width, picture.height, word),
               {{"picture", path},
                {"width", picture.width},
                {"height", picture.height},
                {"exposure", nullptr},
                {"quantity", word}});
    return report;
}

Report write_picture(const Scene& scene, const PatchMesh& mesh, const Solution& solution,
                     const PictureOptions& options, const std::string& device, const Dots* dots) {
    if (options.quantity) {
        Report report = write_false_colours(
            scene, mesh, patch_quantity(*options.quantity, scene, mesh, solution, options.channel), options,
            device, to_word(*options.quantity), dots);
        if (*options.quantity == Quantity::radiosity && is_uniform(solution) &&
            !is_dark(solution.radiosity, scene.environment)) {
            report.add("light", light_note(scene, solution));
        }
        return report;
    }
    DrawSettings settings;
    settings.picture = picture_settings(options);
    settings.picture.cut = picture_cut(options, mesh.groups());
    settings.automatic_exposure = !options.exposure;
    settings.camera = choose_camera(scene, mesh, options);
    settings.show = channels_to_show(scene.channels, options.show);
    settings.device = device;
    settings.dots = dots;
    const DrawnPicture drawn = draw_solution(scene, mesh, solution, settings);
    hemi::write_picture(*options.output, drawn.picture);
    const std::string path = options.output->string();
    Report report;
    report.add("picture",
               fmt::format("{} ({} x {}, exposure {}{})",
                           is_standard_output(*options.output) ? "standard output" : path,
                           drawn.picture.width, drawn.picture.height, number_text(drawn.exposure),
                           options.exposure ? "" : ", automatic"),
               {{"picture", path},
                {"width", drawn.picture.width},
                {"height", drawn.picture.height},
                {"exposure", drawn.exposure},
                {"quantity", nullptr}});
    if (const std::string note = light_note(scene, solution); !note.empty() && extension_of(path) != ".hdr") {
        report.add("light", note);
    }
    return report;
}

} // namespace hemi::cli
