#include "viewer/material_sections.hpp"

#include "hemi/scene/light_unit.hpp"
#include "viewer/panels.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace hemi::viewer {

namespace {

/// A slider for every temperature that is given.
void temperature_sliders(const ViewerInput& input, Choices& choices) {
    constexpr double above = 1.5;
    double hottest = 0.0;
    for (const HeatCondition& condition : input.heat->conditions) {
        hottest = std::max(hottest, condition.temperature.value_or(0.0));
    }
    const auto most = static_cast<float>(hottest > 0.0 ? above * hottest : 1000.0);
    const std::vector<std::string> names = condition_names(input);
    for (std::size_t c = 0; c < names.size(); ++c) {
        std::optional<double>& kelvin = choices.conditions[c].temperature;
        if (!kelvin || names[c].empty()) {
            continue;
        }
        ImGui::PushID(static_cast<int>(c));
        auto shown = static_cast<float>(*kelvin);
        if (slider(names[c].c_str(), shown, 0.0F, most, "%.0f K", -120.0F,
                   "T, the temperature that is given for " + names[c] + "; K.")) {
            kelvin = static_cast<double>(shown);
        }
        ImGui::PopID();
    }
    if (choices.conditions != input.heat->conditions &&
        button("Temperatures as in the scene", "Takes back all changes of temperatures.")) {
        choices.conditions = input.heat->conditions;
    }
}

} // namespace

void heat_section(const PanelContent& content, Choices& choices) {
    if (content.document.input().heat == nullptr ||
        !heading("Heat", "Temperatures and net powers of the groups.")) {
        return;
    }
    const Heat* heat = content.document.heat();
    if (heat == nullptr) {
        faint("Found once there are form factors.");
        return;
    }
    temperature_sliders(content.document.input(), choices);
    if (!heat->problem.empty()) {
        faint(heat->problem);
        return;
    }
    if (!ImGui::BeginTable("heat", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) {
        return;
    }
    ImGui::TableSetupColumn("group", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("T K");
    ImGui::TableSetupColumn("W/m²");
    ImGui::TableSetupColumn("net W");
    ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
    header_cell("group", "Surfaces of one name.");
    header_cell("T K", "T: the group's temperature, the mean of T^4 by area to the 1/4; K.");
    header_cell("W/m²", "q: mean net flux of radiation, leaving positive; W/m².");
    header_cell("net W", "Q: net power of radiation, leaving positive; W.");
    const std::vector<std::string>& names = content.document.input().mesh->groups();
    for (std::size_t g = 0; g < heat->groups.size(); ++g) {
        const GroupHeat& group = heat->groups[g];
        ImGui::TableNextRow();
        for (const std::string& cell :
             {g < names.size() ? names[g] : std::string("(all)"),
              std::isnan(group.temperature) ? std::string("-") : fmt::format("{:.1f}", group.temperature),
              fmt::format("{:.4g}", group.net_flux), fmt::format("{:.5g}", group.net_power)}) {
            ImGui::TableNextColumn();
            text(cell);
        }
    }
    ImGui::EndTable();
}

namespace {

/// Highest reflectance that a slider gives.
constexpr float most_reflectance = 0.98F;

/// A slider for every channel, side by side, or one for all where they are many.
/// @param beyond  whether numbers above `most` can be typed
void channel_sliders(const char* name, std::vector<double>& values, float most, bool beyond,
                     const char* format, const std::string& words) {
    constexpr std::size_t most_sliders = 4;
    const int count = values.size() > most_sliders ? 1 : static_cast<int>(values.size());
    std::array<float, most_sliders> shown{};
    for (int c = 0; c < count; ++c) {
        shown[static_cast<std::size_t>(c)] = static_cast<float>(values[static_cast<std::size_t>(c)]);
    }
    if (sliders(name, shown.data(), count, most, beyond, format, -86.0F, words)) {
        for (std::size_t c = 0; c < values.size(); ++c) {
            const float value = shown[values.size() > most_sliders ? 0 : c];
            if (value != static_cast<float>(values[c])) {        // others keep their digits
                values[c] = std::stod(fmt::format("{}", value)); // 0.3, not the float next to it
            }
        }
    }
}

/// Which slider is of which channel; nothing of one channel.
std::string channels_text(const Scene& scene) {
    return scene.channels.size() < 2 ? std::string()
                                     : fmt::format(", of {}", fmt::join(scene.channels, ", "));
}

} // namespace

void material_section(const PanelContent& content, Choices& choices) {
    if (!heading("Materials", "What materials reflect and emit, and the environment.")) {
        return;
    }
    const ViewerInput& input = content.document.input();
    if (input.factors == nullptr) {
        faint(input.factor_settings
                  ? "Light follows changes of materials once there are form factors."
                  : "Light cannot follow a change without form factors: open the scene instead of its "
                    "result.");
        return;
    }
    double brightest = 0.0;
    for (const Material& material : input.scene->materials) {
        brightest =
            std::max(brightest, *std::max_element(material.exitance.begin(), material.exitance.end()));
    }
    const auto most_exitance = static_cast<float>(brightest > 0.0 ? 2.0 * brightest : 10.0);
    const std::string unit = flux_density_unit(*input.scene);
    const std::string of = channels_text(*input.scene);
    for (std::size_t m = 0; m < choices.materials.size(); ++m) {
        Material& material = choices.materials[m];
        ImGui::PushID(static_cast<int>(m));
        const bool lamp = *std::max_element(material.exitance.begin(), material.exitance.end()) > 0.0;
        if (ImGui::TreeNodeEx(material.name.empty() ? "(no name)" : material.name.c_str(),
                              ImGuiTreeNodeFlags_SpanAvailWidth | ImGuiTreeNodeFlags_NoTreePushOnOpen |
                                  (lamp ? ImGuiTreeNodeFlags_DefaultOpen : 0))) {
            channel_sliders("reflectance", material.reflectance, most_reflectance, false, "%.2f",
                            "rho: share of what arrives that is reflected" + of + "; no unit.");
            channel_sliders("exitance", material.exitance, most_exitance, true, "%.3g",
                            "M: flux that is emitted by area" + of + "; " + unit + ".");
            if (material != input.scene->materials[m] &&
                small_button("as in the scene", "Takes back all changes of this material.")) {
                material = input.scene->materials[m];
            }
        }
        ImGui::PopID();
    }
    const std::vector<double> environment = input.environment();
    double brightest_environment = *std::max_element(environment.begin(), environment.end());
    brightest_environment =
        brightest_environment > 0.0 ? 2.0 * brightest_environment : static_cast<double>(most_exitance);
    text("environment");
    channel_sliders("exitance##environment", choices.environment, static_cast<float>(brightest_environment),
                    true, "%.3g",
                    "B_env, pi times the radiance that comes from the environment" + of + "; " + unit + ".");
    const bool changed = choices.materials != input.scene->materials || choices.environment != environment;
    if (changed && button("All as in the scene", "Takes back all changes of materials and environment.")) {
        choices.materials = input.scene->materials;
        choices.environment = environment;
    }
    if (changed && input.file.extension() == ".json" &&
        button("Write into the scene ...",
               "Writes what was changed into the scene's JSON file, after asking.")) {
        choices.asks_to_write = true;
    }
}

} // namespace hemi::viewer
