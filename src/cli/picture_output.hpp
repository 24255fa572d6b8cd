#pragma once

#include "cli/arguments/arguments.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/report.hpp"
#include "hemi/display/dots.hpp"
#include "hemi/display/false_colours.hpp"
#include "hemi/display/picture.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solution.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// Pictures as solve and render make them.
namespace hemi::cli {

/// Tests the picture's path.
/// @param heat  whether quantities of heat may be known
/// @throws as Outputs::add
void add_picture_output(Outputs& outputs, const PictureOptions& options, bool heat = false);

/// Channels shown as red, green and blue: those of `--show`, else the only one or all three.
/// @param quantities  whether the one word might have been meant to be a quantity's
/// @throws InvalidArgument for unknown names, with the nearest right word where there is one, or if there are
/// two or more than three channels and no `--show`.
[[nodiscard]] std::array<std::uint32_t, 3> channels_to_show(const std::vector<std::string>& channels,
                                                            const std::vector<std::string>& show,
                                                            bool quantities = true);

/// `--camera` over the scene's camera over one inside, where the scene is a room, over one that frames the
/// bounds; with `--orthographic`.
[[nodiscard]] Camera choose_camera(const Scene& scene, const PatchMesh& mesh, const PictureOptions& options);

/// What `--hide`, `--outlines-of` and `--clip` leave out.
/// @param groups  names of all
/// @throws InvalidArgument for names that are none, and a group that both name
[[nodiscard]] PictureCut picture_cut(const PictureOptions& options, std::span<const std::string> groups);

/// How a picture is drawn, whole; with an exposure of 1 where it is automatic.
[[nodiscard]] PictureSettings picture_settings(const PictureOptions& options);

/// Draws and writes values of patches in false colours, as the options for quantities say.
/// @param word  what they are, for the report
/// @param dots  in the picture; may be null
/// @return as write_picture()
[[nodiscard]] Report write_false_colours(const Scene& scene, const PatchMesh& mesh, FalseColours shown,
                                         const PictureOptions& options, const std::string& device,
                                         std::string_view word, const Dots* dots = nullptr);

/// Draws and writes the picture.
/// @return the line "picture" and the keys "picture" (path), "width", "height", "exposure" and "quantity"
/// @param dots  in the picture; may be null
/// @throws NoDevice, GlError, IoError
[[nodiscard]] Report write_picture(const Scene& scene, const PatchMesh& mesh, const Solution& solution,
                                   const PictureOptions& options, const std::string& device,
                                   const Dots* dots = nullptr);

} // namespace hemi::cli
