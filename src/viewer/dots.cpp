#include "viewer/dots.hpp"

#include "display/false_colour_scale.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/core/text.hpp"
#include "viewer/command_line.hpp"
#include "viewer/legend_window.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace hemi::viewer {

namespace {

/// What a dot is and has, and where it is.
std::array<std::string, 2> words_of_dot(const ViewerInput& input, const Look& look, std::size_t dot) {
    const Vec3& at = input.points->positions[dot];
    std::string words = fmt::format("point {}", dot);
    if (look.dots_column) {
        const PointTable::Column& column = input.points->columns[*look.dots_column];
        const double value = column.values[dot];
        words += std::isnan(value) ? fmt::format(": {} has no value", column.name)
                                   : fmt::format(": {} {:.6g} {}", column.name, value, column.unit);
    }
    return {words, fmt::format("at {:.4g} {:.4g} {:.4g}", at.x, at.y, at.z)};
}

void dot_label(const std::array<std::string, 2>& words, std::array<double, 2> cursor,
               std::array<std::uint32_t, 2> view) {
    constexpr float pad = 5.0F;
    constexpr float aside = 14.0F;
    const ImVec2 first = ImGui::CalcTextSize(words[0].c_str());
    const ImVec2 second = ImGui::CalcTextSize(words[1].c_str());
    const float width = std::max(first.x, second.x) + 2.0F * pad;
    const float height = 2.0F * ImGui::GetTextLineHeight() + 2.0F * pad;
    const auto inside = [](float wanted, float size, std::uint32_t room) {
        return std::max(0.0F, std::min(wanted, static_cast<float>(room) - size));
    };
    const ImVec2 at{inside(static_cast<float>(cursor[0]) + aside, width, view[0]),
                    inside(static_cast<float>(cursor[1]) + aside, height, view[1])};
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    list->AddRectFilled(at, {at.x + width, at.y + height}, IM_COL32(22, 24, 26, 235), 3.0F);
    const ImU32 ink = IM_COL32(235, 235, 235, 255);
    list->AddText({at.x + pad, at.y + pad}, ink, words[0].c_str());
    list->AddText({at.x + pad, at.y + pad + ImGui::GetTextLineHeight()}, ink, words[1].c_str());
}

} // namespace

std::optional<Dots> dots_of(const ViewerInput& input, const Look& look) {
    return input.points && look.dots
               ? std::optional(make_dots(*input.points, look.dots_column, input.mesh->bounds()))
               : std::nullopt;
}

std::optional<std::size_t> column_again(const ViewerInput& before, const ViewerInput& now,
                                        std::optional<std::size_t> column) {
    if (!before.points || !now.points || !column) {
        return before.points && now.points ? std::nullopt : now.dots_column;
    }
    const std::string& name = before.points->columns[*column].name;
    const auto& columns = now.points->columns;
    const auto found = std::find_if(columns.begin(), columns.end(),
                                    [&name](const PointTable::Column& other) { return other.name == name; });
    return found == columns.end() ? now.dots_column
                                  : std::optional(static_cast<std::size_t>(found - columns.begin()));
}

std::optional<std::size_t> dot_at(const Dots& dots, const PictureCut& cut, const ViewRay& ray,
                                  const std::optional<Vec3>& surface) {
    const Vec3 way = glm::normalize(ray.direction);
    double nearest = surface ? glm::dot(*surface - ray.origin, way) + dots.radius
                             : std::numeric_limits<double>::infinity();
    std::optional<std::size_t> found;
    for (std::size_t k = 0; k < dots.positions.size(); ++k) {
        const Vec3 to = dots.positions[k] - ray.origin;
        const double along = glm::dot(to, way);
        const double beside = glm::length(to - along * way);
        if (along > 0.0 && along < nearest && beside <= dots.radius && cut.keeps(dots.positions[k])) {
            nearest = along;
            found = k;
        }
    }
    return found;
}

void choose_dots(const ViewerInput& input, std::string_view name, Look& look) {
    if (!input.points) {
        throw InvalidArgument("there are no points: --points FILE.csv");
    }
    if (name == "none") {
        look.dots = false;
        return;
    }
    std::vector<std::string> names;
    for (const PointTable::Column& column : input.points->columns) {
        names.push_back(column.name);
    }
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
        throw InvalidArgument(fmt::format("points have no column \"{}\"{}", name,
                                          did_you_mean_or_list(std::string(name), names)));
    }
    look.dots = true;
    look.dots_column = static_cast<std::size_t>(found - names.begin());
}

std::string dots_options(const ViewerInput& input, const Look& look, std::string_view command) {
    if (!input.points || !look.dots) {
        return {};
    }
    if (!command.starts_with("hemi render ")) {
        throw InvalidArgument("points are drawn by `hemi render`: save the result, then copy the command "
                              "line, or hide them");
    }
    return " --points " + quoted(input.points_file.string()) + " --column " +
           (look.dots_column ? quoted(input.points->columns[*look.dots_column].name) : std::string("none"));
}

void dots_section(const ViewerInput& input, Choices& choices) {
    if (!input.points || !heading("Points", "Points of a table, as dots in the scene.")) {
        return;
    }
    Look& look = choices.look;
    const std::string shown = !look.dots         ? "not shown"
                              : look.dots_column ? input.points->columns[*look.dots_column].name
                                                 : "where they are";
    if (begin_list("##dots", shown, -1.0F,
                   "The column of the table that colours the dots, in its own unit.")) {
        for (std::size_t k = 0; k < input.points->columns.size(); ++k) {
            if (list_line(input.points->columns[k].name, look.dots && look.dots_column == k,
                          input.points->columns[k].unit)) {
                look.dots = true;
                look.dots_column = k;
            }
        }
        if (list_line("where they are", look.dots && !look.dots_column, "White dots.")) {
            look.dots = true;
            look.dots_column.reset();
        }
        if (list_line("not shown", !look.dots)) {
            look.dots = false;
        }
        ImGui::EndCombo();
    }
    text(plural(input.points->positions.size(), "point", "points"));
}

void dots_overlay(const SceneView& scene, const ViewerInput& input, const Look& look,
                  std::optional<std::size_t> under_cursor, std::array<double, 2> cursor,
                  std::array<std::uint32_t, 2> view) {
    if (!scene.dots()) {
        return;
    }
    const FalseColours& shown = scene.dots()->shown;
    if (!shown.values.empty()) {
        dots_legend_window({shown, scale_of(shown), "no value"}, view, scene.field().has_value());
    }
    if (under_cursor) {
        dot_label(words_of_dot(input, look, *under_cursor), cursor, view);
    }
}

} // namespace hemi::viewer
