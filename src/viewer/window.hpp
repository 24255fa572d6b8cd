#pragma once

#include "gl/context.hpp"
#include "viewer/events.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

struct GLFWwindow;

namespace hemi::viewer {

/// A window with an OpenGL 4.5 core context, current on the main thread; it collects what the user does.
class Window final : public gl::Context {
public:
    /// The window may come out smaller than asked for where the screen is.
    /// @throws NoDevice without a display or without OpenGL 4.5 on it.
    Window(const std::string& title, std::uint32_t width, std::uint32_t height);
    ~Window() override;

    void make_current() override;

    /// Pixels; 0 while the window is minimised.
    [[nodiscard]] std::array<std::uint32_t, 2> size() const;
    /// Pixels a point of the monitor's scale: 2 on a display of twice the usual density.
    [[nodiscard]] double scale() const;
    void resize(std::uint32_t width, std::uint32_t height);
    void set_title(const std::string& title);
    void minimise(bool minimised);
    /// Onto the clipboard.
    void copy_text(const std::string& text);
    /// Shows what was drawn.
    void swap();

    /// Events since the last call, in order; does not wait.
    [[nodiscard]] std::vector<Event> poll();
    /// Ends a wait(); from any thread.
    static void wake();
    /// Waits for an event, at most `seconds`; 0: as long as it takes.
    [[nodiscard]] std::vector<Event> wait(double seconds);

private:
    struct Callbacks;
    /// glfwInit and glfwTerminate, around the life of everything else.
    struct Library {
        Library();
        ~Library();
        Library(const Library&) = delete;
        Library& operator=(const Library&) = delete;
    };
    struct Closer {
        void operator()(GLFWwindow* window) const;
    };

    void listen();

    Library library_;
    std::unique_ptr<GLFWwindow, Closer> window_;
    std::vector<Event> events_;
};

} // namespace hemi::viewer
