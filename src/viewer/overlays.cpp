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
    const float edge = std::floor(std::clamp(0.36F * smaller, 120.0F, 420.0F));
    ImGui::SetNextWindowPos({static_cast<float>(view[0]) - margin, margin}, ImGuiCond_Always, {1.0F, 0.0F});
    ImGui::SetNextWindowBgAlpha(0.88F);
    ImGui::Begin("hemicube", nullptr, fixed_window | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PushTextWrapPos(edge + 8.0F);
    text(fmt::format("Hemicube of patch {}", picture.patch));
    ImGui::PopTextWrapPos();
    if (ImGui::IsItemHovered()) {
        ImGui::SetTooltip(
            "%d texels along an edge. The top is in the middle, the four sides are folded out;\n"
            "the patch's own plane is all round. Turned about its normal, as it was drawn.\n"
            "Dark grey: nothing, the environment. Dark red: back faces.",
            static_cast<int>(picture.resolution));
    }
    ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(picture.texture)), {edge, edge});
    choice("as shown", false, choices.hemicube_ids);
    ImGui::SameLine();
    choice("ids", true, choices.hemicube_ids);
    if (picture.eyes > 1) {
        auto eye = static_cast<int>(choices.hemicube_eye) + 1;
        ImGui::SetNextItemWidth(edge);
        if (ImGui::SliderInt("##eye", &eye, 1, static_cast<int>(picture.eyes),
                             fmt::format("eye point %d of {}", picture.eyes).c_str(),
                             ImGuiSliderFlags_NoInput)) {
            choices.hemicube_eye = static_cast<std::uint32_t>(eye - 1);
        }
    }
    ImGui::End();
}

namespace {

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
    const float width = std::min(430.0F, static_cast<float>(view[0]) - 20.0F);
    ImGui::SetNextWindowPos({0.5F * static_cast<float>(view[0]), 0.4F * static_cast<float>(view[1])},
                            ImGuiCond_Always, {0.5F, 0.5F});
    ImGui::SetNextWindowSize({width, 0.0F});
    ImGui::SetNextWindowBgAlpha(0.97F);
    ImGui::Begin("quit", nullptr, fixed_window | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PushTextWrapPos(width - 10.0F);
    text(unsaved);
    ImGui::PopTextWrapPos();
    ImGui::Spacing();
    if (savable) {
        wishes.save_and_close = ImGui::Button("Save the result and quit") || wishes.save_and_close;
        ImGui::SameLine();
    }
    wishes.close = ImGui::Button("Quit (Q)") || wishes.close;
    ImGui::SameLine();
    wishes.stay = ImGui::Button("Stay (Esc)") || wishes.stay;
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
    open = !ImGui::SmallButton("Close");
    ImGui::End();
    ImGui::PopStyleColor();
}

} // namespace hemi::viewer
