#include "viewer/application.hpp"

#include "viewer/dots.hpp"
#include "viewer/groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

// What the window opens.

namespace hemi::viewer {

namespace {

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code error;
    return a == b || std::filesystem::equivalent(a, b, error);
}

std::filesystem::path file_compared(const ViewerInput& input) {
    return input.compared ? input.compared->file : std::filesystem::path();
}

/// Whether a scene that was read again has what the states of its materials are of.
bool has_same_materials(const Scene& before, const Scene& now) {
    return before.channels == now.channels &&
           std::equal(before.materials.begin(), before.materials.end(), now.materials.begin(),
                      now.materials.end(),
                      [](const Material& a, const Material& b) { return a.name == b.name; });
}

} // namespace

/// Another scene, or the same one after a change.
void Application::exchange(ViewerInput input) {
    const bool again = document_ && same_file(document_->input().file, input.file);
    const bool same_patches =
        document_ && document_->input().mesh->geometry_hash() == input.mesh->geometry_hash();
    if (again) {
        navigator_.exchange(input.mesh, input.camera);
    } else {
        navigator_ = Navigator(settings_.controls, input.mesh, input.camera);
        watch_.emplace(input.file, Window::wake);
    }
    if (!again || !same_patches) {
        choices_.picked.reset();
    }
    if (document_ && !again) {
        choices_.cut = {};
        choices_.group.reset();
        choices_.group_search.fill('\0');
    } else if (document_ && document_->input().mesh->groups() != input.mesh->groups()) {
        choose_groups_again(choices_, document_->input().mesh->groups(), input.mesh->groups());
    }
    compare_with(input, again);
    const bool goes_on =
        again && has_same_materials(*document_->input().scene, *input.scene) &&
        choices_.conditions.size() == (input.heat ? input.heat->conditions.size() : std::size_t{0});
    shown_group_.reset();
    choices_.measured.clear();
    probe_.reset();
    hides_backs_ = false;
    choices_.pointed_at.reset();
    choices_.materials = input.scene->materials;
    choices_.conditions = input.heat ? input.heat->conditions : std::vector<HeatCondition>();
    inset_.reset();
    under_cursor_.reset();
    dot_under_cursor_.reset();
    choices_.look.dots_column =
        document_ ? column_again(document_->input(), input, choices_.look.dots_column) : input.dots_column;
    asks_to_close_ = asks_to_close_ && again; // finer patches of the scene answer no question
    choices_.environment = input.environment();
    MaterialHistory::State opened{choices_.materials, choices_.conditions, choices_.environment};
    if (goes_on) { // what was chosen before can be had back
        history_->note(std::move(opened));
    } else {
        history_.emplace(std::move(opened));
    }
    document_.reset(); // whose threads end first
    document_ = std::make_unique<Document>(std::move(input), factor_cache_, Window::wake);
    const std::vector<std::string> channels = channel_choices(document_->input().scene->channels);
    if (std::find(channels.begin(), channels.end(), choices_.look.channel) == channels.end()) {
        choices_.look.channel = Look().channel;
    }
    saved_result_.clear();
    shown_look_.reset();
    message_.clear();
    bookmarks_ = Bookmarks();
    attempt([this] { bookmarks_ = Bookmarks(document_->input().file); });
    settle();
}

/// Shows the difference where something new is compared with.
/// @param again  the same file is read again
void Application::compare_with(const ViewerInput& input, bool again) {
    Look& look = choices_.look;
    const std::filesystem::path before = document_ ? file_compared(document_->input()) : "";
    if (!input.compared) {
        look.difference = false;
    } else if (!again || before != input.compared->file) {
        look.difference = true;
        look.range.reset();
        if (look.shown.view != View::quantity || why_no_difference(look.shown, input) != nullptr) {
            look.shown = {View::quantity, Quantity::radiosity};
        }
    }
}

void Application::open(const std::filesystem::path& file) {
    note_ = fmt::format("reading {}", file.filename().string());
    const ViewerInput& input = document_->input();
    const bool is_result = file.extension() == ".hres" && input.file.extension() == ".hres";
    if (file.extension() == ".hff") {
        opener_.open({input.file, file, {}}, file);
    } else if (same_file(file, input.file)) {
        opener_.open({file, input.factor_file, file_compared(input)}, file);
    } else if (is_result) { // a second one
        opener_.open({input.file, {}, file}, file);
    } else {
        opener_.open({file, {}, {}}, file);
    }
}

void Application::open_alone(const std::filesystem::path& file) {
    note_ = fmt::format("reading {}", file.filename().string());
    opener_.open({file, {}, {}}, file);
}

void Application::take_opened() {
    std::optional<Opened> opened = opener_.take();
    if (!opened) {
        return;
    }
    if (!opened->input) { // what was open stays
        note_.clear();
        message_ = opened->problem;
        return;
    }
    note_ = fmt::format("{} read", opened->file.filename().string());
    worked_ = {};
    works_since_.reset();
    exchange(std::move(*opened->input));
}

} // namespace hemi::viewer
