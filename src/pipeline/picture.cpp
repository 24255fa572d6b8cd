#include "hemi/pipeline/picture.hpp"

#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/io/image_file.hpp"
#include "hemi/io/paths.hpp"

#include <fmt/format.h>

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

} // namespace

Camera scene_camera(const Scene& scene, const PatchMesh& mesh) {
    return scene.camera ? *scene.camera
                        : interior_camera(mesh, scene.up).value_or(default_camera(mesh.bounds(), scene.up));
}

std::array<float, 3> shown_environment(const Scene& scene, const std::array<std::uint32_t, 3>& show) {
    std::array<float, 3> shown{};
    for (std::size_t k = 0; k < 3 && !scene.environment.empty(); ++k) {
        shown[k] = static_cast<float>(scene.environment[show[k]]);
    }
    return shown;
}

DrawnPicture draw_solution(const Scene& scene, const PatchMesh& mesh, const Solution& solution,
                           const DrawSettings& settings) {
    const std::array<std::uint32_t, 3> show = settings.show ? *settings.show : all_channels(scene);
    PictureMesh drawn = make_picture_mesh(mesh, solution.channels, solution.radiosity,
                                          solution.back_face_share, show, solution.vertex_radiosity);
    drawn.environment = shown_environment(scene, show);
    PictureSettings picture = settings.picture;
    if (settings.automatic_exposure) {
        picture.exposure =
            automatic_exposure(mesh, drawn, solution.back_face_share, solution.exitance, solution.channels);
    }
    const Camera camera = settings.camera ? *settings.camera : scene_camera(scene, mesh);
    const bool rows_only = settings.device == cpu_device;
    return {draw_picture(drawn, camera, picture, rows_only ? "auto" : settings.device), picture.exposure};
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
