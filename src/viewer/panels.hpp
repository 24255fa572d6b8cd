#pragma once

#include "display/orbit_camera.hpp"
#include "viewer/look.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi::viewer {

/// One of the patches that a picked one exchanges most light with.
struct Partner {
    std::uint32_t patch;
    double factor; ///< F(picked, patch), or F(patch, picked) where columns are shown
    double share;  ///< of the light that arrives at the picked patch from all patches; 0 where none does
};

/// A picked patch, and whom it faces.
struct PickedPatch {
    std::uint32_t patch;
    std::vector<Partner> partners; ///< largest first, a few; empty without form factors
};

/// What the user has chosen, by keys, clicks or panels.
struct Choices {
    Look look;
    std::optional<std::uint32_t> picked;
    std::optional<std::uint32_t> pointed_at; ///< the patch in a list under the cursor
    bool partners_by_light = false;          ///< else by factor
    bool hemicube = true;                    ///< as the picked patch sees it
    bool hemicube_ids = false;               ///< coloured by item, else as the scene is
    std::uint32_t hemicube_eye = 0;
    std::vector<Material> materials; ///< as the light should be
    bool cancel = false;             ///< what is being solved
    bool panel = true;
    bool help = false;
};

/// What a hemicube's picture depends on besides its patch.
struct HemicubeChoice {
    bool shown = true;
    bool ids = false;
    std::uint32_t eye = 0;

    bool operator==(const HemicubeChoice&) const = default;
};

/// All that the panels show.
struct PanelContent {
    const ViewerInput& input;
    const Light& light;
    const std::optional<PickedPatch>& picked;
    std::string status;        ///< at the panel's foot
    std::string relit;         ///< on the last change of materials
    std::string solving;       ///< what is under way; empty: nothing
    double solved_share = 0.0; ///< of that
    /// Materials of which a row is unknown: they must not begin to reflect. One a material.
    const std::vector<bool>& without_rows;
};

/// Pixels of the window that the side panel takes, from the right; 0 where the window is too small for it.
[[nodiscard]] std::uint32_t panel_width(std::array<std::uint32_t, 2> window, bool wanted);

/// The side panel. Between Gui::begin() and Gui::end(), like all that follow.
void side_panel(const PanelContent& content, std::array<std::uint32_t, 2> window, Choices& choices);
/// The colours of a field, in the lower left of the view.
void legend(const Field& field, std::array<std::uint32_t, 2> view);
/// The outline of a patch, in front of everything.
/// @param picked  else pointed at: another colour
void mark_patch(const PatchMesh& mesh, std::uint32_t patch, const OrbitCamera& orbit,
                std::array<std::uint32_t, 2> view, bool picked);
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
void help_window(std::array<std::uint32_t, 2> view, bool& open);

/// The `count` patches with the largest factor, or that send the most light.
/// @param column  factors are F(patch, picked), else F(picked, patch)
[[nodiscard]] std::vector<Partner> largest_partners(const ViewerInput& input, const Light& light,
                                                    std::uint32_t picked, bool column, bool by_light,
                                                    std::size_t count);

} // namespace hemi::viewer
