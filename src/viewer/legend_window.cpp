#include "viewer/legend_window.hpp"

#include "display/false_colour_scale.hpp"
#include "display/legend.hpp"
#include "viewer/panels.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace hemi::viewer {

namespace {

constexpr ImU32 ink = IM_COL32(235, 235, 235, 255);
constexpr float bar_height = 12.0F;
constexpr float histogram_height = 30.0F;

/// Places on the screen.
struct Box {
    float left;
    float top;
    float right;
    float bottom;

    [[nodiscard]] float x_of(double position) const {
        return left + (right - left) * static_cast<float>(position);
    }
    [[nodiscard]] double position_of(float x) const {
        return std::clamp(static_cast<double>((x - left) / (right - left)), 0.0, 1.0);
    }
};

ImU32 colour_of(const ColourScale& scale, double position) {
    const std::array<float, 3> linear = scale.colour_at(position);
    return IM_COL32(srgb_of(linear[0]), srgb_of(linear[1]), srgb_of(linear[2]), 255);
}

void draw_colours(ImDrawList& list, const ColourScale& scale, const Box& bar) {
    const bool banded = scale.bands > 1;
    const int steps = banded ? static_cast<int>(scale.bands) : 40;
    for (int k = 0; k < steps; ++k) {
        const ImU32 first = colour_of(scale, (k + (banded ? 0.5 : 0.0)) / steps);
        const ImU32 last = colour_of(scale, (k + (banded ? 0.5 : 1.0)) / steps);
        list.AddRectFilledMultiColor({bar.x_of(static_cast<double>(k) / steps), bar.top},
                                     {bar.x_of((k + 1.0) / steps), bar.bottom}, first, last, last, first);
    }
}

/// Bars stand on the colours; the highest reaches the top.
void draw_histogram(ImDrawList& list, const std::vector<double>& shares, const Box& box) {
    const double highest = shares.empty() ? 0.0 : *std::max_element(shares.begin(), shares.end());
    if (!(highest > 0.0)) {
        return;
    }
    const auto count = static_cast<double>(shares.size());
    for (std::size_t k = 0; k < shares.size(); ++k) {
        if (shares[k] > 0.0) { // few are seen, too
            const float height =
                std::max(1.0F, (box.bottom - box.top) * static_cast<float>(shares[k] / highest));
            list.AddRectFilled({box.x_of(static_cast<double>(k) / count), box.bottom - height},
                               {box.x_of((static_cast<double>(k) + 1.0) / count), box.bottom},
                               IM_COL32(160, 165, 170, 255));
        }
    }
}

/// @param told   the scale as its numbers are told
/// @param whole  the legend
void draw_marks(ImDrawList& list, const ColourScale& told, const Box& bar, const Box& whole) {
    const bool of_levels = told.bands > 1 || told.lines;
    const std::vector<double> marks = told.marks();
    const auto words_of = [&](double mark) {
        const bool thousands = std::abs(mark) >= 1000.0 && std::abs(mark) < 10000.0;
        return of_levels ? level_text(mark, marks)
                         : (thousands ? fmt::format("{:.0f}", mark) : fmt::format("{:.3g}", mark));
    };
    const auto width_of = [&](double mark) { return ImGui::CalcTextSize(words_of(mark).c_str()).x; };
    const auto text_left = [&](double mark) { // those of the ends stay in the legend
        const float least = whole.left + 3.0F;
        return std::clamp(bar.x_of(told.position(mark)) - 0.5F * width_of(mark), least,
                          std::max(least, whole.right - 3.0F - width_of(mark)));
    };
    const auto is_crowded = [&](std::size_t every) {
        float free_from = whole.left;
        for (std::size_t k = 0; k < marks.size(); k += every) {
            if (text_left(marks[k]) < free_from) {
                return true;
            }
            free_from = text_left(marks[k]) + width_of(marks[k]) + 6.0F;
        }
        return false;
    };
    std::size_t every = 1; // mark that has words
    while (of_levels && every < marks.size() && is_crowded(every)) {
        ++every;
    }
    for (std::size_t k = 0; k < marks.size(); ++k) {
        const float x = bar.x_of(told.position(marks[k]));
        if (told.lines && marks[k] > told.low && marks[k] < told.high) {
            const bool dark = is_dark_colour(told.colour_at(told.position(marks[k])));
            list.AddLine({x, bar.top}, {x, bar.bottom}, dark ? ink : IM_COL32(0, 0, 0, 255));
        }
        list.AddLine({x, bar.bottom}, {x, bar.bottom + 4.0F}, ink);
        if (k % every == 0) {
            list.AddText({text_left(marks[k]), bar.bottom + 4.0F}, ink, words_of(marks[k]).c_str());
        }
    }
}

/// A drag from one value to another is the range.
void choose_range(const ColourScale& scale, const Box& box, Look& look) {
    constexpr float least_drag = 4.0F;
    ImGui::SetCursorScreenPos({box.left, box.top});
    ImGui::InvisibleButton("range", {box.right - box.left, box.bottom - box.top});
    tip("Share of the area by value, over the colours of the scale.\nDrag: the range. Double click: that of "
        "the "
        "values.");
    if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
        look.range.reset();
        return;
    }
    const float start = ImGui::GetIO().MouseClickedPos[0].x;
    const float end = ImGui::GetIO().MousePos.x;
    if (std::abs(end - start) < least_drag) {
        return;
    }
    const double low = box.position_of(std::min(start, end));
    const double high = box.position_of(std::max(start, end));
    if (ImGui::IsItemActive()) {
        ImGui::GetWindowDrawList()->AddRectFilled({box.x_of(low), box.top}, {box.x_of(high), box.bottom},
                                                  IM_COL32(255, 255, 255, 70));
    } else if (ImGui::IsItemDeactivated()) {
        constexpr double least = 1e-6; // of the values: below that floats would not tell them apart
        const std::array<double, 2> range{scale.value_at(low), scale.value_at(high)};
        if (range[1] - range[0] > least * std::max(std::abs(range[0]), std::abs(range[1]))) {
            look.range = range;
        }
    }
}

constexpr float margin = 10.0F;
constexpr float pad = 9.0F;

/// @param above  height of what stands above the colours
float legend_height(float above) {
    return 2.0F * ImGui::GetTextLineHeight() + bar_height + above + 2.0F * pad + 10.0F;
}

struct LegendPlaces {
    Box bars; ///< above the colours
    Box bar;  ///< of the colours
};

/// Begins the window of a legend, with title, colours and marks; end_legend() ends it.
/// @param bars_height  of what stands above the colours
/// @param below        height of what stands below
/// @return nothing, and no window, where the view is too small
/// @param moved  by how much it was dragged; null: it stays
std::optional<LegendPlaces> begin_legend(const char* name, const Field& field,
                                         std::array<std::uint32_t, 2> view, float bars_height, float below,
                                         std::array<float, 2>* moved = nullptr) {
    const float width = std::min(380.0F, static_cast<float>(view[0]) - 2.0F * margin);
    const float line_height = ImGui::GetTextLineHeight();
    const float height = legend_height(bars_height);
    if (width < 150.0F || static_cast<float>(view[1]) < 2.5F * height + below) {
        return std::nullopt;
    }
    const std::array<float, 2> by = moved != nullptr ? *moved : std::array<float, 2>{};
    const auto inside = [](float wanted, float size, std::uint32_t room) { // of a view that became smaller
        return std::clamp(wanted, 0.0F, std::max(0.0F, static_cast<float>(room) - size));
    };
    const float left = inside(margin + by[0], width, view[0]);
    const float top = inside(static_cast<float>(view[1]) - margin - height - below + by[1], height, view[1]);
    const Box whole{left, top, left + width, top + height};
    ImGui::SetNextWindowPos({whole.left, whole.top});
    ImGui::SetNextWindowSize({width, height});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, IM_COL32(22, 24, 26, 225));
    ImGui::Begin(name, nullptr,
                 fixed_window | ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoFocusOnAppearing);
    if (moved != nullptr) {
        ImGui::SetCursorScreenPos({whole.left, whole.top});
        moving_area("move", {width, pad + line_height}, view, *moved);
        tip(legend_title(field.shown, field.scale, field.grey) + "\nDrag: moves the legend.");
    }
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddText({whole.left + pad, whole.top + pad - 2.0F}, ink,
                 legend_title(field.shown, field.scale, field.grey).c_str());
    const float above = whole.top + pad + line_height + 3.0F;
    const Box bars{whole.left + pad + 14.0F, above, whole.right - pad - 20.0F, above + bars_height};
    const Box bar{bars.left, bars.bottom + 2.0F, bars.right, bars.bottom + 2.0F + bar_height};
    draw_colours(list, field.scale, bar);
    draw_marks(list, legend_scale(field.shown, field.scale), bar, whole);
    const std::array<bool, 2> beyond = values_beyond(field.shown, field.scale);
    const float middle = 0.5F * (bar.top + bar.bottom - line_height);
    if (beyond[0]) {
        list.AddText({bar.left - 12.0F, middle}, ink, "<");
    }
    if (beyond[1]) {
        list.AddText({bar.right + 5.0F, middle}, ink, ">");
    }
    return LegendPlaces{bars, bar};
}

void end_legend() {
    ImGui::End();
    ImGui::PopStyleColor();
}

} // namespace

std::vector<double> area_histogram(const Field& field, const PatchMesh& mesh, std::size_t count) {
    std::vector<double> shares(count, 0.0);
    double known = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const double value = field.shown.values[i];
        if (std::isnan(value)) {
            continue;
        }
        known += mesh.areas()[i];
        const double place = field.scale.place(value);
        constexpr double rounding = 1e-9;
        if (place >= -rounding && place <= 1.0 + rounding) {
            const double step = std::clamp(std::floor(place * static_cast<double>(count)), 0.0,
                                           static_cast<double>(count) - 1.0);
            shares[static_cast<std::size_t>(step)] += mesh.areas()[i];
        }
    }
    for (double& share : shares) {
        share = known > 0.0 ? share / known : 0.0;
    }
    return shares;
}

void legend_window(const Field& field, const std::vector<double>& histogram,
                   std::array<std::uint32_t, 2> view, Choices& choices) {
    const auto places = begin_legend("legend", field, view, histogram_height, 0.0F, &choices.legend_moved);
    if (!places) {
        return;
    }
    draw_histogram(*ImGui::GetWindowDrawList(), histogram, places->bars);
    if (choices.look.shown.view == View::quantity) { // scales of form factors are the same for all patches
        choose_range(field.scale, {places->bar.left, places->bars.top, places->bar.right, places->bar.bottom},
                     choices.look);
    }
    end_legend();
}

void dots_legend_window(const Field& field, std::array<std::uint32_t, 2> view, bool above_other) {
    const float other = above_other ? legend_height(histogram_height) + margin : 0.0F;
    if (begin_legend("legend of dots", field, view, 0.0F, other)) {
        end_legend();
    }
}

} // namespace hemi::viewer
