#include "viewer/overlays.hpp"

#include "display/false_colour_scale.hpp"
#include "display/legend.hpp"
#include "viewer/keys.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace hemi::viewer {

void legend(const Field& field, std::array<std::uint32_t, 2> view) {
    constexpr float margin = 10.0F;
    constexpr float pad = 9.0F;
    const float width = std::min(380.0F, static_cast<float>(view[0]) - 2.0F * margin);
    const float line_height = ImGui::GetTextLineHeight();
    const float height = 2.0F * line_height + 12.0F + 2.0F * pad + 8.0F;
    if (width < 150.0F || static_cast<float>(view[1]) < 3.0F * height) {
        return;
    }
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const ImVec2 origin{margin, static_cast<float>(view[1]) - margin - height};
    list->AddRectFilled(origin, {origin.x + width, origin.y + height}, IM_COL32(22, 24, 26, 225), 3.0F);
    const ImU32 ink = IM_COL32(235, 235, 235, 255);
    const std::string title = legend_title(field.shown, field.scale, field.grey);
    list->AddText({origin.x + pad, origin.y + pad - 2.0F}, ink, title.c_str());

    const float left = origin.x + pad + 14.0F;
    const float right = origin.x + width - pad - 20.0F;
    const float top = origin.y + pad + line_height + 3.0F;
    const float bottom = top + 12.0F;
    const auto colour = [&](double position) {
        const std::array<float, 3> linear = field.scale.colour_at(position);
        const auto encode = [](float value) {
            const float srgb =
                value <= 0.0031308F ? 12.92F * value : 1.055F * std::pow(value, 1.0F / 2.4F) - 0.055F;
            return static_cast<int>(std::lround(255.0F * srgb));
        };
        return IM_COL32(encode(linear[0]), encode(linear[1]), encode(linear[2]), 255);
    };
    const bool banded = field.scale.bands > 1;
    const int steps = banded ? static_cast<int>(field.scale.bands) : 40;
    for (int k = 0; k < steps; ++k) {
        const float from = left + (right - left) * static_cast<float>(k) / static_cast<float>(steps);
        const float to = left + (right - left) * static_cast<float>(k + 1) / static_cast<float>(steps);
        const ImU32 first = colour((k + (banded ? 0.5 : 0.0)) / steps);
        const ImU32 last = colour((k + (banded ? 0.5 : 1.0)) / steps);
        list->AddRectFilledMultiColor({from, top}, {to, bottom}, first, last, last, first);
    }
    const ColourScale told = legend_scale(field.shown, field.scale);
    const bool of_levels = banded || told.lines;
    const std::vector<double> marks = told.marks();
    const auto words_of = [&](double mark) {
        const bool whole = std::abs(mark) >= 1000.0 && std::abs(mark) < 10000.0;
        return of_levels ? level_text(mark, marks)
                         : (whole ? fmt::format("{:.0f}", mark) : fmt::format("{:.3g}", mark));
    };
    // Words of the ends of bands stay in the box.
    const auto text_left = [&](float x, float width_of_words) {
        const float least = origin.x + 3.0F;
        const float from = x - 0.5F * width_of_words;
        return of_levels ? std::clamp(from, least, std::max(least, origin.x + width - 3.0F - width_of_words))
                         : from;
    };
    const auto is_crowded = [&](std::size_t every) {
        float free_from = origin.x;
        for (std::size_t k = 0; k < marks.size(); k += every) {
            const float x = left + (right - left) * static_cast<float>(told.position(marks[k]));
            const float wide = ImGui::CalcTextSize(words_of(marks[k]).c_str()).x;
            if (text_left(x, wide) < free_from) {
                return true;
            }
            free_from = text_left(x, wide) + wide + 6.0F;
        }
        return false;
    };
    std::size_t every = 1; // mark that has words
    while (of_levels && every < marks.size() && is_crowded(every)) {
        ++every;
    }
    for (std::size_t k = 0; k < marks.size(); ++k) {
        const double mark = marks[k];
        const float x = left + (right - left) * static_cast<float>(told.position(mark));
        const bool line = told.lines && mark > told.low && mark < told.high;
        if (line) {
            const bool dark = is_dark_colour(told.colour_at(told.position(mark)));
            list->AddLine({x, top}, {x, bottom}, dark ? ink : IM_COL32(0, 0, 0, 255));
        }
        list->AddLine({x, bottom}, {x, bottom + 4.0F}, ink);
        if (k % every == 0) {
            const std::string words = words_of(mark);
            const float wide = ImGui::CalcTextSize(words.c_str()).x;
            list->AddText({text_left(x, wide), bottom + 4.0F}, ink, words.c_str());
        }
    }
    const std::array<bool, 2> beyond = values_beyond(field.shown, field.scale);
    const float middle = 0.5F * (top + bottom - line_height);
    if (beyond[0]) {
        list->AddText({left - 12.0F, middle}, ink, "<");
    }
    if (beyond[1]) {
        list->AddText({right + 5.0F, middle}, ink, ">");
    }
}

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
