#pragma once

#include "viewer/bookmarks.hpp"
#include "viewer/document.hpp"
#include "viewer/groups.hpp"
#include "viewer/look.hpp"
#include "viewer/partners.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi::viewer {

/// What a button in the panel asks for, once.
struct Wishes {
    bool cancel = false; ///< the search for rows
    bool start_over = false;
    bool step = false;
    bool run_on = false;
    bool screenshot = false;
    bool save_result = false;
    bool save_probe = false;
    std::optional<int> bookmark; ///< to go to
    bool save_camera = false;
    bool copy_command = false;
    bool reload = false;
    bool save_materials = false;
    bool check = false;                       ///< the geometry
    bool open_compared = false;               ///< the result that is compared with, in place of the first
    bool leave_compared = false;              ///< compares with nothing any more
    std::optional<std::uint32_t> go_to_patch; ///< picks it and looks at it
    bool save_and_close = false;
    bool close = false;             ///< whatever is not saved
    bool stay = false;              ///< instead
    std::optional<char> camera_key; ///< as if it were pressed
    std::optional<double> fov;
    std::optional<bool> orthographic;
};

/// A size of screenshots.
struct PictureSize {
    const char* name;
    std::uint32_t width; ///< 0: as the scene has in the window
    std::uint32_t height;
    std::uint32_t scale; ///< of the scene's size in the window
};
[[nodiscard]] std::span<const PictureSize> picture_sizes();

/// What the user has chosen, by keys, clicks or panels.
struct Choices {
    Look look;
    std::optional<std::uint32_t> picked;
    std::optional<std::uint32_t> group;      ///< that is selected: the picked patch's, or one of the list
    std::optional<std::uint32_t> group_seen; ///< that the list was scrolled to
    std::array<char, 64> group_search{};     ///< letters in the names of groups that are listed
    PictureCut cut;                          ///< what the picture leaves out
    std::optional<std::uint32_t> pointed_at; ///< the patch in a list under the cursor
    bool partners_by_light = false;          ///< else by factor
    bool hemicube = true;                    ///< as the picked patch sees it
    bool hemicube_ids = false;               ///< coloured by item, else as the scene is
    std::uint32_t hemicube_eye = 0;
    std::vector<Material> materials;       ///< as the light should be
    std::vector<HeatCondition> conditions; ///< as the heat should be; none: the scene has none
    bool gauges = true;                    ///< axes and a scale bar
    bool walking = false;                  ///< W, A, S, D move the camera
    bool asks_to_write = false;            ///< materials into the scene's file
    bool measuring = false;                ///< clicks set ends of a line
    std::vector<Vec3> measured{};          ///< its ends, as far as they are set
    std::vector<double> environment;       ///< as it should be, of every channel
    std::array<float, 2> inset_moved{};    ///< of the hemicube's window, pixels of the layout
    std::array<float, 2> legend_moved{};   ///< likewise
    bool panel = true;
    bool help = false;
    std::size_t picture_size = 0; ///< of screenshots, into picture_sizes()
    std::uint32_t samples = 4;    ///< of screenshots, along an edge of a pixel
    Wishes wishes;
};

/// What a hemicube's picture depends on besides its patch.
struct HemicubeChoice {
    bool shown = true;
    bool ids = false;
    std::uint32_t eye = 0;

    bool operator==(const HemicubeChoice&) const = default;
};

/// All that the side panel shows.
struct PanelContent {
    const Document& document;
    const std::optional<PickedPatch>& picked;
    const Camera& camera;
    const Bookmarks& bookmarks;
    const GroupTable& groups;
    const std::optional<Field>& field;       ///< false colours that are shown
    std::string note;                        ///< on what was done last; empty: on the light
    std::string status;                      ///< at the panel's foot
    std::array<std::string, 2> under_cursor; ///< in its place: what is there, and where; empty: nothing
};

/// Pixels of the window's layout that the side panel takes, from the right; 0 where it is too small for it.
[[nodiscard]] std::uint32_t panel_width(std::array<std::uint32_t, 2> window, bool wanted);

/// The side panel. Between Gui::begin() and Gui::end().
void side_panel(const PanelContent& content, std::array<std::uint32_t, 2> window, Choices& choices);

} // namespace hemi::viewer
