#include "viewer/gauges.hpp"

#include "display/colour_scale.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hemi::viewer {

namespace {

constexpr float margin = 12.0F;
constexpr ImU32 ink = IM_COL32(235, 235, 235, 255);
constexpr ImU32 shade = IM_COL32(0, 0, 0, 255);

/// Words that can be read on any ground.
void label(ImDrawList& list, const ImVec2& at, ImU32 colour, const char* words) {
    for (const ImVec2& shift : {ImVec2(-1.0F, 0.0F), {1.0F, 0.0F}, {0.0F, -1.0F}, {0.0F, 1.0F}}) {
        list.AddText({at.x + shift.x, at.y + shift.y}, shade, words);
    }
    list.AddText(at, colour, words);
}

struct Axis {
    const char* name;
    ImU32 colour;
    double right; ///< of its unit vector, on the screen
    double up;
    double away;
};

/// @param middle  on the screen
void draw_axes(ImDrawList& list, const Camera& camera, const ImVec2& middle) {
    constexpr float length = 30.0F;
    const Vec3 forward = glm::normalize(camera.target - camera.eye);
    Vec3 right = glm::cross(forward, camera.up);
    if (!(glm::length(right) > 0.0)) {
        return; // the view is along what is up, which cameras of the window never are
    }
    right = glm::normalize(right);
    const Vec3 up = glm::cross(right, forward);
    std::array<Axis, 3> axes{{{"x", IM_COL32(240, 90, 80, 255), right.x, up.x, forward.x},
                              {"y", IM_COL32(110, 210, 90, 255), right.y, up.y, forward.y},
                              {"z", IM_COL32(110, 160, 255, 255), right.z, up.z, forward.z}}};
    std::sort(axes.begin(), axes.end(), [](const Axis& a, const Axis& b) { return a.away > b.away; });
    for (const Axis& axis : axes) {
        const ImVec2 tip{middle.x + length * static_cast<float>(axis.right),
                         middle.y - length * static_cast<float>(axis.up)};
        list.AddLine(middle, tip, shade, 4.0F);
        list.AddLine(middle, tip, axis.colour, 2.0F);
        const ImVec2 size = ImGui::CalcTextSize(axis.name);
        label(list,
              {middle.x + 1.3F * (tip.x - middle.x) - 0.5F * size.x,
               middle.y + 1.3F * (tip.y - middle.y) - 0.5F * size.y},
              axis.colour, axis.name);
    }
}

/// @param right  end of the bar, on the screen
void draw_scale(ImDrawList& list, const Scene& scene, const Camera& camera, const ImVec2& right,
                std::uint32_t height) {
    constexpr double shortest = 60.0; // pixels; the bar is at most 2.5 times that
    const double metres = scene.unit.value_or(1.0);
    const double depth = glm::length(camera.target - camera.eye);
    const double seen = 2.0 * std::tan(camera.fov * std::numbers::pi / 360.0) * depth * metres;
    const double pixels_a_metre = height / seen;
    const double length = round_up(shortest / pixels_a_metre);
    const auto width = static_cast<float>(length * pixels_a_metre);
    const std::string words =
        length_text(scene, length / metres) + (camera.orthographic ? "" : " at the target's depth");
    const ImVec2 size = ImGui::CalcTextSize(words.c_str());
    const float left = right.x - width;
    for (const auto& [colour, thickness] : {std::pair{shade, 4.0F}, {ink, 2.0F}}) {
        list.AddLine({left, right.y}, right, colour, thickness);
        list.AddLine({left, right.y - 5.0F}, {left, right.y + 1.0F}, colour, thickness);
        list.AddLine({right.x, right.y - 5.0F}, {right.x, right.y + 1.0F}, colour, thickness);
    }
    label(list, {right.x - size.x, right.y - 8.0F - size.y}, ink, words.c_str());
}

} // namespace

std::string length_text(const Scene& scene, double length) {
    const double metres = length * scene.unit.value_or(1.0);
    const double size = std::abs(metres);
    if (size >= 1000.0) {
        return fmt::format("{:.4g} km", metres / 1000.0);
    }
    if (size >= 0.1 || size == 0.0) {
        return fmt::format("{:.4g} m", metres);
    }
    return size >= 1e-4 ? fmt::format("{:.4g} mm", metres * 1e3) : fmt::format("{:.4g} µm", metres * 1e6);
}

void gauges(const Scene& scene, const OrbitCamera& orbit, std::array<std::uint32_t, 2> view, bool legend) {
    constexpr std::uint32_t beside_legend = 640;
    constexpr float above_legend = 104.0F;
    constexpr float axes_room = 44.0F; // from their middle
    constexpr std::uint32_t least_width = 300;
    constexpr std::uint32_t least_height = 200;
    if (view[0] < least_width || view[1] < least_height) {
        return;
    }
    ImDrawList* const list = ImGui::GetBackgroundDrawList();
    const float raised = legend && view[0] < beside_legend ? above_legend : 0.0F;
    const ImVec2 corner{static_cast<float>(view[0]) - margin, static_cast<float>(view[1]) - margin - raised};
    draw_axes(*list, orbit.camera(), {corner.x - axes_room, corner.y - axes_room - 34.0F});
    draw_scale(*list, scene, orbit.camera(), corner, view[1]);
}

} // namespace hemi::viewer
