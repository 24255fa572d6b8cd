#pragma once

#include "viewer/events.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hemi::viewer {

struct DragCommand {
    Button button;
    bool shift;
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
    std::string quantity;
};
/// A material's values, one or one a channel.
struct SetCommand {
    bool exitance; ///< else reflectance
    std::vector<double> values;
    std::string material;
};
struct ResizeCommand {
    std::uint32_t width;
    std::uint32_t height;
};
struct ScreenshotCommand {
    std::string path;
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
/// Stops solving.
struct CancelCommand {};
struct QuitCommand {};

struct ScriptCommand {
    std::size_t line;
    std::variant<DragCommand, ClickCommand, MoveCommand, ScrollCommand, KeyCommand, ShowCommand, SetCommand,
                 ResizeCommand, ScreenshotCommand, WindowshotCommand, ReportCommand, LiveCommand, WaitCommand,
                 CancelCommand, QuitCommand>
        action;
};

/// Reads a script that drives the window: one command a line, a `#` that begins a word begins a comment.
/// Points are pixels from the upper left.
/// ```
/// drag [shift+]left|middle|right X0 Y0 X1 Y1 [X Y ...]
/// click X Y              with the left button
/// move X Y               of the cursor
/// scroll X Y AMOUNT
/// key [shift+]NAME       a letter, a digit, Escape, Tab or F1
/// show QUANTITY          picture, outlines, items, radiosity, reflectance, exitance, row-error, error, row
///                        or column
/// set reflectance|exitance VALUE[,VALUE ...] MATERIAL
///                        one value, or one a channel; waits until the light has followed
/// resize WIDTH HEIGHT
/// screenshot FILE        .png or .hdr: the picture; the name is the rest of the line
/// windowshot FILE        .png: the window with its panels
/// report FILE            .json: picked patch, quantity shown and its values, radiosity
/// live                   as the first command: the script does not wait until the scene is solved
/// wait                   until it is
/// cancel                 of what is being solved
/// quit
/// ```
/// @param file  name for messages.
/// @throws ParseError with file and line.
[[nodiscard]] std::vector<ScriptCommand> parse_script(std::string_view text, const std::string& file);

} // namespace hemi::viewer
