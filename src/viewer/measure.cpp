#include "viewer/measure.hpp"

#include "viewer/gauges.hpp"
#include "viewer/panels.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemi::viewer {

namespace {

constexpr ImU32 line_colour = IM_COL32(90, 220, 255, 255);
constexpr float probe_height = 70.0F;

/// Value of what is seen at a point of the line; not a number where there is none.
double value_at(const ProbePoint& point, const ShownValues& values) {
    return point.patch ? values.values[*point.patch] : std::numeric_limits<double>::quiet_NaN();
}

/// Values against length, with the value under the cursor.
void plot(const Scene& scene, const LineProbe& probe, const ShownValues& values) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const ProbePoint& point : probe.points) {
        const double value = value_at(point, values);
        low = value < low ? value : low;
        high = value > high ? value : high;
    }
    if (!(low <= high)) {
        text("no values along it");
        return;
    }
    text(fmt::format("{:.4g} to {:.4g} {}", low, high, values.unit));
    const double least = 1e-9 * std::max(std::abs(low), std::abs(high));
    if (high - low <= least) { // one value: a line in the middle
        low -= std::max(least, 1e-300);
        high += std::max(least, 1e-300);
    }
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x;
    ImGui::InvisibleButton("plot", {width, probe_height});
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(corner, {corner.x + width, corner.y + probe_height}, IM_COL32(40, 44, 48, 255));
    const auto last = static_cast<float>(probe.points.size() - 1);
    const auto place = [&](std::size_t k) {
        const double share = (value_at(probe.points[k], values) - low) / (high - low);
        return ImVec2(corner.x + width * static_cast<float>(k) / last,
                      corner.y + 2.0F + (probe_height - 4.0F) * static_cast<float>(1.0 - share));
    };
    for (std::size_t k = 1; k < probe.points.size(); ++k) {
        if (!std::isnan(value_at(probe.points[k - 1], values)) &&
            !std::isnan(value_at(probe.points[k], values))) {
            list.AddLine(place(k - 1), place(k), line_colour, 1.5F);
        }
    }
    if (ImGui::IsItemHovered()) {
        const float share = std::clamp((ImGui::GetIO().MousePos.x - corner.x) / width, 0.0F, 1.0F);
        const ProbePoint& point = probe.points[static_cast<std::size_t>(std::lround(share * last))];
        const double value = value_at(point, values);
        show_tip(fmt::format("at {}: {}", length_text(scene, point.length),
                             std::isnan(value) ? std::string("nothing")
                                               : fmt::format("{:.4g} {}", value, values.unit)));
    }
}

} // namespace

void mark_line(std::span<const Vec3> points, const OrbitCamera& orbit, std::array<std::uint32_t, 2> view) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const auto pixel = [&view](const std::array<double, 2>& place) {
        return ImVec2(static_cast<float>(0.5 * view[0] + place[0] * view[1]),
                      static_cast<float>((0.5 - place[1]) * view[1]));
    };
    if (points.size() == 2) {
        if (const auto line = orbit.line(points[0], points[1])) {
            list.AddLine(pixel((*line)[0]), pixel((*line)[1]), IM_COL32(0, 0, 0, 255), 4.0F);
            list.AddLine(pixel((*line)[0]), pixel((*line)[1]), line_colour, 2.0F);
        }
    }
    for (const Vec3& point : points) {
        if (const auto line = orbit.line(point, point)) {
            list.AddCircleFilled(pixel((*line)[0]), 5.0F, IM_COL32(0, 0, 0, 255));
            list.AddCircleFilled(pixel((*line)[0]), 3.5F, line_colour);
        }
    }
}

void measure_window(const Scene& scene, const std::optional<LineProbe>& probe, const ShownValues& values,
                    std::array<std::uint32_t, 2> view, Choices& choices) {
    constexpr float margin = 10.0F;
    const float width = std::min(300.0F, static_cast<float>(view[0]) - 2.0F * margin);
    ImGui::SetNextWindowPos({margin, margin});
    ImGui::SetNextWindowSize({width, 0.0F});
    ImGui::SetNextWindowBgAlpha(0.9F);
    ImGui::Begin("measure", nullptr, fixed_window | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PushTextWrapPos(width - margin);
    if (!probe) {
        text(choices.measured.empty() ? "Click the first end of a line on the scene."
                                      : "Click the other end.");
    } else {
        const Vec3 way = probe->ends[1] - probe->ends[0];
        text("distance " + length_text(scene, glm::length(way)));
        text(fmt::format("dx {}   dy {}   dz {}", length_text(scene, way.x), length_text(scene, way.y),
                         length_text(scene, way.z)));
        text(values.title);
        plot(scene, *probe, values);
        choices.wishes.save_probe =
            button("Save as CSV", "Lengths, points, patches and values along the line, as NAME-001.csv.") ||
            choices.wishes.save_probe;
        ImGui::SameLine();
    }
    ImGui::PopTextWrapPos();
    if (button("Close (D)", "Measures no more.")) {
        choices.measuring = false;
    }
    ImGui::End();
}

} // namespace hemi::viewer
