#include "viewer/application.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/image_file.hpp"
#include "hemi/io/scene_writer.hpp"
#include "viewer/command_line.hpp"
#include "viewer/dots.hpp"
#include "viewer/material_change.hpp"
#include "viewer/report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

// What the window writes.

namespace hemi::viewer {

void Application::screenshot(const std::filesystem::path& path, std::array<std::uint32_t, 2> size,
                             std::uint32_t samples) {
    if (view_.dots() && path.extension() == ".hdr") {
        throw InvalidArgument("points are drawn as .png: .hdr holds light");
    }
    const Picture picture = view_.picture(navigator_.camera(), size, samples);
    if (path.extension() == ".hdr") {
        io::write_hdr(path, picture.width, picture.height, picture.linear);
    } else {
        io::write_png(path, picture.width, picture.height, picture.srgb);
    }
    note_ = fmt::format("{} ({} x {})", path.filename().string(), size[0], size[1]);
    std::fprintf(stderr, "%s\n", path.string().c_str());
}

void Application::windowshot(const std::filesystem::path& path) {
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
    note_ = path.filename().string();
    std::fprintf(stderr, "%s\n", path.string().c_str());
}

void Application::report(const std::filesystem::path& path) const {
    const bool hemicube = inset_ && choices_.picked && choices_.hemicube;
    write_report(path,
                 {*document_, choices_, view_.field(), picked_, navigator_.camera(), message_,
                  hemicube ? inset_->seen() : std::vector<std::uint32_t>(), under_cursor_, dot_under_cursor_,
                  asks_to_close_, groups_, values_, probe_, histogram_, hides_backs_});
}

void Application::save_camera() {
    io::write_scene_camera(document_->input().file, navigator_.camera());
    note_ = fmt::format("camera saved into {}", document_->input().file.filename().string());
}

void Application::save_materials() {
    const MaterialChanges changes = changed_materials(*document_->input().scene, choices_);
    if (changes.words.empty()) {
        throw InvalidArgument("no material is other than in the scene, nor the environment");
    }
    io::write_scene_materials(document_->input().file, changes.materials, changes.environment);
    note_ = fmt::format("{}: {} written", document_->input().file.filename().string(), changes.words);
}

void Application::save_result(const std::filesystem::path& path) {
    document_->save_result(path);
    saved_result_ = path;
    note_ = fmt::format("{} saved", path.filename().string());
    std::fprintf(stderr, "%s\n", path.string().c_str());
}

std::string Application::command_line() const {
    const Look& look = choices_.look;
    if (look.shown.view != View::picture && look.shown.view != View::quantity) {
        throw InvalidArgument("a command line draws the light or a quantity: choose one first (V)");
    }
    const bool heat = look.shown.view == View::quantity && is_of_heat(look.shown.quantity);
    std::string command = heat ? document_->input().heat_command : document_->input().command;
    if (shows_difference(look)) {
        command = fmt::format("hemi diff {} {}", quoted(document_->input().file.string()),
                              quoted(document_->input().compared->file.string()));
    } else if (!saved_result_.empty()) {
        command = "hemi render " + quoted(saved_result_.string());
    } else if (!document_->as_opened()) {
        throw InvalidArgument("materials or environment are no longer those of the file: save the result, "
                              "then copy the command line");
    }
    PictureSettings picture =
        picture_settings(choices_.look, document_->input().picture,
                         document_->exposure() * std::exp2(choices_.look.stops), view_size());
    picture.samples = choices_.samples;
    picture.cut = choices_.cut;
    command += look.shown.view == View::quantity ? quantity_options(look, view_.field()->shown)
                                                 : document_->input().show_option;
    command += dots_options(document_->input(), look, command);
    return command + " -o " + quoted(document_->input().file.stem().string() + ".png") +
           picture_options(picture, navigator_.camera(), look.shown.view == View::picture,
                           document_->input().mesh->groups());
}

} // namespace hemi::viewer
