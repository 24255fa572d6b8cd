#pragma once

#include "viewer/events.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace hemi::viewer {

/// Dear ImGui on the window's OpenGL context. It sees the events that the window or a script brings, one
/// frame an event, and nothing else: no clock, no files, no callbacks of its own.
class Gui {
public:
    /// With the window's context current. @throws GlError
    Gui();
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    /// Before the frame that is to know of it.
    void feed(const Event& event);
    /// Whether the mouse is the panels' business, as of the last frame.
    /// Whether a field takes what is typed; keys are no commands then.
    [[nodiscard]] bool has_keyboard() const;
    [[nodiscard]] bool has_mouse() const;

    /// Whether a slider or a button is held.
    [[nodiscard]] bool holds() const;
    /// Closes a list that is open. @return whether one was
    bool close_list();

    /// Between begin() and end() panels are described.
    void begin(std::array<std::uint32_t, 2> size);
    void end();

    /// Whether the last frame looks different from the one that was drawn last.
    [[nodiscard]] bool changed() const;
    /// Draws the last frame over the framebuffer that is bound.
    void draw();

private:
    [[nodiscard]] static std::vector<unsigned char> content();

    std::vector<unsigned char> drawn_;
};

} // namespace hemi::viewer
