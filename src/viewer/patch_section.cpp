#include "viewer/patch_section.hpp"

#include "hemi/scene/light_unit.hpp"
#include "viewer/panels.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <imgui.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <string>

namespace hemi::viewer {

namespace {

std::string number(double value) {
    return fmt::format("{:.4g}", value);
}

/// The channels of patch `i`, side by side.
std::string channels_text(std::span<const double> values, std::uint32_t channels, std::uint32_t i,
                          int digits = 3) {
    std::string result;
    for (std::uint32_t c = 0; c < channels; ++c) {
        result +=
            (c == 0 ? "" : "  ") + fmt::format("{:.{}g}", values[std::size_t{i} * channels + c], digits);
    }
    return result;
}

std::string temperature_text(double kelvin) {
    constexpr double zero_celsius = 273.15;
    return std::isnan(kelvin) ? "not known"
                              : fmt::format("{:.2f} K, {:.2f} °C", kelvin, kelvin - zero_celsius);
}

void patch_lines(const PanelContent& content, std::uint32_t i) {
    const ViewerInput& input = content.document.input();
    const Light& light = content.document.light();
    const Solution& solution = input.solution;
    const PatchMesh& mesh = *input.mesh;
    const Vec3& centre = mesh.centres()[i];
    const std::string unit = flux_density_unit(*input.scene);
    const double metres = input.scene->unit.value_or(1.0);
    const std::string channels_named =
        input.channels() < 2 ? ""
                             : fmt::format(" In this order: {}.", fmt::join(input.scene->channels, ", "));
    line("patch", std::to_string(i) + (mesh.is_back(i) ? " (back)" : ""),
         "Index i of the patch, from 0, in the scene's order; the back of a surface with two sides is one of "
         "its own.");
    line("group", mesh.groups()[mesh.group(i)], "Name of its surface.");
    line("material", input.scene->materials[mesh.material(i)].name, "Name of its material.");
    line("area m²", number(mesh.areas()[i] * metres * metres), "A, in m².");
    line("centre", fmt::format("{:.4g} {:.4g} {:.4g}", centre.x, centre.y, centre.z),
         "x, y and z of its centroid, in the scene's unit.");
    line("reflectance", channels_text(light.reflectance, input.channels(), i),
         "rho: share of what arrives that is reflected; no unit." + channels_named);
    line(("exitance " + unit).c_str(), channels_text(light.exitance, input.channels(), i),
         "M: flux that it emits by its area; " + unit + "." + channels_named);
    line(("radiosity " + unit).c_str(),
         light.knows(i) ? channels_text(light.radiosity, input.channels(), i) : "not known yet",
         "B = M + rho E: flux that leaves it by its area; " + unit + "." + channels_named);
    if (const Heat* heat = content.document.heat(); heat != nullptr && heat->problem.empty()) {
        const std::uint32_t channels = input.channels();
        line("T", temperature_text(heat->solution.temperature[i]), "T: temperature.");
        line("net flux W/m²", number(heat->solution.net_flux[i]),
             "q = J - G: net flux of radiation, leaving positive; W/m².");
        line("heat G W/m²", channels_text(heat->solution.irradiance, channels, i, 4),
             "G: irradiation, the thermal radiation that arrives; W/m², of every band.");
        line("heat J W/m²", channels_text(heat->solution.radiosity, channels, i, 4),
             "J: thermal radiation that leaves; W/m², of every band.");
    }
    if (!solution.row_sum.empty()) {
        const double defect =
            solution.row_sum[i] + solution.environment_share[i] + solution.back_face_share[i] - 1.0;
        line("row sum", fmt::format("{:.6f}  ({:+.1e})", solution.row_sum[i], defect),
             "Sum of F(i, j) over j: share that reaches other patches; no unit. In brackets: by how much it, "
             "e "
             "and b differ from 1.");
        line("environment", number(solution.environment_share[i]),
             "e: share that reaches nothing; no unit. Under a sky the sky view factor.");
        line("back faces", number(solution.back_face_share[i]),
             "b: share that meets backs of one-sided surfaces; no unit.");
    }
    if (input.solution.error) {
        line(("est. error " + unit).c_str(),
             channels_text(input.solution.error->patches, input.channels(), i, 1),
             "Estimated error of B that form factors make; " + unit + "." + channels_named);
    }
}

void heat_map_choice(Look& look) {
    const auto choose = [&look](const char* name, View view, const char* words) {
        const bool active = look.shown.view == view;
        if (active) {
            ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
        }
        if (button(name, words)) {
            look.shown = {active ? View::picture : view};
        }
        if (active) {
            ImGui::PopStyleColor();
        }
    };
    ImGui::AlignTextToFramePadding();
    text("Heat map of F:");
    ImGui::SameLine();
    choose("row", View::row, "F(i, j) of the picked patch i: share of what leaves i that arrives at j (H).");
    ImGui::SameLine();
    choose("column", View::column,
           "F(j, i) of the picked patch i: share of what leaves j that arrives at i (H).");
}

void partner_list(const PanelContent& content, Choices& choices) {
    const bool column = choices.look.shown.view == View::column;
    ImGui::AlignTextToFramePadding();
    text("Largest by");
    ImGui::SameLine();
    choice("factor", false, choices.partners_by_light, "Those with the largest form factor first.");
    ImGui::SameLine();
    choice("light received", true, choices.partners_by_light, "Those that send most light first.");
    if (!ImGui::BeginTable("partners", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) {
        return;
    }
    ImGui::TableSetupColumn("patch j");
    ImGui::TableSetupColumn("group", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn(column ? "F(j, i)" : "F(i, j)");
    ImGui::TableSetupColumn("light");
    ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
    header_cell("patch j", "Index of the other patch. A click picks it, pointing at it marks it.");
    header_cell("group", "Name of its surface.");
    header_cell(column ? "F(j, i)" : "F(i, j)", column
                                                    ? "Share of what leaves j that arrives at i; no unit."
                                                    : "Share of what leaves i that arrives at j; no unit.");
    header_cell("light", "Share of the light that arrives at i from all patches; %.");
    const PatchMesh& mesh = *content.document.input().mesh;
    for (const Partner& partner : content.picked->partners) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        const std::string name = std::to_string(partner.patch);
        if (list_line(name, false, {}, ImGuiSelectableFlags_SpanAllColumns)) {
            choices.picked = partner.patch;
        }
        if (ImGui::IsItemHovered()) {
            choices.pointed_at = partner.patch;
        }
        ImGui::TableNextColumn();
        text(mesh.groups()[mesh.group(partner.patch)]);
        ImGui::TableNextColumn();
        text(fmt::format("{:.2e}", partner.factor));
        ImGui::TableNextColumn();
        text(fmt::format("{:4.1f} % ", 100.0 * partner.share));
    }
    ImGui::EndTable();
}

} // namespace

void patch_section(const PanelContent& content, Choices& choices) {
    if (!heading("Patch", "The patch that was clicked.")) {
        return;
    }
    if (!content.picked) {
        faint("Click a patch to see what it is and whom it sees.");
        return;
    }
    patch_lines(content, content.picked->patch);
    checkbox("hemicube: what the patch sees", choices.hemicube,
             "What is seen from the patch, unfolded, at the resolution of the solution (C).");
    ImGui::Spacing();
    const ViewerInput& input = content.document.input();
    if (input.factors == nullptr) {
        faint(fmt::format("No row of F: {}.", why_not({View::row}, input, choices.picked)));
        return;
    }
    heat_map_choice(choices.look);
    if (input.factors->matrix.clusters() != nullptr) {
        faint("Far patches stand in clusters, whose factors are shared out among them by area.");
    }
    partner_list(content, choices);
}

} // namespace hemi::viewer
