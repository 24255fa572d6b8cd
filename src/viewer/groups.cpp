#include "viewer/groups.hpp"

#include "viewer/panels.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace hemi::viewer {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
/// Rows of the list before it scrolls.
constexpr int most_rows = 6;

std::string number(double value, int digits) {
    constexpr double long_number = 1e6;
    const double size = std::abs(value);
    return std::isnan(value)                                      ? "-"
           : size >= std::pow(10.0, digits) && size < long_number ? fmt::format("{:.0f}", value)
                                                                  : fmt::format("{:.{}g}", value, digits);
}

/// Whether a name has the letters that are searched for, small or capital.
bool matches(std::string_view name, std::string_view wanted) {
    const auto same = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
    };
    return std::search(name.begin(), name.end(), wanted.begin(), wanted.end(), same) != name.end();
}

/// A square: full, hollow, or a dash. @return whether it was clicked
bool visibility_button(Visibility visibility) {
    const float edge = ImGui::GetTextLineHeight();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const bool clicked = ImGui::InvisibleButton("visibility", {edge, edge});
    const bool hovered = ImGui::IsItemHovered();
    tip(std::string(to_word(visibility)) + "\nA click: the next of shown, outlines, hidden.");
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImU32 ink = ImGui::GetColorU32(hovered ? ImGuiCol_Text : ImGuiCol_TextDisabled);
    const ImVec2 low{corner.x + 2.0F, corner.y + 2.0F};
    const ImVec2 high{corner.x + edge - 2.0F, corner.y + edge - 2.0F};
    if (visibility == Visibility::shown) {
        list->AddRectFilled(low, high, ink);
    } else if (visibility == Visibility::outlines) {
        list->AddRect(low, high, ink);
    } else {
        const float middle = 0.5F * (low.y + high.y);
        list->AddLine({low.x + 2.0F, middle}, {high.x - 2.0F, middle}, ink);
    }
    return clicked;
}

Visibility next(Visibility visibility) {
    return visibility == Visibility::shown      ? Visibility::outlines
           : visibility == Visibility::outlines ? Visibility::hidden
                                                : Visibility::shown;
}

void group_row(const PanelContent& content, Choices& choices, std::uint32_t group, bool powers) {
    const std::vector<std::string>& names = content.document.input().mesh->groups();
    const GroupLine& line = content.groups.lines[group];
    ImGui::PushID(static_cast<int>(group));
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const Visibility visibility = choices.cut.of_group(group);
    if (visibility_button(visibility)) {
        set_visibility(choices, group, next(visibility), names.size());
    }
    ImGui::TableNextColumn();
    if (visibility != Visibility::shown) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    }
    const std::string name = names[group].empty() ? "(no name)" : names[group];
    if (list_line(name + "##name", choices.group == group, {},
                  ImGuiSelectableFlags_SpanAllColumns | ImGuiSelectableFlags_AllowItemOverlap)) {
        select_group(choices, group, *content.document.input().mesh);
    }
    if (visibility != Visibility::shown) {
        ImGui::PopStyleColor();
    }
    for (const std::string& cell : {number(line.area, 3), number(line.mean, 4)}) {
        ImGui::TableNextColumn();
        text(cell);
    }
    if (powers) {
        ImGui::TableNextColumn();
        text(number(line.net_power, 4));
    }
    ImGui::PopID();
}

void group_list(const PanelContent& content, Choices& choices) {
    const std::vector<std::string>& names = content.document.input().mesh->groups();
    std::vector<std::uint32_t> found;
    for (std::uint32_t g = 0; g < content.groups.lines.size(); ++g) {
        if (matches(names[g], choices.group_search.data())) {
            found.push_back(g);
        }
    }
    const bool powers = std::any_of(content.groups.lines.begin(), content.groups.lines.end(),
                                    [](const GroupLine& line) { return !std::isnan(line.net_power); });
    const int rows = std::clamp(static_cast<int>(found.size()), 1, most_rows) + 1;
    const float height = static_cast<float>(rows) * (ImGui::GetTextLineHeight() + 4.0F) + 4.0F;
    if (!ImGui::BeginTable("groups", powers ? 5 : 4,
                           ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_ScrollY,
                           {0.0F, height})) {
        return;
    }
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableSetupColumn("##shown");
    ImGui::TableSetupColumn("group", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("area");
    ImGui::TableSetupColumn("mean");
    if (powers) {
        ImGui::TableSetupColumn("net W");
    }
    const std::string unit = content.groups.unit.empty() ? "" : ", " + content.groups.unit;
    ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
    header_cell("##shown",
                "How much of the group is shown: full square all, hollow its outlines, dash nothing.");
    header_cell("group", "Surfaces of one name. A click selects them.");
    header_cell("area", "A, in m².");
    header_cell("mean", content.groups.quantity + unit + ": mean weighted with area.");
    if (powers) {
        header_cell("net W", "Q: net power of radiation, leaving positive; W.");
    }
    if (choices.group != choices.group_seen) { // as by a click in the scene
        choices.group_seen = choices.group;
        const auto row = choices.group ? std::find(found.begin(), found.end(), *choices.group) : found.end();
        if (row != found.end()) {
            const auto before = static_cast<float>(row - found.begin()) - 2.0F;
            ImGui::SetScrollY(std::max(before, 0.0F) * (ImGui::GetTextLineHeight() + 4.0F));
        }
    }
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(found.size()));
    while (clipper.Step()) {
        for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row) {
            group_row(content, choices, found[static_cast<std::size_t>(row)], powers);
        }
    }
    ImGui::EndTable();
}

} // namespace

GroupTable group_table(const Document& document, const ShownValues& values) {
    const ViewerInput& input = document.input();
    const PatchMesh& mesh = *input.mesh;
    const double metres = input.scene->unit.value_or(1.0);
    GroupTable table{values.title, values.unit, {}};
    table.lines.assign(mesh.groups().size(), {0.0, 0.0, none});
    std::vector<double> known(mesh.groups().size(), 0.0);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const double area = mesh.areas()[i] * metres * metres;
        GroupLine& line = table.lines[mesh.group(i)];
        line.area += area;
        if (!std::isnan(values.values[i])) {
            line.mean += area * values.values[i];
            known[mesh.group(i)] += area;
        }
    }
    const Heat* heat = document.heat();
    for (std::size_t g = 0; g < table.lines.size(); ++g) {
        table.lines[g].mean = known[g] > 0.0 ? table.lines[g].mean / known[g] : none;
        if (heat != nullptr && heat->problem.empty() && g < heat->groups.size()) {
            table.lines[g].net_power = heat->groups[g].net_power;
        }
    }
    return table;
}

std::vector<std::array<Vec3, 2>> group_edges(const PatchMesh& mesh, std::uint32_t group) {
    constexpr std::size_t most_edges = 600;
    std::vector<std::array<Vec3, 2>> edges;
    Bounds bounds;
    for (const Surface& surface : mesh.surfaces()) {
        if (surface.group != group) {
            continue;
        }
        for (std::size_t k = 0; k < surface.vertex_count; ++k) {
            bounds.add(surface.vertices[k]);
            if (edges.size() <= most_edges) {
                edges.push_back({surface.vertices[k], surface.vertices[(k + 1) % surface.vertex_count]});
            }
        }
    }
    if (edges.size() <= most_edges) {
        return edges;
    }
    edges.clear();
    const std::array<Vec3, 2> ends{bounds.lower, bounds.upper};
    for (int along = 0; along < 3; ++along) {
        for (std::size_t side = 0; side < 4; ++side) {
            Vec3 from = bounds.lower;
            from[(along + 1) % 3] = ends[side & 1][(along + 1) % 3];
            from[(along + 2) % 3] = ends[side >> 1][(along + 2) % 3];
            Vec3 to = from;
            to[along] = bounds.upper[along];
            edges.push_back({from, to});
        }
    }
    return edges;
}

void select_group(Choices& choices, std::uint32_t group, const PatchMesh& mesh) {
    choices.group = group;
    if (choices.picked && mesh.group(*choices.picked) != group) {
        choices.picked.reset();
    }
}

void isolate(Choices& choices, std::uint32_t group, std::size_t count) {
    choices.cut.groups.assign(count, Visibility::hidden);
    choices.cut.groups[group] = Visibility::shown;
}

void set_visibility(Choices& choices, std::uint32_t group, Visibility visibility, std::size_t count) {
    choices.cut.groups.resize(count, Visibility::shown);
    choices.cut.groups[group] = visibility;
    const auto is_shown = [](Visibility known) { return known == Visibility::shown; };
    if (std::all_of(choices.cut.groups.begin(), choices.cut.groups.end(), is_shown)) {
        choices.cut.groups.clear();
    }
}

void choose_groups_again(Choices& choices, const std::vector<std::string>& before,
                         const std::vector<std::string>& now) {
    const PictureCut cut = std::exchange(choices.cut, PictureCut{{}, choices.cut.clip});
    const std::optional<std::uint32_t> group = std::exchange(choices.group, std::nullopt);
    for (std::uint32_t g = 0; g < now.size(); ++g) {
        const auto found = std::find(before.begin(), before.end(), now[g]);
        if (found == before.end()) {
            continue;
        }
        const auto was = static_cast<std::uint32_t>(found - before.begin());
        set_visibility(choices, g, cut.of_group(was), now.size());
        choices.group = group == was ? std::optional(g) : choices.group;
    }
}

void groups_section(const PanelContent& content, Choices& choices) {
    if (!heading("Groups", "Surfaces by name: which are shown, their areas, means and net powers.")) {
        return;
    }
    const std::size_t count = content.document.input().mesh->groups().size();
    ImGui::SetNextItemWidth(-1.0F);
    ImGui::InputTextWithHint("##search", "search", choices.group_search.data(), choices.group_search.size());
    tip("Lists the groups with these letters in their names.");
    group_list(content, choices);
    const bool selected = choices.group.has_value();
    ImGui::BeginDisabled(!selected);
    if (button("Isolate", "Shows the selected group alone (I).")) {
        isolate(choices, *choices.group, count);
    }
    ImGui::SameLine();
    if (button("Outlines", "Only the outlines of the selected group (O).")) {
        set_visibility(choices, *choices.group, Visibility::outlines, count);
    }
    ImGui::SameLine();
    if (button("Hide", "Shows nothing of the selected group; its light stays (N).")) {
        set_visibility(choices, *choices.group, Visibility::hidden, count);
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(choices.cut.groups.empty());
    if (button("Show all", "Shows all groups (A).")) {
        choices.cut.groups.clear();
    }
    ImGui::EndDisabled();
}

} // namespace hemi::viewer
