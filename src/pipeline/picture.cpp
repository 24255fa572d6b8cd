#include "hemi/pipeline/picture.hpp"

#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/io/image_file.hpp"
#include "hemi/io/paths.hpp"
#include "hemi/scene/image_mesh.hpp"
#include "hemi/scene/light_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace hemi {

namespace {

std::array<std::uint32_t, 3> all_channels(const Scene& scene) {
    if (scene.channels.size() == 1) {
        return {0, 0, 0};
    }
    if (scene.channels.size() == 3) {
        return {0, 1, 2};
    }
    throw InvalidArgument(fmt::format("a picture of {} channels needs a choice of one or three of them: {}",
                                      scene.channels.size(), fmt::join(scene.channels, ", ")),
                          {"show"});
}

/// What every channel has on all patches; empty where it differs.
std::vector<double> uniform_radiosity(const Solution& solution) {
    constexpr double same = 1e-4;
    std::vector<double> values;
    for (std::size_t c = 0; c < solution.channels; ++c) {
        double low = std::numeric_limits<double>::infinity();
        double high = 0.0;
        std::size_t count = 0;
        for (std::size_t i = 0; i * solution.channels < solution.radiosity.size(); ++i) {
            if (solution.back_face_share.empty() || !(solution.back_face_share[i] > buried_above)) {
                low = std::min(low, solution.radiosity[i * solution.channels + c]);
                high = std::max(high, solution.radiosity[i * solution.channels + c]);
                ++count;
            }
        }
        if (count < 2 || high - low > same * high) {
            return {};
        }
        values.push_back(high);
    }
    return values;
}

/// Grey where nothing is known of materials.
std::vector<double> reflectance_of(const Scene& scene, const PatchMesh& mesh, std::uint32_t channels) {
    constexpr double grey = 0.5;
    return scene.materials.empty() ? std::vector<double>(std::size_t{mesh.size()} * channels, grey)
                                   : patch_values(mesh, scene.materials, &Material::reflectance);
}

} // namespace

Camera scene_camera(const Scene& scene, const PatchMesh& mesh) {
    return scene.camera ? *scene.camera
                        : interior_camera(mesh, scene.up)
                              .value_or(default_camera(ImageMesh(mesh).mesh().bounds(), scene.up));
}

std::array<float, 3> shown_environment(const Scene& scene, const std::array<std::uint32_t, 3>& show) {
    std::array<float, 3> shown{};
    for (std::size_t k = 0; k < 3 && !scene.environment.empty(); ++k) {
        shown[k] = static_cast<float>(scene.environment[show[k]]);
    }
    return shown;
}

bool is_dark(std::span<const double> radiosity, std::span<const double> environment) {
    const auto is_zero = [](double value) { return value == 0.0; };
    return std::all_of(radiosity.begin(), radiosity.end(), is_zero) &&
           std::all_of(environment.begin(), environment.end(), is_zero);
}

bool is_uniform(const Solution& solution) {
    return !uniform_radiosity(solution).empty();
}

std::string light_note(const Scene& scene, const Solution& solution) {
    if (is_dark(solution.radiosity, scene.environment)) {
        return "no light leaves any surface: the picture shows the scene evenly lit; exitances, a sun, a sky "
               "or an environment would light it";
    }
    std::string values;
    for (const double value : uniform_radiosity(solution)) {
        values += (values.empty() ? "" : ", ") + number_text(value);
    }
    return values.empty()
               ? ""
               : fmt::format("the radiosity is the same everywhere: {} {}", values, flux_density_unit(scene));
}

DrawnPicture draw_solution(const Scene& scene, const PatchMesh& mesh, const Solution& solution,
                           const DrawSettings& settings) {
    const std::array<std::uint32_t, 3> show = settings.show ? *settings.show : all_channels(scene);
    const bool dark = is_dark(solution.radiosity, scene.environment);
    PictureMesh drawn =
        dark ? make_picture_mesh(mesh, solution.channels,
                                 even_light(mesh, reflectance_of(scene, mesh, solution.channels),
                                            solution.channels, scene.up),
                                 solution.back_face_share, show)
             : make_picture_mesh(mesh, solution.channels, solution.radiosity, solution.back_face_share, show,
                                 solution.vertex_radiosity);
    drawn.environment = shown_environment(scene, show);
    PictureSettings picture = settings.picture;
    if (settings.automatic_exposure) {
        picture.exposure =
            automatic_exposure(mesh, drawn, solution.back_face_share, solution.exitance, solution.channels);
    }
    drawn = with_images(std::move(drawn), mesh);
    if (settings.dots != nullptr) {
        drawn = with_dots(std::move(drawn), *settings.dots, picture);
    }
    const Camera camera = settings.camera ? *settings.camera : scene_camera(scene, mesh);
    const bool rows_only = settings.device == cpu_device;
    DrawnPicture result{draw_picture(drawn, camera, picture, rows_only ? "auto" : settings.device),
                        picture.exposure, dark};
    if (settings.dots != nullptr) {
        draw_dots_legend(result.picture, *settings.dots);
    }
    if (dark) {
        std::fill(result.picture.linear.begin(), result.picture.linear.end(), 0.0F);
    }
    return result;
}

void write_picture(const std::filesystem::path& path, const Picture& picture) {
    const std::string extension = io::extension_of(path);
    if (extension == ".hdr") {
        io::write_hdr(path, picture.width, picture.height, picture.linear);
    } else if (extension == ".png" || io::is_standard_output(path)) {
        io::write_png(path, picture.width, picture.height, picture.srgb);
    } else {
        throw InvalidArgument(fmt::format("{}: pictures are written as .png or .hdr", path.string()));
    }
}

} // namespace hemi
