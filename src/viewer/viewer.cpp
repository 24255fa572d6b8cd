#include "viewer/viewer.hpp"

#include "display/orbit_camera.hpp"
#include "display/picture_renderer.hpp"
#include "display/visible_point.hpp"
#include "viewer/script.hpp"
#include "viewer/window.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/image_file.hpp"
#include "hemi/io/output_file.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <optional>

namespace hemi::viewer {

namespace {

/// How far a hand turns the scene: a drag over the height of the picture is half a turn.
constexpr double radians_per_height = std::numbers::pi;
/// Change of the distance by one notch of the wheel, and by a right drag over the height of the picture.
constexpr double zoom_per_notch = 0.85;
constexpr double zoom_per_height = 0.05;
/// One press of E.
constexpr double exposure_step = 1.259921049894873; // a third of a stop
/// After so long without an event the picture is drawn in full quality, seconds.
constexpr double rest = 0.2;

template <typename... Functions>
struct Overloaded : Functions... {
    using Functions::operator()...;
};
template <typename... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

/// The window's picture and what the user does to it. Real input and scripts come in by the same door,
/// handle().
class Viewer {
public:
    explicit Viewer(const ViewerInput& input)
        : input_(input), window_(input.title, input.picture.width, input.picture.height),
          orbit_(input.camera, input.mesh->bounds()), settings_(input.picture) {
        PictureMesh picture =
            make_picture_mesh(*input.mesh, input.channels, input.radiosity, input.blocked, input.show);
        picture.environment = input.environment;
        if (input.automatic_exposure) {
            settings_.exposure =
                automatic_exposure(*input.mesh, picture, input.blocked, input.exitance, input.channels);
        }
        renderer_.upload(picture);
        update_title();
    }

    void run() {
        while (!closing_) {
            const bool preview = moving_ && window_.software();
            if (changed_) {
                draw(preview);
            }
            moving_ = button_.has_value();
            for (const Event& event : window_.wait(preview && !button_ ? rest : 0.0)) {
                handle(event);
            }
            // Nothing came: the preview on the screen is drawn anew in full quality.
            changed_ = changed_ || (preview && !moving_);
        }
    }

    void run(const std::vector<ScriptCommand>& script, const std::string& file) {
        for (const ScriptCommand& command : script) {
            if (closing_) {
                return;
            }
            try {
                std::visit([this](const auto& action) { perform(action); }, command.action);
            } catch (const IoError& error) {
                throw IoError(fmt::format("{}:{}: {}", file, command.line, error.what()));
            }
            for (const Event& event : window_.poll()) {
                // Whoever watches may close the window, but does not get in the script's way.
                if (std::holds_alternative<CloseEvent>(event) ||
                    std::holds_alternative<RefreshEvent>(event)) {
                    handle(event);
                }
            }
            if (changed_ && !closing_) {
                draw(window_.software());
            }
        }
    }

private:
    struct Point {
        double x;
        double y;
    };

    void handle(const Event& event) {
        std::visit(Overloaded{[this](const CursorEvent& e) { on_cursor(e); },
                              [this](const ButtonEvent& e) { on_button(e); },
                              [this](const ScrollEvent& e) { on_scroll(e); },
                              [this](const KeyEvent& e) { on_key(e); },
                              [this](const RefreshEvent&) { changed_ = true; },
                              [this](const CloseEvent&) { closing_ = true; }},
                   event);
    }

    /// On the screen as OrbitCamera wants it: heights of the picture, from its centre, y upwards.
    [[nodiscard]] Point on_screen(Point pixel) const {
        const auto size = window_.size();
        const double height = std::max(size[1], 1U);
        return {(pixel.x - 0.5 * size[0]) / height, 0.5 - pixel.y / height};
    }

    [[nodiscard]] double aspect() const {
        const auto size = window_.size();
        return static_cast<double>(std::max(size[0], 1U)) / std::max(size[1], 1U);
    }

    /// The surface point under the cursor; where there is none, the target's depth there.
    [[nodiscard]] Vec3 point_under_cursor() const {
        const Point place = on_screen(cursor_);
        const ViewRay ray = orbit_.ray(place.x, place.y);
        if (const auto point = visible_point(*input_.mesh, ray.origin, ray.direction)) {
            return *point;
        }
        const Camera& camera = orbit_.camera();
        return ray.origin + glm::length(camera.target - camera.eye) * ray.direction;
    }

    void on_cursor(const CursorEvent& event) {
        cursor_ = {event.x, event.y};
        if (!button_) {
            return;
        }
        const Point from = on_screen(pressed_at_);
        const Point to = on_screen(cursor_);
        if (panning_) {
            orbit_.pan(to.x - from.x, to.y - from.y);
        } else if (*button_ == Button::left) {
            orbit_.orbit(radians_per_height * (to.x - from.x), radians_per_height * (from.y - to.y));
        } else {
            orbit_.zoom(std::pow(zoom_per_height, to.y - from.y));
        }
        moved();
    }

    void on_button(const ButtonEvent& event) {
        if (!event.pressed) {
            if (button_ == event.button) {
                button_.reset();
            }
            return;
        }
        button_ = event.button;
        panning_ = event.button == Button::middle || (event.button == Button::left && event.shift);
        pressed_at_ = cursor_;
        orbit_.grab(event.button == Button::left && !panning_ ? pivot_for_orbit() : point_under_cursor());
    }

    /// Off the scene one turns about the target, not about a place in empty space.
    [[nodiscard]] Vec3 pivot_for_orbit() const {
        const Point place = on_screen(cursor_);
        const ViewRay ray = orbit_.ray(place.x, place.y);
        return visible_point(*input_.mesh, ray.origin, ray.direction).value_or(orbit_.camera().target);
    }

    void on_scroll(const ScrollEvent& event) {
        if (button_) {
            return;
        }
        orbit_.grab(point_under_cursor());
        orbit_.zoom(std::pow(zoom_per_notch, event.amount));
        moved();
    }

    void on_key(const KeyEvent& event) {
        const char key = event.key;
        button_.reset();
        if (key == 'F') {
            orbit_.frame_all(aspect());
        } else if (key == 'R') {
            orbit_.reset();
        } else if (key == '1') {
            orbit_.look_along(OrbitCamera::Axis::front, aspect());
        } else if (key == '3') {
            orbit_.look_along(OrbitCamera::Axis::right, aspect());
        } else if (key == '7') {
            orbit_.look_along(OrbitCamera::Axis::top, aspect());
        } else if (key == 'S') {
            settings_.shading = settings_.shading == Shading::flat ? Shading::gouraud : Shading::flat;
        } else if (key == 'T') {
            settings_.tone_mapping =
                settings_.tone_mapping == ToneMapping::filmic ? ToneMapping::linear : ToneMapping::filmic;
        } else if (key == 'E') {
            settings_.exposure *= event.shift ? 1.0 / exposure_step : exposure_step;
        } else if (key == 'W') {
            settings_.outlines = !settings_.outlines;
        } else if (key == 'P') {
            numbered_screenshot();
            return;
        } else if (key == 'Q' || key == escape_key) {
            closing_ = true;
            return;
        } else {
            return;
        }
        changed_ = true;
        update_title();
    }

    void moved() {
        changed_ = true;
        moving_ = true;
    }

    void update_title() {
        window_.set_title(fmt::format("{} - exposure {:.3g}, {} - {}", input_.title, settings_.exposure,
                                      settings_.tone_mapping == ToneMapping::filmic ? "filmic" : "linear",
                                      window_.renderer()));
    }

    void draw(bool preview) {
        const auto size = window_.size();
        changed_ = false;
        if (size[0] == 0 || size[1] == 0) {
            return;
        }
        PictureSettings settings = settings_;
        settings.width = size[0];
        settings.height = size[1];
        settings.samples = preview ? 1 : settings.samples;
        renderer_.draw(orbit_.camera(), settings, 0);
        window_.swap();
    }

    void screenshot(const std::filesystem::path& path) {
        const auto size = window_.size();
        PictureSettings settings = settings_;
        settings.width = std::max(size[0], 1U);
        settings.height = std::max(size[1], 1U);
        const Picture picture = renderer_.picture(orbit_.camera(), settings);
        if (path.extension() == ".hdr") {
            io::write_hdr(path, picture.width, picture.height, picture.linear);
        } else {
            io::write_png(path, picture.width, picture.height, picture.srgb);
        }
        std::fprintf(stderr, "%s\n", path.string().c_str());
    }

    /// Under the first free number; a folder that cannot be written to is no reason to close the window.
    void numbered_screenshot() {
        std::filesystem::path path;
        int number = 1;
        do {
            path = fmt::format("{}-{:03}.png", input_.file_stem, number++);
        } while (std::filesystem::exists(path));
        try {
            screenshot(path);
        } catch (const IoError& error) {
            std::fprintf(stderr, "%s\n", error.what());
        }
    }

    void perform(const DragCommand& drag) {
        handle(CursorEvent{drag.path[0][0], drag.path[0][1]});
        handle(ButtonEvent{drag.button, true, drag.shift});
        for (std::size_t i = 1; i < drag.path.size(); ++i) {
            handle(CursorEvent{drag.path[i][0], drag.path[i][1]});
        }
        handle(ButtonEvent{drag.button, false, drag.shift});
    }
    void perform(const ScrollCommand& scroll) {
        handle(CursorEvent{scroll.x, scroll.y});
        handle(ScrollEvent{scroll.amount});
    }
    void perform(const KeyCommand& key) { handle(key.event); }
    void perform(const ResizeCommand& resize) {
        window_.resize(resize.width, resize.height);
        // A window manager takes its time, or has its own ideas.
        const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(2);
        while (window_.size() != std::array{resize.width, resize.height} &&
               std::chrono::steady_clock::now() < late) {
            for (const Event& event : window_.wait(0.05)) {
                if (std::holds_alternative<CloseEvent>(event)) {
                    handle(event);
                }
            }
        }
        changed_ = true;
    }
    void perform(const ScreenshotCommand& command) { screenshot(command.path); }
    void perform(const QuitCommand&) { closing_ = true; }

    const ViewerInput& input_;
    Window window_; // before everything that lives in its context
    PictureRenderer renderer_;
    OrbitCamera orbit_;
    PictureSettings settings_;

    Point cursor_{0.0, 0.0};
    Point pressed_at_{0.0, 0.0};
    std::optional<Button> button_;
    bool panning_ = false;
    bool moving_ = false;
    bool changed_ = true;
    bool closing_ = false;
};

} // namespace

int run_viewer(const ViewerInput& input) {
    if (input.mesh == nullptr) {
        throw InvalidArgument("viewer: no mesh");
    }
    if (input.script.empty()) {
        Viewer(input).run();
        return 0;
    }
    const std::vector<ScriptCommand> script = parse_script(io::read_file(input.script), input.script);
    Viewer(input).run(script, input.script);
    return 0;
}

} // namespace hemi::viewer
