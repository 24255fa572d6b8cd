#include "viewer/window.hpp"

#include "hemi/core/error.hpp"

// GLFW must not bring its own OpenGL header.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>
#include <utility>

namespace hemi::viewer {

namespace {

constexpr const char* no_window_needed = "`hemi render` needs none";

std::string last_problem() {
    const char* text = nullptr;
    return glfwGetError(&text) == GLFW_NO_ERROR || text == nullptr ? "no reason given" : text;
}

/// The key as its keyboard shows it; digits by their place, since some layouts want shift for them.
std::optional<char> key_name(int key, int scancode) {
    if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) {
        return static_cast<char>('0' + key - GLFW_KEY_0);
    }
    if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) {
        return static_cast<char>('0' + key - GLFW_KEY_KP_0);
    }
    if (key == GLFW_KEY_ESCAPE) {
        return escape_key;
    }
    if (key == GLFW_KEY_TAB) {
        return tab_key;
    }
    if (key == GLFW_KEY_F1) {
        return help_key;
    }
    if (key == GLFW_KEY_F5) {
        return reload_key;
    }
    if (key == GLFW_KEY_HOME) {
        return home_key;
    }
    if (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER) {
        return enter_key;
    }
    if (key == GLFW_KEY_BACKSPACE) {
        return backspace_key;
    }
    const char* name = glfwGetKeyName(key, scancode);
    if (name == nullptr || std::string_view(name).size() != 1) {
        return std::nullopt;
    }
    return static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
}

} // namespace

Window::Library::Library() {
    if (glfwInit() != GLFW_TRUE) {
        throw NoDevice(
            fmt::format("there is no display for a window ({}); {}", last_problem(), no_window_needed));
    }
}

Window::Library::~Library() {
    glfwTerminate();
}

void Window::Closer::operator()(GLFWwindow* window) const {
    glfwDestroyWindow(window);
}

/// GLFW calls these from C, so nothing may be thrown out of them; running out of memory ends the program.
struct Window::Callbacks {
    static std::vector<Event>& events(GLFWwindow* window) noexcept {
        return static_cast<Window*>(glfwGetWindowUserPointer(window))->events_;
    }
    static void cursor(GLFWwindow* window, double x, double y) noexcept {
        // The cursor is told in screen coordinates, the picture is made of pixels.
        int width = 1;
        int height = 1;
        int pixels_x = 1;
        int pixels_y = 1;
        glfwGetWindowSize(window, &width, &height);
        glfwGetFramebufferSize(window, &pixels_x, &pixels_y);
        events(window).push_back(
            CursorEvent{x * pixels_x / std::max(width, 1), y * pixels_y / std::max(height, 1)});
    }
    static void button(GLFWwindow* window, int button, int action, int modifiers) noexcept {
        if (button > GLFW_MOUSE_BUTTON_MIDDLE) {
            return;
        }
        const Button name = button == GLFW_MOUSE_BUTTON_LEFT
                                ? Button::left
                                : (button == GLFW_MOUSE_BUTTON_MIDDLE ? Button::middle : Button::right);
        events(window).push_back(ButtonEvent{name, action == GLFW_PRESS, (modifiers & GLFW_MOD_SHIFT) != 0,
                                             (modifiers & GLFW_MOD_CONTROL) != 0});
    }
    static void scroll(GLFWwindow* window, double, double amount) noexcept {
        events(window).push_back(ScrollEvent{amount});
    }
    static void key(GLFWwindow* window, int key, int scancode, int action, int modifiers) noexcept {
        if (action == GLFW_RELEASE) {
            return;
        }
        if (const std::optional<char> name = key_name(key, scancode)) {
            events(window).push_back(KeyEvent{*name, (modifiers & GLFW_MOD_SHIFT) != 0,
                                              (modifiers & GLFW_MOD_CONTROL) != 0,
                                              (modifiers & GLFW_MOD_ALT) != 0});
        }
    }
    static void text(GLFWwindow* window, unsigned int letter) noexcept {
        events(window).push_back(TextEvent{static_cast<char32_t>(letter)});
    }
    static void resized(GLFWwindow* window, int, int) noexcept { events(window).push_back(RefreshEvent{}); }
    static void refresh(GLFWwindow* window) noexcept { events(window).push_back(RefreshEvent{}); }
    static void close(GLFWwindow* window) noexcept { events(window).push_back(CloseEvent{}); }
    static void drop(GLFWwindow* window, int count, const char** paths) noexcept {
        if (count > 0) {
            events(window).push_back(DropEvent{paths[0]});
        }
    }
};

Window::Window(const std::string& title, std::uint32_t width, std::uint32_t height) {
    glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_API);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, gl::debug_wanted() ? GLFW_TRUE : GLFW_FALSE);
    // By which desktops know the program; else it would be the first title.
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "hemi");
    glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "hemi");
    // Depth and samples are the renderer's own.
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    if (GLFWmonitor* monitor = glfwGetPrimaryMonitor()) {
        int x = 0;
        int y = 0;
        int available_x = 0;
        int available_y = 0;
        glfwGetMonitorWorkarea(monitor, &x, &y, &available_x, &available_y);
        float scale_x = 1.0F; // by which the window becomes larger
        float scale_y = 1.0F;
        glfwGetMonitorContentScale(monitor, &scale_x, &scale_y);
        const auto limit = [](int available, float scale) {
            return static_cast<std::uint32_t>(static_cast<float>(available) / std::max(scale, 1.0F));
        };
        if (available_x > 0 && available_y > 0) {
            width = std::min(width, limit(available_x, scale_x));
            height = std::min(height, limit(available_y, scale_y));
        }
    }
    window_.reset(
        glfwCreateWindow(static_cast<int>(width), static_cast<int>(height), title.c_str(), nullptr, nullptr));
    if (!window_) {
        throw NoDevice(fmt::format("the display has no window with OpenGL 4.5 core ({}); {}", last_problem(),
                                   no_window_needed));
    }
    Window::make_current();
    describe("window");
    glfwSwapInterval(1);
    listen();
}

Window::~Window() = default;

void Window::listen() {
    GLFWwindow* window = window_.get();
    glfwSetWindowUserPointer(window, this);
    glfwSetCursorPosCallback(window, Callbacks::cursor);
    glfwSetMouseButtonCallback(window, Callbacks::button);
    glfwSetScrollCallback(window, Callbacks::scroll);
    glfwSetKeyCallback(window, Callbacks::key);
    glfwSetCharCallback(window, Callbacks::text);
    glfwSetFramebufferSizeCallback(window, Callbacks::resized);
    glfwSetWindowRefreshCallback(window, Callbacks::refresh);
    glfwSetWindowCloseCallback(window, Callbacks::close);
    glfwSetDropCallback(window, Callbacks::drop);
}

void Window::make_current() {
    glfwMakeContextCurrent(window_.get());
    gl::load_functions("window", glfwGetProcAddress);
}

std::array<std::uint32_t, 2> Window::size() const {
    int width = 0;
    int height = 0;
    glfwGetFramebufferSize(window_.get(), &width, &height);
    return {static_cast<std::uint32_t>(std::max(width, 0)), static_cast<std::uint32_t>(std::max(height, 0))};
}

double Window::scale() const {
    float x = 1.0F;
    float y = 1.0F;
    glfwGetWindowContentScale(window_.get(), &x, &y);
    return static_cast<double>(std::max(x, y));
}

void Window::resize(std::uint32_t width, std::uint32_t height) {
    glfwSetWindowSize(window_.get(), static_cast<int>(width), static_cast<int>(height));
}

void Window::set_title(const std::string& title) {
    glfwSetWindowTitle(window_.get(), title.c_str());
}

void Window::minimise(bool minimised) {
    if (minimised) {
        glfwIconifyWindow(window_.get());
    } else {
        glfwRestoreWindow(window_.get());
    }
}

void Window::copy_text(const std::string& text) {
    glfwSetClipboardString(window_.get(), text.c_str());
}

void Window::swap() {
    glfwSwapBuffers(window_.get());
}

std::vector<Event> Window::poll() {
    glfwPollEvents();
    return std::exchange(events_, {});
}

void Window::wake() {
    glfwPostEmptyEvent();
}

std::vector<Event> Window::wait(double seconds) {
    if (seconds > 0.0) {
        glfwWaitEventsTimeout(seconds);
    } else {
        glfwWaitEvents();
    }
    return std::exchange(events_, {});
}

} // namespace hemi::viewer
