#pragma once

#include <string>
#include <variant>

/// What a window tells the viewer; a script says the same. Points are pixels from the upper left.
namespace hemi::viewer {

enum class Button { left, middle, right };

struct CursorEvent {
    double x;
    double y;
};
struct ButtonEvent {
    Button button;
    bool pressed;
    bool shift;
    bool control = false;
};
struct ScrollEvent {
    double amount; ///< notches of the wheel, away from the user positive
};
inline constexpr char escape_key = '\x1B';
inline constexpr char tab_key = '\t';
inline constexpr char help_key = '\x01';   ///< F1
inline constexpr char reload_key = '\x05'; ///< F5
inline constexpr char home_key = '\x02';   ///< Home
inline constexpr char enter_key = '\r';
inline constexpr char backspace_key = '\b';
/// `key` is what a keyboard shows on it: a capital letter, a digit, or one of the above.
struct KeyEvent {
    char key;
    bool shift;
    bool control = false;
    bool alt = false;
};
/// A letter that was typed, as the keyboard's layout has it.
struct TextEvent {
    char32_t letter;
};
/// The window has another size, or its content was lost.
struct RefreshEvent {};
struct CloseEvent {};
/// Files were dropped on the window; the first counts.
struct DropEvent {
    std::string path;
};

using Event = std::variant<CursorEvent, ButtonEvent, ScrollEvent, KeyEvent, TextEvent, RefreshEvent,
                           CloseEvent, DropEvent>;

/// Functions for std::visit, one an alternative.
template <typename... Functions>
struct Overloaded : Functions... {
    using Functions::operator()...;
};
template <typename... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

} // namespace hemi::viewer
