#include "viewer/panels.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hemi::viewer {

namespace {

constexpr std::uint32_t side_width = 312;
constexpr std::uint32_t smallest_width = 640;
constexpr std::uint32_t smallest_height = 360;
constexpr double most_stops = 10.0;

constexpr ImGuiWindowFlags fixed_window = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                          ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                                          ImGuiWindowFlags_NoSavedSettings;

void text(const std::string& words) {
    ImGui::TextUnformatted(words.c_str());
}

void faint(const std::string& words) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::PushTextWrapPos(0.0F);
    text(words);
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

/// A name on the left, a value in a column of its own.
void line(const char* name, const std::string& value) {
    constexpr float value_at = 118.0F;
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextUnformatted(name);
    ImGui::PopStyleColor();
    ImGui::SameLine(value_at);
    text(value);
}

bool heading(const char* name) {
    return ImGui::CollapsingHeader(name, ImGuiTreeNodeFlags_DefaultOpen);
}

/// Two or three words of which one is chosen.
template <typename Value>
void choice(const char* name, Value value, Value& chosen) {
    if (ImGui::RadioButton(name, chosen == value)) {
        chosen = value;
    }
}

void quantity_combo(const PanelContent& content, Choices& choices) {
    ImGui::SetNextItemWidth(-1.0F);
    if (!ImGui::BeginCombo("##quantity", quantity_title(choices.look.quantity),
                           ImGuiComboFlags_HeightLarge)) {
        return;
    }
    for (const QuantityName& name : quantity_names()) {
        const char* problem = why_not(name.quantity, content.input, choices.picked);
        const ImGuiSelectableFlags flags = problem != nullptr ? ImGuiSelectableFlags_Disabled : 0;
        if (ImGui::Selectable(name.title, name.quantity == choices.look.quantity, flags)) {
            choices.look.quantity = name.quantity;
        }
        if (problem != nullptr && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
            ImGui::SetTooltip("%s", problem);
        }
    }
    ImGui::EndCombo();
}

void channel_choice(const ViewerInput& input, Look& look) {
    if (input.channels == 1) {
        return;
    }
    const std::string shown = look.channel ? input.scene->channels[*look.channel] : "mean of channels";
    ImGui::SetNextItemWidth(-1.0F);
    if (ImGui::BeginCombo("##channel", shown.c_str())) {
        if (ImGui::Selectable("mean of channels", !look.channel)) {
            look.channel.reset();
        }
        for (std::uint32_t c = 0; c < input.channels; ++c) {
            if (ImGui::Selectable(input.scene->channels[c].c_str(), look.channel == c)) {
                look.channel = c;
            }
        }
        ImGui::EndCombo();
    }
}

void scale_choice(bool& logarithmic) {
    choice("linear", false, logarithmic);
    ImGui::SameLine();
    choice("logarithmic", true, logarithmic);
}

void picture_choices(Look& look) {
    choice("Gouraud", Shading::gouraud, look.shading);
    ImGui::SameLine();
    choice("flat", Shading::flat, look.shading);
    auto stops = static_cast<float>(look.stops);
    ImGui::SetNextItemWidth(-72.0F);
    if (ImGui::SliderFloat("Exposure", &stops, static_cast<float>(-most_stops),
                           static_cast<float>(most_stops), "%+.1f stops", ImGuiSliderFlags_NoInput)) {
        look.stops = static_cast<double>(stops);
    }
    choice("filmic", ToneMapping::filmic, look.tone_mapping);
    ImGui::SameLine();
    choice("linear tone mapping", ToneMapping::linear, look.tone_mapping);
}

void show_section(const PanelContent& content, Choices& choices) {
    if (!heading("Show")) {
        return;
    }
    Look& look = choices.look;
    quantity_combo(content, choices);
    switch (look.quantity) {
    case Quantity::picture:
        picture_choices(look);
        break;
    case Quantity::radiosity:
    case Quantity::exitance:
    case Quantity::estimated_error:
        channel_choice(content.input, look);
        scale_choice(look.logarithmic);
        break;
    case Quantity::reflectance:
        channel_choice(content.input, look);
        break;
    case Quantity::row:
    case Quantity::column:
        scale_choice(look.logarithmic_factors);
        break;
    case Quantity::outlines:
    case Quantity::items:
    case Quantity::row_error:
        break;
    }
    if (look.quantity != Quantity::outlines) {
        ImGui::Checkbox("patch outlines", &look.outlines);
    }
}

std::string number(double value) {
    return fmt::format("{:.4g}", value);
}

/// The channels of patch `i`, side by side.
std::string channels_text(std::span<const double> values, std::uint32_t channels, std::uint32_t i) {
    std::string result;
    for (std::uint32_t c = 0; c < channels; ++c) {
        result += (c == 0 ? "" : "  ") + fmt::format("{:.3g}", values[std::size_t{i} * channels + c]);
    }
    return result;
}

void patch_lines(const PanelContent& content, std::uint32_t i) {
    const ViewerInput& input = content.input;
    const PatchMesh& mesh = *input.mesh;
    const Vec3& centre = mesh.centres()[i];
    line("patch", std::to_string(i) + (mesh.is_back(i) ? " (back)" : ""));
    line("group", mesh.groups()[mesh.group(i)]);
    line("material", input.scene->materials[mesh.material(i)].name);
    line("area", number(mesh.areas()[i]));
    line("centre", fmt::format("{:.4g} {:.4g} {:.4g}", centre.x, centre.y, centre.z));
    line("reflectance", channels_text(content.light.reflectance, input.channels, i));
    line("exitance W/m²", channels_text(content.light.exitance, input.channels, i));
    line("radiosity W/m²", channels_text(content.light.radiosity, input.channels, i));
    if (!input.row_sum.empty()) {
        const double defect = input.row_sum[i] + input.environment_share[i] + input.blocked[i] - 1.0;
        const bool known = input.factors == nullptr || input.factors->known(i);
        line("row sum", known ? fmt::format("{:.6f}  ({:+.1e})", input.row_sum[i], defect) : "not computed");
        line("environment", number(input.environment_share[i]));
        line("blocked", number(input.blocked[i]));
    }
    if (!input.radiosity_error.empty()) {
        line("est. error W/m²", channels_text(input.radiosity_error, input.channels, i));
    }
}

void heat_map_choice(Look& look) {
    const auto button = [&look](const char* name, Quantity quantity) {
        const bool active = look.quantity == quantity;
        if (active) {
            ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
        }
        if (ImGui::Button(name)) {
            look.quantity = active ? Quantity::picture : quantity;
        }
        if (active) {
            ImGui::PopStyleColor();
        }
    };
    ImGui::AlignTextToFramePadding();
    text("Heat map of F:");
    ImGui::SameLine();
    button("row", Quantity::row);
    ImGui::SameLine();
    button("column", Quantity::column);
}

void partner_list(const PanelContent& content, Choices& choices) {
    const bool column = choices.look.quantity == Quantity::column;
    ImGui::AlignTextToFramePadding();
    text("Largest by");
    ImGui::SameLine();
    choice("factor", false, choices.partners_by_light);
    ImGui::SameLine();
    choice("light received", true, choices.partners_by_light);
    if (!ImGui::BeginTable("partners", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) {
        return;
    }
    ImGui::TableSetupColumn("patch j");
    ImGui::TableSetupColumn("group", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn(column ? "F(j, i)" : "F(i, j)");
    ImGui::TableSetupColumn("light");
    ImGui::TableHeadersRow();
    const PatchMesh& mesh = *content.input.mesh;
    for (const Partner& partner : content.picked->partners) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        const std::string name = std::to_string(partner.patch);
        if (ImGui::Selectable(name.c_str(), false, ImGuiSelectableFlags_SpanAllColumns)) {
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
        text(fmt::format("{:4.1f} %", 100.0 * partner.share));
    }
    ImGui::EndTable();
}

void patch_section(const PanelContent& content, Choices& choices) {
    if (!heading("Patch")) {
        return;
    }
    if (!content.picked) {
        faint("Click a patch to see what it is and whom it sees.");
        return;
    }
    patch_lines(content, content.picked->patch);
    ImGui::Checkbox("hemicube: what the patch sees", &choices.hemicube);
    ImGui::Spacing();
    if (content.input.factors == nullptr) {
        faint(fmt::format("No row of F: {}.", why_not(Quantity::row, content.input, choices.picked)));
        return;
    }
    heat_map_choice(choices.look);
    partner_list(content, choices);
}

/// Highest reflectance that a slider gives.
constexpr float most_reflectance = 0.98F;

/// A slider for every channel, side by side, or one for all where they are many.
void channel_sliders(const char* name, std::vector<double>& values, float most, const char* format) {
    constexpr std::size_t most_sliders = 4;
    const int count = values.size() > most_sliders ? 1 : static_cast<int>(values.size());
    std::array<float, most_sliders> shown{};
    for (int c = 0; c < count; ++c) {
        shown[static_cast<std::size_t>(c)] = static_cast<float>(values[static_cast<std::size_t>(c)]);
    }
    const float least = 0.0F;
    ImGui::SetNextItemWidth(-86.0F);
    if (ImGui::SliderScalarN(name, ImGuiDataType_Float, shown.data(), count, &least, &most, format,
                             ImGuiSliderFlags_NoInput)) {
        for (std::size_t c = 0; c < values.size(); ++c) {
            const float value = shown[values.size() > most_sliders ? 0 : c];
            if (value != static_cast<float>(values[c])) { // others keep their digits
                values[c] = static_cast<double>(value);
            }
        }
    }
}

void material_section(const PanelContent& content, Choices& choices) {
    if (!heading("Materials")) {
        return;
    }
    const ViewerInput& input = content.input;
    if (input.factors == nullptr) {
        faint(input.solve
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
    for (std::size_t m = 0; m < choices.materials.size(); ++m) {
        Material& material = choices.materials[m];
        ImGui::PushID(static_cast<int>(m));
        const bool lamp = *std::max_element(material.exitance.begin(), material.exitance.end()) > 0.0;
        if (ImGui::TreeNodeEx(material.name.empty() ? "(no name)" : material.name.c_str(),
                              ImGuiTreeNodeFlags_SpanAvailWidth | ImGuiTreeNodeFlags_NoTreePushOnOpen |
                                  (lamp ? ImGuiTreeNodeFlags_DefaultOpen : 0))) {
            if (content.without_rows[m]) {
                faint("reflects nothing; its form factors were not computed");
            } else {
                channel_sliders("reflectance", material.reflectance, most_reflectance, "%.2f");
            }
            channel_sliders("exitance", material.exitance, most_exitance, "%.3g");
        }
        ImGui::PopID();
    }
    if (choices.materials != input.scene->materials && ImGui::Button("As in the scene")) {
        choices.materials = input.scene->materials;
    }
    if (!content.relit.empty()) {
        faint(content.relit);
    }
}

} // namespace

std::uint32_t panel_width(std::array<std::uint32_t, 2> window, bool wanted) {
    return wanted && window[0] >= smallest_width && window[1] >= smallest_height ? side_width : 0;
}

void side_panel(const PanelContent& content, std::array<std::uint32_t, 2> window, Choices& choices) {
    choices.pointed_at.reset();
    const auto width = static_cast<float>(side_width);
    ImGui::SetNextWindowPos({static_cast<float>(window[0]) - width, 0.0F});
    ImGui::SetNextWindowSize({width, static_cast<float>(window[1])});
    ImGui::Begin("panel", nullptr, fixed_window);
    const float foot = ImGui::GetTextLineHeightWithSpacing() * 2.0F + 6.0F;
    if (!content.solving.empty()) {
        ImGui::ProgressBar(static_cast<float>(content.solved_share), {-1.0F, 0.0F});
        faint(content.solving);
        ImGui::SameLine(width - 74.0F);
        choices.cancel = ImGui::SmallButton("Cancel") || choices.cancel;
        ImGui::Separator();
    }
    ImGui::BeginChild("sections", {0.0F, -foot});
    show_section(content, choices);
    patch_section(content, choices);
    material_section(content, choices);
    ImGui::EndChild();
    ImGui::Separator();
    faint(content.status);
    faint("F1 help   Tab panel");
    ImGui::End();
}

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
    const bool has_none =
        std::any_of(field.values.begin(), field.values.end(), [](double v) { return std::isnan(v); });
    const std::string title =
        field.title + (has_none ? "; grey: 0" : "") + (field.unit.empty() ? "" : "  [" + field.unit + "]");
    list->AddText({origin.x + pad, origin.y + pad - 2.0F}, ink, title.c_str());

    const float left = origin.x + pad + 14.0F;
    const float right = origin.x + width - pad - 20.0F;
    const float top = origin.y + pad + line_height + 3.0F;
    const float bottom = top + 12.0F;
    const auto colour = [](double position) {
        const std::array<float, 3> linear = scale_colour(position);
        const auto encode = [](float value) {
            const float srgb =
                value <= 0.0031308F ? 12.92F * value : 1.055F * std::pow(value, 1.0F / 2.4F) - 0.055F;
            return static_cast<int>(std::lround(255.0F * srgb));
        };
        return IM_COL32(encode(linear[0]), encode(linear[1]), encode(linear[2]), 255);
    };
    constexpr int steps = 40;
    for (int k = 0; k < steps; ++k) {
        const float from = left + (right - left) * static_cast<float>(k) / steps;
        const float to = left + (right - left) * static_cast<float>(k + 1) / steps;
        const ImU32 first = colour(static_cast<double>(k) / steps);
        const ImU32 last = colour(static_cast<double>(k + 1) / steps);
        list->AddRectFilledMultiColor({from, top}, {to, bottom}, first, last, last, first);
    }
    for (const double mark : field.scale.marks()) {
        const float x = left + (right - left) * static_cast<float>(field.scale.position(mark));
        list->AddLine({x, bottom}, {x, bottom + 4.0F}, ink);
        const std::string words = fmt::format("{:.3g}", mark);
        const float half = 0.5F * ImGui::CalcTextSize(words.c_str()).x;
        list->AddText({x - half, bottom + 4.0F}, ink, words.c_str());
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

void mark_patch(const PatchMesh& mesh, std::uint32_t patch, const OrbitCamera& orbit,
                std::array<std::uint32_t, 2> view, bool picked) {
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const auto pixel = [&view](const std::array<double, 2>& place) {
        return ImVec2(static_cast<float>(0.5 * view[0] + place[0] * view[1]),
                      static_cast<float>((0.5 - place[1]) * view[1]));
    };
    const PatchCorners corners = mesh.corners(patch);
    for (std::size_t k = 0; k < corners.count; ++k) {
        if (const auto line = orbit.line(corners.points[k], corners.points[(k + 1) % corners.count])) {
            const ImVec2 a = pixel((*line)[0]);
            const ImVec2 b = pixel((*line)[1]);
            list->AddLine(a, b, IM_COL32(0, 0, 0, 255), 4.0F);
            list->AddLine(a, b, picked ? IM_COL32(255, 255, 255, 255) : IM_COL32(255, 80, 200, 255), 2.0F);
        }
    }
}

void help_window(std::array<std::uint32_t, 2> view, bool& open) {
    ImGui::SetNextWindowPos({0.5F * static_cast<float>(view[0]), 0.5F * static_cast<float>(view[1])},
                            ImGuiCond_Always, {0.5F, 0.5F});
    ImGui::SetNextWindowBgAlpha(0.95F);
    if (!ImGui::Begin("Mouse and keys", &open,
                      ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                          ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings)) {
        ImGui::End();
        return;
    }
    constexpr std::array<std::array<const char*, 2>, 21> lines{
        {{"left drag", "orbit about the point under the cursor"},
         {"middle drag, shift + left drag", "pan"},
         {"wheel, right drag", "zoom at the cursor"},
         {"left click", "pick a patch; beside the scene: none"},
         {"", ""},
         {"F", "frame everything"},
         {"R", "back to the scene's own camera"},
         {"1  3  7", "from the front, the right, above"},
         {"S", "Gouraud or flat"},
         {"W", "patch outlines"},
         {"T", "filmic or linear tone mapping"},
         {"E, shift + E", "brighter, darker by a third of a stop"},
         {"V, shift + V", "next quantity, previous one"},
         {"H", "heat map of the picked patch: row of F, column, none"},
         {"C", "hemicube of the picked patch"},
         {"L", "linear or logarithmic scale"},
         {"P, shift + P", "screenshot of the picture, of the whole window"},
         {"Tab", "side panel"},
         {"F1", "this page"},
         {"Esc", "closes this page, lets go of the patch, quits"},
         {"Q", "quits"}}};
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
        for (const auto& [keys, meaning] : lines) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(keys);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(meaning);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

std::vector<Partner> largest_partners(const ViewerInput& input, const Light& light, std::uint32_t picked,
                                      bool column, bool by_light, std::size_t count) {
    const FormFactorMatrix& factors = *input.factors;
    const RowView row = factors.row(picked);
    std::vector<double> arriving(factors.size(), 0.0);
    double total = 0.0;
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        const std::uint32_t j = row.columns[k];
        for (std::uint32_t c = 0; c < input.channels; ++c) {
            arriving[j] +=
                static_cast<double>(row.values[k]) * light.radiosity[std::size_t{j} * input.channels + c];
        }
        total += arriving[j];
    }
    const std::vector<double> values = column ? factors_to(factors, picked) : factors_from(factors, picked);
    std::vector<Partner> partners;
    for (std::uint32_t j = 0; j < factors.size(); ++j) {
        if (values[j] > 0.0 || arriving[j] > 0.0) {
            partners.push_back({j, values[j], total > 0.0 ? arriving[j] / total : 0.0});
        }
    }
    const std::size_t kept = std::min(count, partners.size());
    std::partial_sort(partners.begin(), partners.begin() + static_cast<std::ptrdiff_t>(kept), partners.end(),
                      [by_light](const Partner& a, const Partner& b) {
                          const double x = by_light ? a.share : a.factor;
                          const double y = by_light ? b.share : b.factor;
                          return x != y ? x > y : a.patch < b.patch;
                      });
    partners.resize(kept);
    return partners;
}

} // namespace hemi::viewer
