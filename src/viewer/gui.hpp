#pragma once

#include "viewer/events.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <vector>

namespace hemi::viewer {

/// Dear ImGui on the window's OpenGL context. It sees the events that the window or a script brings, one
/// frame an event, and nothing else: no files, no callbacks of its own, and no clock where a script drives.
class Gui {
public:
    /// With the window's context current.
    /// @param scale  pixels of the window for each pixel of the panels' layout, at least 1
    /// @param clock  whether time passes between frames, so that two clicks long after one another are no
    ///   double click; else every frame is a sixtieth of a second
    /// @throws GlError
    Gui(double scale, bool clock);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    /// Before the frame that is to know of it.
    void feed(const Event& event);
    /// Whether a field takes what is typed; keys are no commands then.
    [[nodiscard]] bool has_keyboard() const;
    /// Whether the mouse is the panels' business, as of the last frame.
    [[nodiscard]] bool has_mouse() const;

    /// Whether a slider or a button is held.
    [[nodiscard]] bool holds() const;
    /// Closes a list that is open. @return whether one was
    bool close_list();

    /// Pixels of the window as pixels of the layout, and back.
    [[nodiscard]] std::array<std::uint32_t, 2> layout(std::array<std::uint32_t, 2> window) const;
    [[nodiscard]] std::uint32_t pixels(std::uint32_t of_layout) const;
    /// Between begin() and end() panels are described.
    /// @param size  of the window, pixels
    void begin(std::array<std::uint32_t, 2> size);
    void end();

    /// Whether the last frame looks different from the one that was drawn last.
    [[nodiscard]] bool changed() const;
    /// Draws the last frame over the framebuffer that is bound.
    void draw();

private:
    [[nodiscard]] static std::vector<unsigned char> content();

    float scale_;
    bool clock_;
    std::chrono::steady_clock::time_point last_frame_;
    std::vector<unsigned char> drawn_;
};

} // namespace hemi::viewer
