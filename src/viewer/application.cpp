#include "viewer/application.hpp"

#include "hemi/pipeline/settings.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/core/text.hpp"
#include "viewer/dots.hpp"
#include "viewer/gauges.hpp"
#include "viewer/keys.hpp"
#include "viewer/legend_window.hpp"
#include "viewer/material_change.hpp"
#include "viewer/measure.hpp"
#include "viewer/overlays.hpp"
#include "viewer/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

namespace hemi::viewer {

namespace {

/// Lines in the list of partners.
constexpr std::size_t partner_count = 8;
/// A picture that does not change for so long is drawn in full quality.
constexpr std::chrono::milliseconds rest{200};
/// Rows that have come are put on the picture no more often than this, and so that it takes no more than a
/// part of the time that they take.
constexpr std::chrono::milliseconds gather_interval{100};
constexpr int gather_part = 20;
/// One step of a walk, in scene diagonals.
constexpr double walk_share = 0.01;

} // namespace

Application::Application(ViewerInput input, const ViewerSettings& settings)
    : settings_(settings), window_(input.title(), input.picture.width, input.picture.height),
      gui_(window_.scale(), settings.script.empty()), navigator_(settings.controls, input.mesh, input.camera),
      opener_(settings.open, Window::wake) {
    choices_.look.shading = input.picture.shading;
    choices_.look.tone_mapping = input.picture.tone_mapping;
    choices_.look.outlines = input.picture.outlines;
    choices_.look.backs = input.picture.backs;
    choices_.samples = input.picture.samples;
    choices_.cut = input.picture.cut;
    exchange(std::move(input));
}

void Application::run() {
    while (!closing_) {
        draw();
        moving_ = navigator_.dragging();
        const bool settles = rough_ && !navigator_.holds();
        const std::chrono::duration<double> until_rest = rests_at_ - Clock::now();
        const std::vector<Event> events = window_.wait(settles ? std::max(until_rest.count(), 0.001) : 0.0);
        for (std::size_t k = 0; k < events.size() && !closing_; ++k) {
            // Of cursor moves in a row only the last counts.
            const bool passed = std::holds_alternative<CursorEvent>(events[k]) && k + 1 < events.size() &&
                                std::holds_alternative<CursorEvent>(events[k + 1]);
            if (!passed) {
                handle(events[k]);
            }
        }
        attempt([this] { update(); });
        stop_if_interrupted();
        if (watch_->take()) {
            open(document_->input().file);
        }
        picture_changed_ = picture_changed_ || (settles && !moving_ && Clock::now() >= rests_at_);
    }
}

void Application::watch(double seconds) {
    for (const Event& event : seconds > 0.0 ? window_.wait(seconds) : window_.poll()) {
        if (std::holds_alternative<CloseEvent>(event)) {
            close(); // nobody could answer a question
        } else if (std::holds_alternative<RefreshEvent>(event)) {
            handle(event);
        }
    }
}

void Application::wait_for_work(const std::function<bool()>& enough) {
    update();
    while (!closing_ && (opener_.busy() || document_->busy()) && !(enough && enough())) {
        draw();
        watch(0.05);
        update();
    }
}

/// The panels see every event first; a drag that began in the view stays the view's.
void Application::handle(const Event& event) {
    const bool typed = gui_.has_keyboard() &&
                       (std::holds_alternative<KeyEvent>(event) || std::holds_alternative<TextEvent>(event));
    gui_.feed(event);
    describe_panels();
    if (typed) {
        describe_panels(); // without the key, which may be pressed again
        grant_wishes();
        settle();
        return;
    }
    const bool of_mouse =
        std::holds_alternative<ButtonEvent>(event) || std::holds_alternative<ScrollEvent>(event);
    if (!(of_mouse && gui_.has_mouse() && !navigator_.holds())) {
        act_on(event);
    }
    grant_wishes();
    settle();
}

void Application::act_on(const Event& event) {
    std::visit(Overloaded{[this](const CursorEvent& e) {
                              if (navigator_.on_cursor(e)) {
                                  moved();
                              }
                          },
                          [this](const ButtonEvent& e) {
                              if (const auto pixel = navigator_.on_button(e)) {
                                  pick(*pixel);
                              }
                          },
                          [this](const ScrollEvent& e) {
                              if (navigator_.on_scroll(e)) {
                                  moved();
                              }
                          },
                          [this](const KeyEvent& e) { on_key(e); }, [](const TextEvent&) {},
                          [this](const RefreshEvent&) { refresh(); },
                          [this](const CloseEvent&) { ask_to_close(); },
                          [this](const DropEvent& e) { open(e.path); }},
               event);
    look_under_cursor();
}

void Application::on_key(const KeyEvent& event) {
    navigator_.let_go();
    const int number = event.key >= '1' && event.key <= '9' ? event.key - '0' : 0;
    if (event.control) {
        if (event.key == 'Z') {
            undo_or_redo(event.shift);
        } else if (number > 0) {
            attempt([this, number] { keep_camera(number); });
        }
    } else if (event.alt) {
        if (number > 0) {
            go_to_camera(number);
        }
    } else if (choices_.walking &&
               apply_walk_key(event, walk_share * document_->input().mesh->bounds().diagonal(),
                              navigator_.orbit())) {
        moved();
    } else if (apply_camera_key(event, navigator_.aspect(), navigator_.orbit())) {
        picture_changed_ = true;
    } else if (!apply_look_key(event, document_->input(), choices_)) {
        other_key(event);
    }
}

void Application::other_key(const KeyEvent& event) {
    Wishes& wishes = choices_.wishes;
    if (event.key == 'P') {
        numbered_screenshot(event.shift);
    } else if (event.key == 'X') {
        wishes.copy_command = true;
    } else if (event.key == 'G') {
        (event.shift ? wishes.run_on : wishes.step) = true;
    } else if (event.key == reload_key) {
        wishes.reload = true;
    } else if (event.key == tab_key) {
        choices_.panel = !choices_.panel;
        picture_changed_ = true;
    } else if (event.key == 'A' || event.key == 'I' || event.key == 'N' || event.key == 'O') {
        on_group_key(event.key);
    } else if (event.key == 'K') {
        clip_by_key(event.shift);
    } else if (event.key == 'D') {
        choices_.measuring = !choices_.measuring;
    } else if (event.key == 'J') {
        choices_.walking = !choices_.walking;
    } else if (event.key == 'U') {
        choices_.gauges = !choices_.gauges;
    } else if (event.key == 'C') {
        choices_.hemicube = !choices_.hemicube;
    } else if (event.key == help_key) {
        choices_.help = !choices_.help;
    } else if (event.key == escape_key && gui_.close_list()) {
        return;
    } else if (event.key == escape_key && choices_.asks_to_write) {
        choices_.asks_to_write = false;
    } else if (event.key == escape_key && asks_to_close_) {
        asks_to_close_ = false;
    } else if (event.key == escape_key && choices_.help) {
        choices_.help = false;
    } else if (event.key == escape_key && !message_.empty()) {
        message_.clear();
    } else if (event.key == escape_key && choices_.measuring) {
        choices_.measuring = false;
    } else if (event.key == escape_key && choices_.walking) {
        choices_.walking = false;
    } else if (event.key == escape_key && (choices_.picked || choices_.group)) {
        choices_.picked.reset();
        choices_.group.reset();
    } else if (event.key == 'Q') {
        ask_to_close();
    }
}

void Application::undo_or_redo(bool redo) {
    const MaterialHistory::State& state = redo ? history_->redo() : history_->undo();
    if (state != MaterialHistory::State{choices_.materials, choices_.conditions, choices_.environment}) {
        saved_result_.clear(); // it is of other light
    }
    choices_.materials = state.materials;
    choices_.conditions = state.conditions;
    choices_.environment = state.environment;
}

void Application::ask_to_close() {
    const auto view = view_size();
    const bool seen = view[0] > 0 && view[1] > 0; // nobody would see the question else
    closing_ = asks_to_close_ || !seen || unsaved().empty();
    asks_to_close_ = true;
}

std::string Application::unsaved() const {
    if (!saved_result_.empty()) {
        return {};
    }
    if (!document_->as_opened()) {
        return "Materials, temperatures or the environment were changed, and are not saved.";
    }
    const Clock::duration worked =
        worked_ + (works_since_ ? Clock::now() - *works_since_ : Clock::duration{0});
    const bool savable = document_->unsavable_reason() == nullptr;
    if (worked > long_work_ && (savable || works_since_)) {
        return fmt::format("{} of work are lost: the light is not {}.",
                           seconds_text(std::chrono::duration<double>(worked).count()),
                           savable ? "saved" : "found yet");
    }
    return {};
}

void Application::attempt(const std::function<void()>& action) {
    try {
        action();
    } catch (const Cancelled&) {
        throw;
    } catch (const GlError&) {
        throw;
    } catch (const Error& error) {
        message_ = error.what();
        std::fprintf(stderr, "%s\n", error.what());
    }
}

/// Does what buttons in the panel have asked for.
void Application::grant_wishes() {
    const Wishes wishes = std::exchange(choices_.wishes, {});
    if (wishes.cancel) {
        document_->cancel();
    }
    if (wishes.start_over) {
        document_->start_over();
    }
    if (wishes.step) {
        document_->step();
    }
    if (wishes.run_on) {
        document_->run_on();
    }
    if (wishes.camera_key) {
        on_key({*wishes.camera_key, false});
    }
    if (wishes.fov) {
        navigator_.orbit().set_fov(*wishes.fov);
        moved();
    }
    if (wishes.orthographic) {
        navigator_.orbit().set_orthographic(*wishes.orthographic);
        picture_changed_ = true;
    }
    if (wishes.screenshot) {
        numbered_screenshot(false);
    }
    if (wishes.save_result) {
        attempt([this] { save_result(free_name(document_->input().file.stem().string(), ".hres")); });
    }
    if (wishes.save_probe) {
        attempt([this] { save_probe(free_name(document_->input().file.stem().string(), ".csv")); });
    }
    if (wishes.bookmark) {
        go_to_camera(*wishes.bookmark);
    }
    if (wishes.save_camera) {
        attempt([this] { save_camera(); });
    }
    if (wishes.save_materials) {
        attempt([this] { save_materials(); });
    }
    if (wishes.copy_command) {
        attempt([this] {
            const std::string command = command_line();
            window_.copy_text(command);
            note_ = "command line copied";
            std::fprintf(stderr, "%s\n", command.c_str());
        });
    }
    if (wishes.reload) {
        open(document_->input().file);
    }
    if (wishes.check) {
        document_->look_for_findings();
    }
    if (document_->input().compared && (wishes.open_compared || wishes.leave_compared)) {
        open_alone(wishes.open_compared ? document_->input().compared->file : document_->input().file);
    }
    if (wishes.go_to_patch) {
        go_to_patch(*wishes.go_to_patch);
    }
    if (wishes.save_and_close) {
        attempt([this] {
            save_result(free_name(document_->input().file.stem().string(), ".hres"));
            close();
        });
        asks_to_close_ = false;
    }
    closing_ = closing_ || wishes.close;
    asks_to_close_ = asks_to_close_ && !wishes.stay;
}

void Application::pick(std::array<double, 2> pixel) {
    const auto size = view_size();
    if (choices_.measuring) {
        if (const auto point = navigator_.surface_under_cursor(choices_.look.backs)) {
            if (choices_.measured.size() > 1) {
                choices_.measured.clear();
            }
            choices_.measured.push_back(point->position);
        }
        return;
    }
    if (pixel[0] >= 0.0 && pixel[0] < size[0] && pixel[1] >= 0.0 && pixel[1] < size[1]) {
        choices_.picked = view_.item(navigator_.camera(), size, static_cast<std::uint32_t>(pixel[0]),
                                     static_cast<std::uint32_t>(pixel[1]));
        choices_.group.reset(); // that of the patch is taken in settle()
    }
}

void Application::moved() {
    picture_changed_ = true;
    moving_ = true;
}

void Application::update() {
    take_opened();
    if (std::optional<ViewerInput> finer = document_->take_refined()) {
        exchange(std::move(*finer));
    }
    if (document_->take_findings()) {
        shown_look_.reset();
        settle();
    }
    const Clock::time_point now = Clock::now();
    if (document_->busy()) {
        works_since_ = works_since_.value_or(now);
    } else if (works_since_) {
        worked_ += now - *std::exchange(works_since_, std::nullopt);
    }
    if (document_->update(now >= gathers_at_)) {
        took_light_ = took_light_.value_or(now);
        moving_ = moving_ || document_->busy();
        saved_result_.clear();
        note_.clear();
        shown_look_.reset();
        settle();
    }
}

std::uint32_t Application::panel_pixels() const {
    return gui_.pixels(panel_width(gui_.layout(window_.size()), choices_.panel));
}

std::array<std::uint32_t, 2> Application::view_size() const {
    const auto size = window_.size();
    return {size[0] - panel_pixels(), size[1]};
}

void Application::settle() {
    const ViewerInput& input = document_->input();
    navigator_.set_view(view_size());
    navigator_.set_walking(choices_.walking);
    settle_cut();
    settle_probe();
    if (why_not(choices_.look.shown, input, choices_.picked) != nullptr) {
        choices_.look.shown = {};
    }
    if (why_no_difference(choices_.look.shown, input) != nullptr &&
        choices_.look.shown.view == View::quantity) {
        choices_.look.difference = false;
    }
    if (shown_look_ &&
        (shown_look_->shown != choices_.look.shown || shown_look_->difference != choices_.look.difference)) {
        choices_.look.range.reset(); // it was of another quantity
    }
    if (choices_.look.shown.view == View::findings) {
        document_->look_for_findings();
    }
    const MaterialHistory::State wanted{choices_.materials, choices_.conditions, choices_.environment};
    document_->set_materials(wanted);
    if (!gui_.holds() && history_->note(wanted)) {
        saved_result_.clear(); // it is of other light
    }
    const bool other_patch = shown_pick_ != choices_.picked;
    const bool other_look = shown_look_ != choices_.look;
    const HemicubeChoice hemicube{choices_.hemicube, choices_.hemicube_ids, choices_.hemicube_eye};
    const bool other_hemicube = shown_hemicube_ != hemicube;
    const bool other_order = shown_by_light_ != choices_.partners_by_light;
    if (!other_patch && !other_look && !other_order && !other_hemicube) {
        return;
    }
    const View shown = choices_.look.shown.view;
    const bool of_patch = shown == View::row || shown == View::column;
    if (other_look || (other_patch && of_patch)) {
        while (true) {
            try {
                view_.show(*document_, choices_.look, choices_.picked);
                break;
            } catch (const InvalidArgument& error) { // such a range or a difference, for example
                message_ = error.what();
                Look& look = choices_.look;
                if (look.range || look.logarithmic) {
                    look.range.reset();
                    look.logarithmic = false;
                } else if (look.difference) {
                    look.difference = false;
                } else {
                    throw;
                }
            }
        }
        values_ = shown_values(*document_, choices_.look, view_.field());
        groups_ = group_table(*document_, values_);
        constexpr std::size_t histogram_steps = 64;
        histogram_ = view_.field() ? area_histogram(*view_.field(), *input.mesh, histogram_steps)
                                   : std::vector<double>();
        picture_changed_ = true;
    }
    picked_.reset();
    if (choices_.picked) {
        picked_ = PickedPatch{*choices_.picked, {}};
        if (input.factors != nullptr) {
            picked_->partners =
                largest_partners(input, document_->light(), *choices_.picked, shown == View::column,
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

/// The picked patch's hemicube, where it is wanted and there is room for it.
void Application::draw_hemicube() {
    if (!choices_.hemicube || !choices_.picked || panel_pixels() == 0) {
        return;
    }
    const ViewerInput& input = document_->input();
    if (!inset_) {
        inset_.emplace(
            *input.mesh,
            plan_rows(input.factor_settings.value_or(FactorSettings{}), input.mesh->size()).hemicube,
            window_);
    }
    inset_->look(*choices_.picked, choices_.hemicube_eye);
    inset_->paint(choices_.hemicube_ids ? item_colours(*input.mesh) : view_.colours(),
                  choices_.hemicube_ids ? std::nullopt : view_.environment_colour());
}

void Application::update_title() {
    const std::string title = fmt::format(
        "{} - {}exposure {:.3g}, {} - {}", document_->input().title(),
        document_->evenly_lit() ? "no light: shown evenly lit, " : "",
        document_->exposure() * std::exp2(choices_.look.stops),
        choices_.look.tone_mapping == ToneMapping::filmic ? "filmic" : "linear", window_.renderer());
    if (title != title_) {
        title_ = title;
        window_.set_title(title);
    }
}

void Application::describe_panels() {
    const auto pixels = window_.size();
    const auto size = gui_.layout(pixels);
    const auto view = gui_.layout(view_size());
    const PatchMesh& mesh = *document_->input().mesh;
    gui_.begin({std::max(pixels[0], 1U), std::max(pixels[1], 1U)});
    if (view[0] < size[0]) {
        side_panel({*document_, picked_, navigator_.camera(), bookmarks_, groups_, view_.field(), note_,
                    status_, words_under_cursor()},
                   size, choices_);
    }
    if (view[0] > 0 && view[1] > 0) {
        if (choices_.pointed_at) {
            mark_patch(mesh, *choices_.pointed_at, navigator_.orbit(), view, false);
        }
        if (!choices_.picked) {
            mark_edges(group_edges_, navigator_.orbit(), view);
        } else {
            mark_patch(mesh, *choices_.picked, navigator_.orbit(), view, true);
        }
        if (view_.field()) {
            legend_window(*view_.field(), histogram_, view, choices_);
        } else if (choices_.look.shown.view == View::findings) {
            findings_legend(document_->findings(), view);
        }
        if (choices_.gauges && view[0] < size[0]) {
            gauges(*document_->input().scene, navigator_.orbit(), view, view_.field().has_value());
        }
        if (choices_.measuring) {
            mark_line(choices_.measured, navigator_.orbit(), view);
            measure_window(*document_->input().scene, probe_, values_, view, choices_);
        }
        if (hides_backs_) {
            backs_note(view);
        }
        dots_overlay(view_, document_->input(), choices_.look, dot_under_cursor_,
                     {navigator_.cursor()[0] * view[0] / view_size()[0],
                      navigator_.cursor()[1] * view[1] / view_size()[1]},
                     view);
        if (inset_ && choices_.hemicube && choices_.picked && view[0] < size[0]) {
            hemicube_window(inset_->picture(), view, choices_);
        }
        if (choices_.help) {
            help_window(view, settings_.controls, choices_.help);
        }
        asks_to_close_ = asks_to_close_ && !unsaved().empty();
        if (asks_to_close_) {
            close_question(unsaved(), document_->unsavable_reason() == nullptr, view, choices_.wishes);
        }
        if (choices_.asks_to_write) {
            const std::string words = changed_materials(*document_->input().scene, choices_).words;
            choices_.asks_to_write = !words.empty();
            if (choices_.asks_to_write) {
                write_question(words, document_->input().file.filename().string(), view, choices_);
            }
        }
        bool open = true;
        if (!message_.empty()) {
            message_window(message_, view, open);
        }
        if (!open) {
            message_.clear();
        }
    }
    gui_.end();
}

/// After light that came in was drawn, or put on a scene that is not to be seen.
void Application::pace_gathering() {
    if (!took_light_) {
        return;
    }
    const Clock::time_point now = Clock::now();
    gathers_at_ = now + std::max<Clock::duration>(gather_interval, gather_part * (now - *took_light_));
    took_light_.reset();
}

void Application::draw() {
    const auto view = view_size();
    const auto size = window_.size();
    if (view[0] == 0 || view[1] == 0) {
        pace_gathering();
        return;
    }
    navigator_.set_view(view);
    if (picture_changed_ || target_.size() != view) {
        rough_ = window_.software() && (moving_ || !settings_.script.empty());
        draw_picture(target_, view, rough_);
        picture_changed_ = false;
        if (!(window_.software() && navigator_.dragging())) {
            hides_backs_ = navigator_.camera().orthographic && !choices_.look.backs &&
                           view_.hides_backs(navigator_.camera(), view);
        }
        lost_ = true;
        pace_gathering();
        rests_at_ = (document_->gathering() ? std::max(gathers_at_, Clock::now()) : Clock::now()) + rest;
    }
    // Twice, since a frame may learn from the one before how large its text is.
    describe_panels();
    describe_panels();
    grant_wishes();
    settle();
    gl::check_errors("preparing the window");
    if (picture_changed_) { // by a button: once more
        Window::wake();
    }
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

void Application::draw_picture(SceneTarget& target, std::array<std::uint32_t, 2> size, bool preview) {
    const auto start = std::chrono::steady_clock::now();
    target.resize(size);
    view_.draw(navigator_.camera(), target, preview ? 1 : document_->input().picture.samples);
    glFinish();
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    status_ =
        fmt::format("{}, {:.0f} ms a picture{}", plural(document_->input().mesh->size(), "patch", "patches"),
                    time.count(), preview ? " (preview)" : "");
}

/// Under the first free number; a folder that cannot be written to is no reason to close the window.
void Application::numbered_screenshot(bool of_window) {
    const std::filesystem::path path = free_name(document_->input().file.stem().string(), ".png");
    attempt([&] {
        if (of_window) {
            windowshot(path);
            return;
        }
        const PictureSize& chosen = picture_sizes()[choices_.picture_size];
        const auto view = view_size();
        const std::array<std::uint32_t, 2> size =
            chosen.width == 0 ? std::array{view[0] * chosen.scale, view[1] * chosen.scale}
                              : std::array{chosen.width, chosen.height};
        screenshot(path, size, choices_.samples);
    });
}

} // namespace hemi::viewer
