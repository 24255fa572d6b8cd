#include "viewer/application.hpp"

#include "hemi/core/error.hpp"
#include "hemi/scene/light_unit.hpp"
#include "viewer/clipping.hpp"
#include "viewer/dots.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

// What is under the cursor, groups, the clipping plane, the line that is measured, and cameras that are kept.

namespace hemi::viewer {

void Application::look_under_cursor() {
    under_cursor_.reset();
    dot_under_cursor_.reset();
    if (!(choices_.panel || view_.dots()) || navigator_.dragging() || !navigator_.on_picture() ||
        gui_.has_mouse()) {
        return;
    }
    if (const auto point = navigator_.surface_under_cursor(choices_.look.backs)) {
        under_cursor_ = UnderCursor{patch_at(*document_->input().mesh, *point), point->position};
    }
    if (view_.dots()) {
        dot_under_cursor_ = dot_at(*view_.dots(), choices_.cut, navigator_.ray_under_cursor(),
                                   under_cursor_ ? std::optional(under_cursor_->position) : std::nullopt);
    }
}

std::array<std::string, 2> Application::words_under_cursor() const {
    if (!under_cursor_) {
        return {};
    }
    const ViewerInput& input = document_->input();
    const std::uint32_t i = under_cursor_->patch;
    std::string value;
    if (view_.field()) {
        const FalseColours& shown = view_.field()->shown;
        value = std::isnan(shown.values[i]) ? view_.field()->grey
                                            : fmt::format("{:.4g} {}", shown.values[i], shown.unit);
    } else if (document_->light().knows(i)) {
        for (std::uint32_t c = 0; c < input.channels(); ++c) {
            value +=
                fmt::format("{:.3g} ", document_->light().radiosity[std::size_t{i} * input.channels() + c]);
        }
        value += flux_density_unit(*input.scene);
    }
    const Vec3& at = under_cursor_->position;
    return {fmt::format("{}, patch {}: {}", input.mesh->groups()[input.mesh->group(i)], i, value),
            fmt::format("at {:.4g} {:.4g} {:.4g}", at.x, at.y, at.z)};
}

void Application::settle_cut() {
    const PatchMesh& mesh = *document_->input().mesh;
    if (choices_.picked && (shown_pick_ != choices_.picked || !choices_.group)) {
        choices_.group = mesh.group(*choices_.picked);
    }
    if (shown_group_ != choices_.group) {
        shown_group_ = choices_.group;
        group_edges_ = shown_group_ ? group_edges(mesh, *shown_group_) : std::vector<std::array<Vec3, 2>>();
    }
    if (shown_cut_ != choices_.cut) {
        shown_cut_ = choices_.cut;
        picture_changed_ = true;
    }
    navigator_.set_cut(shown_cut_);
    view_.cut(shown_cut_);
}

void Application::settle_probe() {
    std::vector<Vec3>& ends = choices_.measured;
    if (!choices_.measuring) {
        ends.clear();
    }
    if (ends.size() < 2) {
        probe_.reset();
    } else if (!probe_ || probe_->ends != std::array{ends[0], ends[1]}) {
        probe_ = probe_line(*document_->input().mesh, navigator_.orbit(), {ends[0], ends[1]},
                            choices_.look.backs, choices_.cut);
    }
}

void Application::on_group_key(char key) {
    const std::size_t count = document_->input().mesh->groups().size();
    if (key == 'A') {
        choices_.cut.groups.clear();
    } else if (!choices_.group) {
        note_ = "select a group first: click a patch, or a name in the list";
    } else if (key == 'I') {
        isolate(choices_, *choices_.group, count);
    } else {
        set_visibility(choices_, *choices_.group, key == 'O' ? Visibility::outlines : Visibility::hidden,
                       count);
    }
}

void Application::clip_by_key(bool turn) {
    std::optional<ClipPlane>& clip = choices_.cut.clip;
    if (turn && clip) {
        clip = other_side(*clip);
    } else if (clip) {
        clip.reset();
    } else if (choices_.picked) {
        clip = plane_of_patch(*document_->input().mesh, *choices_.picked);
    } else {
        note_ = "click a patch first: the clipping plane goes through it";
    }
}

void Application::save_probe(const std::filesystem::path& path) {
    if (!probe_) {
        throw InvalidArgument("no line is measured: D, and two clicks on the scene");
    }
    write_probe(path, *probe_, values_);
    note_ = fmt::format("{} saved", path.filename().string());
    std::fprintf(stderr, "%s\n", path.string().c_str());
}

void Application::keep_camera(int number) {
    bookmarks_.store(number, navigator_.camera());
    note_ = fmt::format("camera {} kept in {}", number, bookmarks_.file().filename().string());
}

void Application::go_to_patch(std::uint32_t patch) {
    choices_.picked = patch;
    navigator_.orbit().place(camera_at(*document_->input().mesh, patch, navigator_.camera()));
    picture_changed_ = true;
}

void Application::go_to_camera(int number) {
    if (const std::optional<Camera>& camera = bookmarks_.camera(number)) {
        navigator_.orbit().place(*camera);
        picture_changed_ = true;
    } else {
        note_ = fmt::format("no camera {} is kept: ctrl + {} keeps one", number, number);
    }
}

} // namespace hemi::viewer
