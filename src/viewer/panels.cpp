#include "viewer/panels.hpp"

#include "display/orbit_camera.hpp"
#include "viewer/clipping.hpp"
#include "viewer/dots.hpp"
#include "viewer/findings.hpp"
#include "viewer/material_sections.hpp"
#include "viewer/patch_section.hpp"
#include "viewer/show_section.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hemi::viewer {

namespace {

constexpr std::uint32_t side_width = 380;
constexpr std::uint32_t smallest_width = 640;
constexpr std::uint32_t smallest_height = 360;

constexpr float plot_height = 54.0F;

/// The residual after every sweep, on a logarithmic scale.
void residual_plot(const std::vector<double>& residuals) {
    std::vector<float> decades;
    decades.reserve(residuals.size());
    for (const double residual : residuals) {
        decades.push_back(static_cast<float>(std::log10(std::max(residual, 1e-16))));
    }
    const auto [least, most] = std::minmax_element(decades.begin(), decades.end());
    const float low = std::floor(*least);
    const float high = std::max(std::ceil(*most), low + 1.0F);
    const std::string words =
        fmt::format("residual, 1e{} to 1e{}", static_cast<int>(high), static_cast<int>(low));
    ImGui::PlotLines("##residuals", decades.data(), static_cast<int>(decades.size()), 0, words.c_str(), low,
                     high, {ImGui::GetContentRegionAvail().x, plot_height});
    tip("||E' - (I - rho F) B|| / ||E'|| after every sweep, on a logarithmic scale; no unit.");
}

void solution_section(const PanelContent& content, Choices& choices) {
    if (!heading("Solution", "How the light was solved for, sweep by sweep.")) {
        return;
    }
    const Work& work = content.document.work();
    if (content.document.input().factors == nullptr) {
        faint(content.document.input().factor_settings
                  ? work.light.empty() ? "the light of the lamps alone" : work.light
                  : "as it is stored");
        return;
    }
    faint(work.light.empty() ? "solving" : work.light);
    if (work.residuals.empty()) {
        ImGui::Dummy({0.0F, plot_height}); // buttons stay where they are
    } else {
        residual_plot(work.residuals);
    }
    if (button("Start over", "Back to the light of the lamps alone.")) {
        choices.wishes.start_over = true;
    }
    ImGui::SameLine();
    if (button("One sweep", "One more Gauss-Seidel sweep (G).")) {
        choices.wishes.step = true;
    }
    if (work.waits) {
        ImGui::SameLine();
        if (button("All sweeps", "The sweeps that are left (shift + G).")) {
            choices.wishes.run_on = true;
        }
    }
}

void camera_section(const PanelContent& content, Choices& choices) {
    if (!heading("Camera", "Where one looks from, and views that are kept.", false)) {
        return;
    }
    auto fov = static_cast<float>(content.camera.fov);
    if (slider("field of view", fov, static_cast<float>(OrbitCamera::smallest_fov),
               static_cast<float>(OrbitCamera::largest_fov), "%.0f degrees", -102.0F,
               "Angle from the lower to the upper edge of the picture; degrees.")) {
        choices.wishes.fov = static_cast<double>(fov);
    }
    bool orthographic = content.camera.orthographic;
    if (checkbox("orthographic", orthographic, "Without perspective: what is far is no smaller (5).")) {
        choices.wishes.orthographic = orthographic;
    }
    ImGui::SameLine();
    checkbox("walk by W, A, S, D", choices.walking,
             "Keys walk, faster with shift, and drags look around (J).");
    struct ViewButton {
        const char* name;
        char key;
        const char* meaning;
    };
    constexpr std::array<ViewButton, 5> views{{{"All", 'F', "Frames the whole scene (F)."},
                                               {"Scene's", 'R', "The camera of the scene's file (R)."},
                                               {"Front", '1', "From the front (1)."},
                                               {"Right", '3', "From the right (3)."},
                                               {"Top", '7', "From above (7)."}}};
    for (const ViewButton& view : views) {
        if (button(view.name, view.meaning)) {
            choices.wishes.camera_key = view.key;
        }
        ImGui::SameLine();
    }
    ImGui::NewLine();
    if (button("Save into the scene", "Writes this camera into the scene's JSON file.")) {
        choices.wishes.save_camera = true;
    }
    bool any = false;
    for (int number = 1; number <= Bookmarks::count; ++number) {
        if (content.bookmarks.camera(number)) {
            if (any) {
                ImGui::SameLine();
            }
            any = true;
            if (small_button(std::to_string(number).c_str(), "A camera that was kept; a click goes to it.")) {
                choices.wishes.bookmark = number;
            }
        }
    }
    faint(any ? "ctrl + 1 ... 9 keeps this camera, alt + 1 ... 9 goes to it"
              : "ctrl + 1 ... 9 keeps this camera beside the scene");
}

void file_section(Choices& choices) {
    if (!heading("Files", "Pictures, results, and the file that is open.", false)) {
        return;
    }
    Wishes& wishes = choices.wishes;
    const auto sizes = picture_sizes();
    if (begin_list("##size", sizes[choices.picture_size].name, 120.0F, "Size of screenshots, pixels.")) {
        for (std::size_t k = 0; k < sizes.size(); ++k) {
            if (list_line(sizes[k].name, k == choices.picture_size)) {
                choices.picture_size = k;
            }
        }
        ImGui::EndCombo();
    }
    ImGui::SameLine();
    auto samples = static_cast<int>(choices.samples);
    if (slider("##samples", samples, 1, 8, fmt::format("%d x {} samples", samples).c_str(), -1.0F,
               "Samples of each pixel of screenshots, along both of its edges.")) {
        choices.samples = static_cast<std::uint32_t>(samples);
    }
    wishes.screenshot = button("Screenshot", "Of the picture, as NAME-001.png in the current folder (P).") ||
                        wishes.screenshot;
    ImGui::SameLine();
    wishes.copy_command =
        button("Copy command line", "A command that draws this picture without a window (X).") ||
        wishes.copy_command;
    wishes.save_result = button("Save result", "The light as it stands, as NAME-001.hres in the current "
                                               "folder, for `hemi render` and `hemi diff`.") ||
                         wishes.save_result;
    ImGui::SameLine();
    wishes.reload = button("Read again", "Reads the file again (F5).") || wishes.reload;
    faint("Drop a scene or a .hres on the window to open it, a .hff with the rows of this scene, or a second "
          ".hres to compare with the first.");
}

} // namespace

std::span<const PictureSize> picture_sizes() {
    static constexpr std::array<PictureSize, 5> sizes{{{"as shown", 0, 0, 1},
                                                       {"as shown, x 2", 0, 0, 2},
                                                       {"1280 x 720", 1280, 720, 1},
                                                       {"1920 x 1080", 1920, 1080, 1},
                                                       {"3840 x 2160", 3840, 2160, 1}}};
    return sizes;
}

std::uint32_t panel_width(std::array<std::uint32_t, 2> window, bool wanted) {
    return wanted && window[0] >= smallest_width && window[1] >= smallest_height ? side_width : 0;
}

void side_panel(const PanelContent& content, std::array<std::uint32_t, 2> window, Choices& choices) {
    choices.pointed_at.reset();
    const auto width = static_cast<float>(side_width);
    ImGui::SetNextWindowPos({static_cast<float>(window[0]) - width, 0.0F});
    ImGui::SetNextWindowSize({width, static_cast<float>(window[1])});
    ImGui::Begin("panel", nullptr, fixed_window);
    const float foot = ImGui::GetTextLineHeightWithSpacing() * 3.0F + 6.0F;
    const Work& work = content.document.work();
    if (!work.doing.empty()) {
        ImGui::ProgressBar(static_cast<float>(work.share), {-1.0F, 0.0F});
        faint(work.doing);
        ImGui::SameLine(width - 74.0F);
        choices.wishes.cancel =
            small_button("Cancel", "Stops; what was found by now stays.") || choices.wishes.cancel;
        ImGui::Separator();
    }
    ImGui::BeginChild("sections", {0.0F, -foot});
    show_section(content, choices);
    groups_section(content, choices);
    dots_section(content.document.input(), choices);
    heat_section(content, choices);
    findings_section(content, choices); // above the patch, whose lines come and go
    patch_section(content, choices);
    clip_section(content, choices);
    solution_section(content, choices);
    material_section(content, choices);
    camera_section(content, choices);
    file_section(choices);
    ImGui::EndChild();
    ImGui::Separator();
    text(content.note.empty() ? work.light : content.note);
    const bool pointed = !content.under_cursor[0].empty();
    faint(pointed ? content.under_cursor[0] : content.status);
    faint(pointed ? content.under_cursor[1] : "F1 help   Tab panel");
    ImGui::End();
}

} // namespace hemi::viewer
