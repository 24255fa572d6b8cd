#pragma once

#include "display/orbit_camera.hpp"
#include "viewer/panels.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string>

/// What lies over the scene. Between Gui::begin() and Gui::end().
namespace hemi::viewer {

/// The outline of a patch, in front of everything.
/// @param picked  else pointed at: another colour
void mark_patch(const PatchMesh& mesh, std::uint32_t patch, const OrbitCamera& orbit,
                std::array<std::uint32_t, 2> view, bool picked);
/// Edges of the group that is selected, in front of everything.
void mark_edges(std::span<const std::array<Vec3, 2>> edges, const OrbitCamera& orbit,
                std::array<std::uint32_t, 2> view);
/// A hemicube unfolded, as a texture of the window's context.
struct HemicubePicture {
    std::uint32_t texture;
    std::uint32_t patch;
    std::uint32_t resolution;
    std::uint32_t eyes; ///< eye points of the patch
};
/// In the upper right of the view, with what it is and how it is coloured.
void hemicube_window(const HemicubePicture& picture, std::array<std::uint32_t, 2> view, Choices& choices);
/// Mouse and keys.
void help_window(std::array<std::uint32_t, 2> view, Controls controls, bool& open);
/// Whether to quit although something is not saved, in the middle of the view.
/// @param unsaved  what that is
/// @param savable  whether it can be saved
void close_question(const std::string& unsaved, bool savable, std::array<std::uint32_t, 2> view,
                    Wishes& wishes);
/// Whether to write what was changed into the scene's file, in the middle of the view.
/// @param words  what would be written
void write_question(const std::string& words, const std::string& file, std::array<std::uint32_t, 2> view,
                    Choices& choices);
/// That surfaces which face away are not drawn, at the top of the view.
void backs_note(std::array<std::uint32_t, 2> view);
/// What went wrong, in the upper left of the view.
void message_window(const std::string& message, std::array<std::uint32_t, 2> view, bool& open);

} // namespace hemi::viewer
