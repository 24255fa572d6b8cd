#include "viewer/viewer.hpp"

#include "display/orbit_camera.hpp"
#include "display/picture_renderer.hpp"
#include "display/visible_point.hpp"
#include "viewer/gui.hpp"
#include "viewer/hemicube_inset.hpp"
#include "viewer/keys.hpp"
#include "viewer/live_solver.hpp"
#include "viewer/look.hpp"
#include "viewer/material_change.hpp"
#include "viewer/panels.hpp"
#include "viewer/relighter.hpp"
#include "viewer/report.hpp"
#include "viewer/scene_target.hpp"
#include "viewer/script.hpp"
#include "viewer/window.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/io/image_file.hpp"
#include "hemi/io/output_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <optional>
#include <thread>

namespace hemi::viewer {

namespace {

/// How far a hand turns the scene: a drag over the height of the picture is half a turn.
constexpr double radians_per_height = std::numbers::pi;
/// Change of the distance by one notch of the wheel, and by a right drag over the height of the picture.
constexpr double zoom_per_notch = 0.85;
constexpr double zoom_per_height = 0.05;
/// A press and release with less way between is a click, pixels.
constexpr double click_way = 4.0;
/// Lines in the list of partners.
constexpr std::size_t partner_count = 8;
/// After so long without an event the picture is drawn in full quality, seconds.
constexpr double rest = 0.2;

/// The window's picture and what the user does to it. Real input and scripts come in by the same door,
/// handle().
class Viewer {
public:
    explicit Viewer(const ViewerInput& input)
        : input_(input), window_(input.title, input.picture.width, input.picture.height),
          orbit_(input.camera, input.mesh->bounds()), light_{input.reflectance, input.exitance,
                                                             input.radiosity},
          exposure_(input.picture.exposure), lamps_only_(input.solve != nullptr) {
        choices_.look.shading = input.picture.shading;
        choices_.look.tone_mapping = input.picture.tone_mapping;
        choices_.look.outlines = input.picture.outlines;
        choices_.materials = asked_materials_ = input.scene->materials;
        prepare_factors();
        prepare_light();
        choose_exposure();
        settle();
        if (input_.solve) {
            solver_.emplace(input_.solve, Window::wake);
        }
    }

    void run() {
        while (!closing_) {
            const bool preview = moving_ && window_.software();
            draw(preview);
            moving_ = button_.has_value() && dragging_;
            handle(window_.wait(preview && !button_ ? rest : 0.0));
            take_solution();
            take_light();
            // Nothing came: the preview on the screen is drawn anew in full quality.
            picture_changed_ = picture_changed_ || (preview && !moving_);
        }
    }

    void run(const std::vector<ScriptCommand>& script, const std::string& file) {
        if (script.empty() || !std::holds_alternative<LiveCommand>(script[0].action)) {
            wait_for_solution();
        }
        for (const ScriptCommand& command : script) {
            if (closing_) {
                return;
            }
            try {
                std::visit([this](const auto& action) { perform(action); }, command.action);
            } catch (const IoError& error) {
                throw IoError(fmt::format("{}:{}: {}", file, command.line, error.what()));
            }
            watch(window_.poll());
            take_solution();
            if (!closing_) {
                draw(window_.software());
            }
        }
    }

private:
    struct Point {
        double x;
        double y;
    };

    /// Whoever watches a script may close the window, but does not get in the script's way.
    void watch(const std::vector<Event>& events) {
        for (const Event& event : events) {
            if (std::holds_alternative<CloseEvent>(event) || std::holds_alternative<RefreshEvent>(event)) {
                handle(event);
            }
        }
    }

    void wait_for_solution() {
        while (solver_ && !closing_) {
            draw(window_.software());
            watch(window_.wait(0.05));
            take_solution();
        }
    }

    /// Of cursor moves in a row only the last counts.
    void handle(const std::vector<Event>& events) {
        for (std::size_t k = 0; k < events.size() && !closing_; ++k) {
            const bool passed = std::holds_alternative<CursorEvent>(events[k]) && k + 1 < events.size() &&
                                std::holds_alternative<CursorEvent>(events[k + 1]);
            if (!passed) {
                handle(events[k]);
            }
        }
    }

    /// The panels see every event first; a drag that began in the view stays the view's.
    void handle(const Event& event) {
        gui_.feed(event);
        describe_panels();
        const bool of_mouse =
            std::holds_alternative<ButtonEvent>(event) || std::holds_alternative<ScrollEvent>(event);
        if (!(of_mouse && gui_.has_mouse() && !button_)) {
            act_on(event);
        }
        settle();
    }

    void act_on(const Event& event) {
        std::visit(Overloaded{[this](const CursorEvent& e) { on_cursor(e); },
                              [this](const ButtonEvent& e) { on_button(e); },
                              [this](const ScrollEvent& e) { on_scroll(e); },
                              [this](const KeyEvent& e) { on_key(e); },
                              [this](const RefreshEvent&) { picture_changed_ = lost_ = true; },
                              [this](const CloseEvent&) { closing_ = true; }},
                   event);
    }

    /// On the screen as OrbitCamera wants it: heights of the picture, from its centre, y upwards.
    [[nodiscard]] Point on_screen(Point pixel) const {
        const auto size = view_size();
        const double height = std::max(size[1], 1U);
        return {(pixel.x - 0.5 * size[0]) / height, 0.5 - pixel.y / height};
    }

    /// Pixels of the window that show the scene, from its upper left.
    [[nodiscard]] std::array<std::uint32_t, 2> view_size() const {
        const auto size = window_.size();
        return {size[0] - panel_width(size, choices_.panel), size[1]};
    }

    [[nodiscard]] double aspect() const {
        const auto size = view_size();
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
        const double way = std::hypot(cursor_.x - pressed_at_.x, cursor_.y - pressed_at_.y);
        dragging_ = dragging_ || way >= click_way;
        if (!dragging_) {
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
                if (!dragging_ && event.button == Button::left && !panning_) {
                    pick(cursor_);
                }
            }
            return;
        }
        button_ = event.button;
        panning_ = event.button == Button::middle || (event.button == Button::left && event.shift);
        pressed_at_ = cursor_;
        dragging_ = false;
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
        button_.reset();
        if (apply_camera_key(event.key, aspect(), orbit_)) {
            picture_changed_ = true;
        } else if (!apply_look_key(event, input_, choices_)) {
            other_key(event);
        }
    }

    void other_key(const KeyEvent& event) {
        if (event.key == 'P') {
            numbered_screenshot(event.shift);
        } else if (event.key == tab_key) {
            choices_.panel = !choices_.panel;
            picture_changed_ = true;
        } else if (event.key == 'C') {
            choices_.hemicube = !choices_.hemicube;
        } else if (event.key == help_key) {
            choices_.help = !choices_.help;
        } else if (event.key == escape_key && choices_.help) {
            choices_.help = false;
        } else if (event.key == escape_key && choices_.picked) {
            choices_.picked.reset();
        } else if (event.key == 'Q' || event.key == escape_key) {
            closing_ = true;
        }
    }

    void pick(Point pixel) {
        const auto size = view_size();
        if (!(pixel.x >= 0.0 && pixel.x < size[0] && pixel.y >= 0.0 && pixel.y < size[1])) {
            return;
        }
        choices_.picked = renderer_.item(orbit_.camera(), settings(size), static_cast<std::uint32_t>(pixel.x),
                                         static_cast<std::uint32_t>(pixel.y));
    }

    void moved() {
        picture_changed_ = true;
        moving_ = true;
    }

    /// After radiosity has changed.
    void prepare_light() {
        light_mesh_ =
            make_picture_mesh(*input_.mesh, input_.channels, light_.radiosity, input_.blocked, input_.show);
        light_mesh_.environment = input_.environment;
        shown_look_.reset();
    }

    void prepare_factors() {
        without_rows_ = without_rows(input_);
        if (input_.factors == nullptr) {
            return;
        }
        usual_factor_ = usual_largest_factor(*input_.factors);
        relighter_.emplace(input_, Window::wake);
    }

    void choose_exposure() {
        if (input_.automatic_exposure) {
            exposure_ = automatic_exposure(*input_.mesh, light_mesh_, input_.blocked, input_.exitance,
                                           input_.channels);
        }
    }

    /// How far the solution is, and the solution once it is there.
    void take_solution() {
        if (!solver_) {
            return;
        }
        if (choices_.cancel) {
            solver_->cancel();
        }
        solving_ = solver_->status(solved_share_);
        if (!solver_->finished()) {
            return;
        }
        std::optional<Solved> solved = solver_->take();
        solver_.reset();
        solving_.clear();
        choices_.cancel = false;
        if (!solved) {
            stop_if_interrupted();
            relit_ = "stopped: this is the light of the lamps alone";
            return;
        }
        input_.factors = std::move(solved->factors);
        input_.row_sum = std::move(solved->row_sum);
        input_.environment_share = std::move(solved->environment_share);
        input_.blocked = std::move(solved->blocked);
        light_.radiosity = std::move(solved->radiosity);
        lamps_only_ = false;
        prepare_factors();
        prepare_light();
        choose_exposure();
        settle();
    }

    /// What the relighter has found, on the screen.
    void take_light() {
        std::optional<Relit> relit = relighter_ ? relighter_->take() : std::nullopt;
        if (!relit) {
            return;
        }
        relit_ = relit->problem.empty()
                     ? fmt::format("solved in {:.2f} s, {} sweeps", relit->seconds, relit->sweeps)
                     : "no solution: " + relit->problem;
        if (relit->problem.empty()) {
            light_ = std::move(relit->light);
            prepare_light();
            settle();
        }
    }

    /// Brings what hangs on the choices in line with them.
    void settle() {
        if (why_not(choices_.look.quantity, input_, choices_.picked) != nullptr) {
            choices_.look.quantity = Quantity::picture;
        }
        if (relighter_ && choices_.materials != asked_materials_) {
            asked_materials_ = choices_.materials;
            relighter_->ask({of_patches(asked_materials_, *input_.mesh, &Material::reflectance),
                             of_patches(asked_materials_, *input_.mesh, &Material::exitance),
                             light_.radiosity});
        }
        const bool other_patch = shown_pick_ != choices_.picked;
        const bool other_look = shown_look_ != choices_.look;
        const HemicubeChoice hemicube{choices_.hemicube, choices_.hemicube_ids, choices_.hemicube_eye};
        const bool other_hemicube = shown_hemicube_ != hemicube;
        const bool other_order = shown_by_light_ != choices_.partners_by_light;
        if (!other_patch && !other_look && !other_order && !other_hemicube) {
            return;
        }
        const Quantity quantity = choices_.look.quantity;
        const bool of_patch = quantity == Quantity::row || quantity == Quantity::column;
        if (other_look || (other_patch && of_patch)) {
            show();
        }
        picked_.reset();
        if (choices_.picked) {
            picked_ = PickedPatch{*choices_.picked, {}};
            if (input_.factors != nullptr) {
                picked_->partners =
                    largest_partners(input_, light_, *choices_.picked, quantity == Quantity::column,
                                     choices_.partners_by_light, partner_count);
            }
        }
        if (other_patch) {
            choices_.hemicube_eye = 0;
        }
        shown_pick_ = choices_.picked;
        shown_look_ = choices_.look;
        shown_by_light_ = choices_.partners_by_light;
        shown_hemicube_ = {choices_.hemicube, choices_.hemicube_ids, choices_.hemicube_eye};
        draw_hemicube();
        update_title();
    }

    /// Puts the quantity that was chosen on the scene.
    void show() {
        colours_.clear();
        field_ = make_field(choices_.look, input_, light_, choices_.picked, usual_factor_);
        if (field_) {
            colours_ = field_colours(*field_, *input_.mesh);
        } else if (choices_.look.quantity == Quantity::items) {
            colours_ = item_colours(*input_.mesh);
        } else if (choices_.look.quantity == Quantity::outlines) {
            colours_ = plain_colours(*input_.mesh);
        }
        if (lamps_only_ && choices_.look.quantity == Quantity::picture) {
            colours_ = lamp_colours(*input_.mesh, light_mesh_, exposure(), choices_.look.tone_mapping);
        }
        renderer_.upload(colours_.empty() ? light_mesh_ : painted(light_mesh_, colours_));
        picture_changed_ = true;
    }

    /// The picked patch's hemicube, where it is wanted and there is room for it.
    void draw_hemicube() {
        if (!choices_.hemicube || !choices_.picked || panel_width(window_.size(), choices_.panel) == 0) {
            return;
        }
        if (!inset_) {
            inset_.emplace(*input_.mesh, input_.hemicube, window_);
        }
        inset_->look(*choices_.picked, choices_.hemicube_eye);
        inset_->paint(choices_.hemicube_ids ? item_colours(*input_.mesh)
                      : colours_.empty() ? light_colours(light_mesh_, exposure(), choices_.look.tone_mapping)
                                         : colours_);
    }

    [[nodiscard]] double exposure() const { return exposure_ * std::exp2(choices_.look.stops); }

    [[nodiscard]] PictureSettings settings(std::array<std::uint32_t, 2> size) const {
        Look look = choices_.look;
        if (lamps_only_ && look.quantity == Quantity::picture) {
            look.quantity = Quantity::items; // as other colours that are painted
        }
        return picture_settings(look, input_.picture, exposure(), size);
    }

    void update_title() {
        const std::string title = fmt::format(
            "{} - exposure {:.3g}, {} - {}", input_.title, exposure(),
            choices_.look.tone_mapping == ToneMapping::filmic ? "filmic" : "linear", window_.renderer());
        if (title != title_) {
            title_ = title;
            window_.set_title(title);
        }
    }

    void describe_panels() {
        const auto size = window_.size();
        const auto view = view_size();
        gui_.begin({std::max(size[0], 1U), std::max(size[1], 1U)});
        if (view[0] < size[0]) {
            const PanelContent content{input_, light_,   picked_,       status_,
                                       relit_, solving_, solved_share_, without_rows_};
            side_panel(content, size, choices_);
        }
        if (view[0] > 0 && view[1] > 0) {
            if (choices_.pointed_at) {
                mark_patch(*input_.mesh, *choices_.pointed_at, orbit_, view, false);
            }
            if (choices_.picked) {
                mark_patch(*input_.mesh, *choices_.picked, orbit_, view, true);
            }
            if (field_) {
                legend(*field_, view);
            }
            if (inset_ && choices_.hemicube && choices_.picked && view[0] < size[0]) {
                hemicube_window(inset_->picture(), view, choices_);
            }
            if (choices_.help) {
                help_window(view, choices_.help);
            }
        }
        gui_.end();
    }

    /// Draws what has changed.
    void draw(bool preview) {
        const auto view = view_size();
        const auto size = window_.size();
        if (view[0] == 0 || view[1] == 0) {
            return;
        }
        if (picture_changed_ || target_.size() != view) {
            draw_picture(target_, view, preview);
            picture_changed_ = false;
            lost_ = true;
        }
        // Twice, since a frame may learn from the one before how large its text is.
        describe_panels();
        describe_panels();
        settle();
        if (!lost_ && !gui_.changed()) {
            return;
        }
        target_.copy_to(0, size[1]);
        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
        gui_.draw();
        gl::check_errors("drawing the window");
        window_.swap();
        lost_ = false;
    }

    void draw_picture(SceneTarget& target, std::array<std::uint32_t, 2> size, bool preview) {
        const auto start = std::chrono::steady_clock::now();
        PictureSettings drawn = settings(size);
        drawn.samples = preview ? 1 : drawn.samples;
        target.resize(size);
        renderer_.draw(orbit_.camera(), drawn, target.framebuffer());
        glFinish();
        const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
        status_ = fmt::format("{} patches, {:.0f} ms a picture{}", input_.mesh->size(), time.count(),
                              preview ? " (preview)" : "");
    }

    void screenshot(const std::filesystem::path& path) {
        const Picture picture = renderer_.picture(orbit_.camera(), settings(window_.size()));
        if (path.extension() == ".hdr") {
            io::write_hdr(path, picture.width, picture.height, picture.linear);
        } else {
            io::write_png(path, picture.width, picture.height, picture.srgb);
        }
        std::fprintf(stderr, "%s\n", path.string().c_str());
    }

    /// The window in full quality, panels included.
    void windowshot(const std::filesystem::path& path) {
        const auto size = window_.size();
        const auto view = view_size();
        if (view[0] == 0 || view[1] == 0) {
            return;
        }
        SceneTarget picture;
        draw_picture(picture, view, false);
        describe_panels();
        describe_panels();
        SceneTarget whole;
        whole.resize(size);
        picture.copy_to(whole.framebuffer(), size[1]);
        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, whole.framebuffer());
        gui_.draw();
        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
        gl::check_errors("drawing the window");
        lost_ = true;
        io::write_png(path, size[0], size[1], whole.pixels());
        std::fprintf(stderr, "%s\n", path.string().c_str());
    }

    /// Under the first free number; a folder that cannot be written to is no reason to close the window.
    void numbered_screenshot(bool of_window) {
        const std::filesystem::path path = free_name(input_.file_stem);
        try {
            if (of_window) {
                windowshot(path);
            } else {
                screenshot(path);
            }
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
    void perform(const ClickCommand& click) {
        handle(CursorEvent{click.x, click.y});
        handle(ButtonEvent{Button::left, true, false});
        handle(ButtonEvent{Button::left, false, false});
    }
    void perform(const MoveCommand& move) { handle(CursorEvent{move.x, move.y}); }
    void perform(const ShowCommand& show) {
        const Quantity quantity = quantity_by_word(show.quantity).value_or(Quantity::picture);
        if (const char* problem = why_not(quantity, input_, choices_.picked)) {
            throw InvalidArgument(fmt::format("show {}: {}", show.quantity, problem));
        }
        choices_.look.quantity = quantity;
        settle();
    }
    void perform(const SetCommand& set) {
        apply_set(set, input_, choices_);
        settle();
        while (relighter_->busy()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            take_light();
        }
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
        picture_changed_ = true;
    }
    void perform(const WindowshotCommand& command) { windowshot(command.path); }
    void perform(const ReportCommand& command) {
        write_report(
            command.path,
            {input_, light_, choices_, field_, picked_,
             inset_ && choices_.picked && choices_.hemicube ? inset_->seen() : std::vector<std::uint32_t>()});
    }
    void perform(const ScreenshotCommand& command) { screenshot(command.path); }
    void perform(const LiveCommand&) {}
    void perform(const WaitCommand&) { wait_for_solution(); }
    void perform(const CancelCommand&) {
        choices_.cancel = true;
        wait_for_solution();
    }
    void perform(const QuitCommand&) { closing_ = true; }

    ViewerInput input_;
    Window window_; // before everything that lives in its context
    PictureRenderer renderer_;
    SceneTarget target_;
    Gui gui_;
    std::optional<HemicubeInset> inset_; ///< made when it is first needed
    OrbitCamera orbit_;
    Choices choices_;
    Light light_;
    PictureMesh light_mesh_;
    double exposure_ = 1.0; ///< where stops count from
    double usual_factor_ = 0.0;

    // What the screen shows: follows the choices, see settle().
    std::optional<Look> shown_look_;
    std::optional<std::uint32_t> shown_pick_;
    bool shown_by_light_ = false;
    HemicubeChoice shown_hemicube_;
    std::vector<std::array<float, 3>> colours_; ///< of the patches, display linear; empty: light
    std::optional<Field> field_;
    std::optional<PickedPatch> picked_;
    std::string status_;
    std::string relit_;
    std::string solving_;
    double solved_share_ = 0.0;
    bool lamps_only_; ///< there is no solution yet
    std::vector<Material> asked_materials_;
    std::vector<bool> without_rows_; ///< by material
    std::string title_;

    Point cursor_{0.0, 0.0};
    Point pressed_at_{0.0, 0.0};
    std::optional<Button> button_;
    bool panning_ = false;
    bool dragging_ = false;
    bool moving_ = false;
    bool picture_changed_ = true;
    bool lost_ = true; ///< what the window holds is not what was drawn last
    bool closing_ = false;

    std::optional<Relighter> relighter_; ///< where there are form factors
    std::optional<LiveSolver> solver_;   ///< while it is at work
};

} // namespace

int run_viewer(const ViewerInput& input) {
    if (input.mesh == nullptr || input.scene == nullptr) {
        throw InvalidArgument("viewer: no scene");
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
