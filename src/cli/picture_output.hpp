#pragma once

#include "cli/arguments.hpp"
#include "cli/outputs.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string>

/// Pictures as solve and render make them.
namespace hemi::cli {

/// Tests the picture's path. @throws as Outputs::add
void add_picture_output(Outputs& outputs, const PictureOptions& options);

/// Channels shown as red, green and blue: those of `--show`, else the only one or all three.
/// @throws InvalidArgument for unknown names, or if there are two or more than three channels and no
/// `--show`.
[[nodiscard]] std::array<std::uint32_t, 3> channels_to_show(const std::vector<std::string>& channels,
                                                            const std::vector<std::string>& show);

/// `--camera` over the scene's camera over one inside, where the scene is a room, over one that frames the
/// bounds; with `--orthographic`.
[[nodiscard]] Camera choose_camera(const Scene& scene, const PatchMesh& mesh, const PictureOptions& options);

/// Exitance of the environment in the channels shown: what lies behind all surfaces.
[[nodiscard]] std::array<float, 3> shown_environment(const Scene& scene,
                                                     const std::array<std::uint32_t, 3>& show);

/// How a picture is drawn; with an exposure of 1 where it is automatic.
[[nodiscard]] PictureSettings picture_settings(const PictureOptions& options);

/// What a picture shows; arrays as in Solution.
struct PictureSubject {
    const Scene& scene;
    const PatchMesh& mesh;
    std::span<const double> radiosity;
    std::span<const double> exitance;
    std::span<const double> blocked;
};

struct WrittenPicture {
    std::string text; ///< one line: the path, the size, the exposure
    double exposure = 1.0;
};

/// Draws and writes the picture.
/// @throws NoDevice, GlError, IoError
WrittenPicture write_picture(const PictureSubject& subject, const PictureOptions& options,
                             const std::string& device);

} // namespace hemi::cli
