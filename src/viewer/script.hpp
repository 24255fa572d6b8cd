#pragma once

#include "hemi/display/colour_map.hpp"
#include "hemi/display/picture_cut.hpp"
#include "viewer/events.hpp"
#include "viewer/findings.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hemi::viewer {

struct DragCommand {
    Button button;
    bool shift;
    bool control;
    std::vector<std::array<double, 2>> path; ///< pressed at the first point, released at the last
};
struct ScrollCommand {
    double x;
    double y;
    double amount;
};
struct KeyCommand {
    KeyEvent event;
};
struct ClickCommand {
    double x;
    double y;
};
/// The cursor goes there, no button pressed.
struct MoveCommand {
    double x;
    double y;
};
struct ShowCommand {
    std::string word;
};
/// Of quantities.
struct ChannelCommand {
    std::string channel;
};
struct MapCommand {
    ColourMap map;
};
/// Of quantities; none: as their values ask for.
struct RangeCommand {
    std::optional<std::array<double, 2>> range;
};
/// The column of the points that dots show; "none" hides them.
struct DotsCommand {
    std::string column;
};
/// A material's values, one or one a channel, or the temperature of a group, K.
struct SetCommand {
    enum class Property { reflectance, exitance, temperature, environment };
    Property property;
    std::vector<double> values;
    std::string name; ///< of the material, or of the group; of the environment none
};
/// Of false colours; 0: smooth ones.
struct BandsCommand {
    std::uint32_t count;
};
struct IsoLinesCommand {
    bool drawn;
};
/// How much of a group is shown.
struct GroupCommand {
    enum class Action { select, show, outlines, hide, isolate, show_all };
    Action action;
    std::string group; ///< of all but show_all
};
/// Where the picture is cut.
struct ClipCommand {
    bool through_patch = false;     ///< the picked one
    std::optional<ClipPlane> plane; ///< else that; none: it is not cut
};
/// Whether quantities are shown as differences to what is compared.
struct DifferenceCommand {
    bool shown;
};
/// As a click on one of the patches that are found of a kind.
struct FindingCommand {
    Finding kind;
    std::uint32_t number; ///< from 1, worst first
};
/// Work that took longer is asked for before the window closes.
struct LongWorkCommand {
    double seconds;
};
/// Types letters into the field that was clicked.
struct TypeCommand {
    std::string text;
};
struct ResizeCommand {
    std::uint32_t width;
    std::uint32_t height;
};
struct ScreenshotCommand {
    std::string path;
    std::array<std::uint32_t, 2> size{0, 0}; ///< 0: as the scene has in the window
    std::uint32_t samples = 4;
};
/// Opens a file, as if it were dropped on the window.
struct DropCommand {
    std::string path;
};
/// Reads the file again.
struct ReloadCommand {};
/// Until the file has changed on the disk, and was read again.
struct ChangedCommand {};
struct SaveResultCommand {
    std::string path;
};
/// Of the line that is measured.
struct SaveProbeCommand {
    std::string path;
};
/// As D and two clicks.
struct MeasureCommand {
    std::array<double, 2> from;
    std::array<double, 2> to;
};
struct SaveCameraCommand {};
/// Writes changed materials into the scene's file, without a question.
struct SaveMaterialsCommand {};
/// Writes the command line that draws the picture.
struct CommandLineCommand {
    std::string path;
};
struct FovCommand {
    double degrees;
};
struct MinimiseCommand {
    bool minimised; ///< else back to what it was
};
/// As ScreenshotCommand, of the window with its panels.
struct WindowshotCommand {
    std::string path;
};
/// Writes what is shown as JSON.
struct ReportCommand {
    std::string path;
};
/// As the first command: does not wait until the scene is solved.
struct LiveCommand {};
/// Until the scene is solved.
struct WaitCommand {};
/// Until there is more to see than the lamps.
struct PreviewCommand {};
/// Until that share of the patches shows what its own row tells of its light, or all is solved.
struct RowsCommand {
    double share;
};
/// Until the scene is cut into so many patches, or all is solved.
struct PatchesCommand {
    std::uint32_t count;
};
/// Stops solving.
struct CancelCommand {};
struct QuitCommand {};

struct ScriptCommand {
    std::size_t line;
    std::variant<DragCommand, ClickCommand, MoveCommand, ScrollCommand, KeyCommand, ShowCommand,
                 ChannelCommand, MapCommand, RangeCommand, DotsCommand, BandsCommand, IsoLinesCommand,
                 GroupCommand, ClipCommand, DifferenceCommand, FindingCommand, LongWorkCommand, TypeCommand,
                 MeasureCommand, SaveProbeCommand, SetCommand, ResizeCommand, ScreenshotCommand,
                 WindowshotCommand, ReportCommand, LiveCommand, WaitCommand, PreviewCommand, RowsCommand,
                 PatchesCommand, CancelCommand, DropCommand, ReloadCommand, ChangedCommand, SaveResultCommand,
                 SaveCameraCommand, SaveMaterialsCommand, CommandLineCommand, FovCommand, MinimiseCommand,
                 QuitCommand>
        action;
};

/// Reads a script that drives the window: one command a line, a `#` that begins a word begins a comment.
/// Points are pixels from the upper left.
/// ```
/// drag [shift+|ctrl+]left|middle|right X0 Y0 X1 Y1 [X Y ...]
/// click X Y              with the left button
/// move X Y               of the cursor
/// scroll X Y AMOUNT
/// key [ctrl+|alt+][shift+]NAME  a letter, a digit, Escape, Tab, Home, F1 or F5
/// show QUANTITY          picture, outlines, items, radiosity, reflectance, exitance, row-error, error, row
///                        or column
/// dots COLUMN            of the points that dots show, or none
/// set reflectance|exitance VALUE[,VALUE ...] MATERIAL
///                        one value, or one a channel; waits until the light has followed
/// set temperature KELVIN GROUP
/// set environment VALUE[,VALUE ...]
/// bands N, bands off     of false colours
/// iso-lines on|off
/// select|show-group|outline|hide|isolate GROUP
///                        selects it; how much of it is shown; show-all
/// clip PLANE             as parse_clip_plane() reads it; `patch`: through the picked one; `off`
/// difference on|off      of quantities, to the result that is compared
/// finding KIND N         goes to one of the patches that check finds, 1 the worst of its kind
/// long-work SECONDS      work that is asked for before the window closes, 60 else
/// measure X0 Y0 X1 Y1    the line between what is seen at two pixels
/// save-probe FILE        .csv: what is shown along it
/// type TEXT              into the field that was clicked
/// fov DEGREES            field of view
/// resize WIDTH HEIGHT
/// minimise, restore      the window
/// screenshot [WxH [SAMPLES]] FILE
///                        .png or .hdr: the picture; the name is the rest of the line
/// windowshot FILE        .png: the window with its panels
/// report FILE            .json: picked patch, quantity shown and its values, radiosity, camera …
/// command FILE           .txt: the command line that draws the picture
/// save-result FILE       .hres
/// save-camera            into the scene's file
/// save-materials         what was changed, into the scene's file
/// drop FILE              opens it; where it cannot be read, the window says so
/// reload                 reads the file again
/// changed                until the file has changed on the disk, and was read again
/// live                   as the first command: the script does not wait until the scene is solved
/// preview                until there is a coarse preview of it, or all
/// rows SHARE             until that share of the rows has come and is on the picture, or all is solved
/// patches N              until it is cut into so many patches, or all is solved
/// wait                   until it is solved
/// cancel                 of what is being solved
/// quit
/// ```
/// @param file  name for messages.
/// @throws ParseError with file and line.
[[nodiscard]] std::vector<ScriptCommand> parse_script(std::string_view text, const std::string& file);

} // namespace hemi::viewer
