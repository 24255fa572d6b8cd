#pragma once

#include "hemi/display/dots.hpp"
#include "hemi/display/picture.hpp"
#include "hemi/solver/solution.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi {

/// A camera inside the scene, where it is a room: at the place that sees farthest. Nothing where no place
/// that is tried is closed in all round.
/// @param mesh  all surfaces
/// @param up    Scene::up
[[nodiscard]] std::optional<Camera> interior_camera(const PatchMesh& mesh, UpAxis up = UpAxis::z);

/// The scene's own camera, else one inside a room, else one that frames the bounds.
[[nodiscard]] Camera scene_camera(const Scene& scene, const PatchMesh& mesh);

/// Exitance of the environment in the channels that are shown: what lies behind all surfaces.
[[nodiscard]] std::array<float, 3> shown_environment(const Scene& scene,
                                                     const std::array<std::uint32_t, 3>& show);

/// Whether no light leaves any surface, nor comes from the environment. A picture of such a scene shows it by
/// even_light().
/// @param radiosity    of all patches and channels
/// @param environment  Scene::environment
[[nodiscard]] bool is_dark(std::span<const double> radiosity, std::span<const double> environment);

/// Whether as much light leaves all surfaces, within 1e-4 of it and but for buried patches.
[[nodiscard]] bool is_uniform(const Solution& solution);

/// A sentence on light of which a picture shows little: is_dark(), or is_uniform(). Empty for others.
[[nodiscard]] std::string light_note(const Scene& scene, const Solution& solution);

/// How a solution is drawn.
struct DrawSettings {
    PictureSettings picture;        ///< size, shading …; its exposure counts unless it is automatic
    bool automatic_exposure = true; ///< chosen by automatic_exposure()
    std::optional<Camera> camera;   ///< empty: scene_camera()
    /// Channels shown as red, green, blue; empty: the only one, or all three.
    std::optional<std::array<std::uint32_t, 3>> show;
    const Dots* dots = nullptr; ///< in the picture, with their legend; may be null
    std::string device =
        "auto"; ///< auto, egl, egl:N or osmesa; cpu, which draws no pictures, stands for auto
};

/// A picture and the exposure that it was drawn with.
struct DrawnPicture {
    Picture picture;         ///< pixels
    double exposure = 1.0;   ///< that was used
    bool evenly_lit = false; ///< `picture.srgb` shows even_light(), since there is no other
};
/// Draws a solution offscreen; where is_dark(), by even_light().
/// @param scene     channels, environment, camera
/// @param mesh      its patches
/// @param solution  radiosity, exitance and back-face shares are used
/// @param settings  how
/// @throws InvalidArgument if there are two or more than three channels and none are chosen; as
/// draw_picture()
[[nodiscard]] DrawnPicture draw_solution(const Scene& scene, const PatchMesh& mesh, const Solution& solution,
                                         const DrawSettings& settings = {});

/// Writes a picture: `.png` as sRGB, `.hdr` as the radiosity itself. "-" is a PNG on standard output.
/// @throws InvalidArgument for another extension; IoError
void write_picture(const std::filesystem::path& path, const Picture& picture);

} // namespace hemi
