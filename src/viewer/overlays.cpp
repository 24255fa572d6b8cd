#include "viewer/overlays.hpp"

#include "viewer/keys.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace hemi::viewer {

void hemicube_window(const HemicubePicture& picture, std::array<std::uint32_t, 2> view, Choices& choices) {
    constexpr float margin = 10.0F;
    const auto smaller = static_cast<float>(std::min(view[0], view[1]));
    const float edge = std::floor(std::clamp(0.36F * smaller, 136.0F, 420.0F));
    const ImVec2 home{static_cast<float>(view[0]) - margin, margin};
    // Of a view that became smaller some of it stays.
    ImGui::SetNextWindowPos(
        {std::clamp(home.x + choices.inset_moved[0], std::min(edge, home.x), static_cast<float>(view[0])),
         std::clamp(home.y + choices.inset_moved[1], 0.0F,
                    std::max(0.0F, static_cast<float>(view[1]) - edge))},
        ImGuiCond_Always, {1.0F, 0.0F});
    ImGui::SetNextWindowBgAlpha(0.88F);
    ImGui::Begin("hemicube", nullptr, fixed_window | ImGuiWindowFlags_AlwaysAutoResize);
    const float cross = ImGui::CalcTextSize("x").x + 2.0F * ImGui::GetStyle().FramePadding.x;
    std::string title = fmt::format("Hemicube of patch {}", picture.patch);
    if (ImGui::CalcTextSize(title.c_str()).x > edge - cross - 4.0F) {
        title = fmt::format("Patch {}", picture.patch);
    }
    const ImVec2 corner = ImGui::GetCursorPos();
    moving_area("move", {edge - cross - 4.0F, ImGui::GetFrameHeight()}, view, choices.inset_moved);
    tip(fmt::format(
        "{} texels along an edge. The top is in the middle, the four sides are folded out; the "
        "patch's own plane is all round. Turned about its normal, as it was drawn. Where nothing is "
        "seen it has the environment's colour; dark red are back faces.\nDrag: moves it.",
        picture.resolution));
    ImGui::SameLine();
    ImGui::SetCursorPos({corner.x + edge - cross, corner.y});
    if (small_button("x##close", "Closes it (C). It does not open again by itself.")) {
        choices.hemicube = false;
    }
    ImGui::SetCursorPos(corner);
    text(title);
    ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(picture.texture)), {edge, edge});
    choice("as shown", false, choices.hemicube_ids, "In the colours of the scene.");
    ImGui::SameLine();
    choice("ids", true, choices.hemicube_ids, "Every patch in a colour of its own.");
    if (picture.eyes > 1) {
        auto eye = static_cast<int>(choices.hemicube_eye) + 1;
        if (slider("##eye", eye, 1, static_cast<int>(picture.eyes),
                   fmt::format("eye point %d of {}", picture.eyes).c_str(), edge,
                   "Sample points of the patch, each with a hemicube of its own.")) {
            choices.hemicube_eye = static_cast<std::uint32_t>(eye - 1);
        }
    }
    ImGui::End();
}

namespace {

/// A window in the middle of the view, whose words are wrapped until ImGui::PopTextWrapPos().
void begin_question(const char* name, std::array<std::uint32_t, 2> view) {
    const float width = std::min(430.0F, static_cast<float>(view[0]) - 20.0F);
    ImGui::SetNextWindowPos({0.5F * static_cast<float>(view[0]), 0.4F * static_cast<float>(view[1])},
                            ImGuiCond_Always, {0.5F, 0.5F});
    ImGui::SetNextWindowSize({width, 0.0F});
    ImGui::SetNextWindowBgAlpha(0.97F);
    ImGui::Begin(name, nullptr, fixed_window | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PushTextWrapPos(width - 10.0F);
}

void mark_edge(const Vec3& from, const Vec3& to, const OrbitCamera& orbit, std::array<std::uint32_t, 2> view,
               ImU32 colour) {
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const auto pixel = [&view](const std::array<double, 2>& place) {
        return ImVec2(static_cast<float>(0.5 * view[0] + place[0] * view[1]),
                      static_cast<float>((0.5 - place[1]) * view[1]));
    };
    if (const auto line = orbit.line(from, to)) {
        const ImVec2 a = pixel((*line)[0]);
        const ImVec2 b = pixel((*line)[1]);
        list->AddLine(a, b, IM_COL32(0, 0, 0, 255), 4.0F);
        list->AddLine(a, b, colour, 2.0F);
    }
}

} // namespace

void mark_patch(const PatchMesh& mesh, std::uint32_t patch, const OrbitCamera& orbit,
                std::array<std::uint32_t, 2> view, bool picked) {
    const PatchCorners corners = mesh.corners(patch);
    for (std::size_t k = 0; k < corners.count; ++k) {
        mark_edge(corners.points[k], corners.points[(k + 1) % corners.count], orbit, view,
                  picked ? IM_COL32(255, 255, 255, 255) : IM_COL32(255, 80, 200, 255));
    }
}

void mark_edges(std::span<const std::array<Vec3, 2>> edges, const OrbitCamera& orbit,
                std::array<std::uint32_t, 2> view) {
    for (const auto& [from, to] : edges) {
        mark_edge(from, to, orbit, view, IM_COL32(255, 210, 90, 255));
    }
}

void help_window(std::array<std::uint32_t, 2> view, Controls controls, bool& open) {
    constexpr float margin = 10.0F;
    constexpr float widest = 668.0F;
    const ImVec2 room{static_cast<float>(view[0]) - 2.0F * margin,
                      static_cast<float>(view[1]) - 2.0F * margin};
    const float width = std::min(widest, room.x);
    ImGui::SetNextWindowPos({0.5F * static_cast<float>(view[0]), 0.5F * static_cast<float>(view[1])},
                            ImGuiCond_Always, {0.5F, 0.5F});
    ImGui::SetNextWindowSizeConstraints({width, 0.0F}, {width, room.y});
    ImGui::SetNextWindowBgAlpha(0.95F);
    if (!ImGui::Begin("Mouse and keys", &open,
                      ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                          ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings)) {
        ImGui::End();
        return;
    }
    if (ImGui::BeginTable("keys", 2)) {
        ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthStretch, 0.41F);
        ImGui::TableSetupColumn("meaning", ImGuiTableColumnFlags_WidthStretch, 0.59F);
        for (const GuideLine& line : guide(controls)) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextWrapped("%s", line.keys);
            ImGui::TableNextColumn();
            ImGui::TextWrapped("%s", line.meaning);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

void close_question(const std::string& unsaved, bool savable, std::array<std::uint32_t, 2> view,
                    Wishes& wishes) {
    begin_question("quit", view);
    text(unsaved);
    ImGui::PopTextWrapPos();
    ImGui::Spacing();
    if (savable) {
        wishes.save_and_close =
            button("Save the result and quit", "As NAME-001.hres in the current folder.") ||
            wishes.save_and_close;
        ImGui::SameLine();
    }
    wishes.close = button("Quit (Q)", "What is not saved is lost.") || wishes.close;
    ImGui::SameLine();
    wishes.stay = button("Stay (Esc)", "The window stays open.") || wishes.stay;
    ImGui::End();
}

void write_question(const std::string& words, const std::string& file, std::array<std::uint32_t, 2> view,
                    Choices& choices) {
    begin_question("write", view);
    text(fmt::format("Write into {}: {}?", file, words));
    ImGui::PopTextWrapPos();
    ImGui::Spacing();
    if (button("Write", "Replaces these values in the file; every other byte of it stays.")) {
        choices.wishes.save_materials = true;
        choices.asks_to_write = false;
    }
    ImGui::SameLine();
    if (button("Cancel (Esc)", "The file stays as it is.")) {
        choices.asks_to_write = false;
    }
    ImGui::End();
}

void backs_note(std::array<std::uint32_t, 2> view) {
    ImGui::SetNextWindowPos({0.5F * static_cast<float>(view[0]), 10.0F}, ImGuiCond_Always, {0.5F, 0.0F});
    ImGui::SetNextWindowBgAlpha(0.8F);
    ImGui::Begin("backs", nullptr,
                 fixed_window | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs);
    text("Surfaces that face away are not drawn: B shows their backs.");
    ImGui::End();
}

void message_window(const std::string& message, std::array<std::uint32_t, 2> view, bool& open) {
    constexpr float margin = 10.0F;
    const float width = std::min(620.0F, static_cast<float>(view[0]) - 2.0F * margin);
    ImGui::SetNextWindowPos({margin, margin});
    ImGui::SetNextWindowSize({width, 0.0F});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, ImVec4(0.34F, 0.08F, 0.08F, 0.95F));
    ImGui::Begin("message", nullptr, fixed_window | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PushTextWrapPos(width - 62.0F);
    text(message);
    ImGui::PopTextWrapPos();
    ImGui::SameLine(width - 54.0F);
    open = !small_button("Close", "Closes this message (Esc).");
    ImGui::End();
    ImGui::PopStyleColor();
}

} // namespace hemi::viewer
