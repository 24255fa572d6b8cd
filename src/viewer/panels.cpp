#include "viewer/panels.hpp"

#include "display/orbit_camera.hpp"
#include "hemi/scene/light_unit.hpp"
#include "viewer/clipping.hpp"
#include "viewer/dots.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hemi::viewer {

namespace {

constexpr std::uint32_t side_width = 380;
constexpr std::uint32_t smallest_width = 640;
constexpr std::uint32_t smallest_height = 360;
constexpr double most_stops = 10.0;

void faint(const std::string& words) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::PushTextWrapPos(0.0F);
    text(words);
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

/// A name on the left, a value in a column of its own.
void line(const char* name, const std::string& value) {
    constexpr float value_at = 130.0F;
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextUnformatted(name);
    ImGui::PopStyleColor();
    ImGui::SameLine(value_at);
    text(value);
}

bool heading(const char* name) {
    return ImGui::CollapsingHeader(name, ImGuiTreeNodeFlags_DefaultOpen);
}

void shown_combo(const PanelContent& content, Choices& choices) {
    ImGui::SetNextItemWidth(-1.0F);
    if (!ImGui::BeginCombo("##quantity", name_of(choices.look.shown).title, ImGuiComboFlags_HeightLargest)) {
        return;
    }
    for (const ShownName& name : shown_names()) {
        const char* problem = why_not(name.shown, content.document.input(), choices.picked);
        const ImGuiSelectableFlags flags = problem != nullptr ? ImGuiSelectableFlags_Disabled : 0;
        if (ImGui::Selectable(name.title, name.shown == choices.look.shown, flags)) {
            choices.look.shown = name.shown;
        }
        if (problem != nullptr && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
            ImGui::SetTooltip("%s", problem);
        }
    }
    ImGui::EndCombo();
}

void channel_choice(const ViewerInput& input, Look& look) {
    if (input.channels() == 1) {
        return;
    }
    ImGui::SetNextItemWidth(-1.0F);
    if (ImGui::BeginCombo("##channel", ("channel: " + look.channel).c_str())) {
        for (const std::string& channel : channel_choices(input.scene->channels)) {
            if (ImGui::Selectable(channel.c_str(), channel == look.channel)) {
                look.channel = channel;
            }
        }
        ImGui::EndCombo();
    }
}

void celsius_choice(Look& look) {
    bool celsius = look.celsius;
    choice("K", false, celsius);
    ImGui::SameLine();
    choice("°C", true, celsius);
    if (celsius != look.celsius) {
        look.celsius = celsius;
        look.range.reset(); // it was of the other unit
    }
}

void map_choice(Look& look) {
    ImGui::SetNextItemWidth(-1.0F);
    if (ImGui::BeginCombo("##map", ("colours: " + std::string(to_word(look.map))).c_str())) {
        for (const NamedValue<ColourMap>& known : Names<ColourMap>::table) {
            if (ImGui::Selectable(std::string(known.word).c_str(), known.value == look.map)) {
                look.map = known.value;
            }
        }
        ImGui::EndCombo();
    }
}

void bands_choice(Look& look) {
    constexpr int most_bands = 32;
    auto bands = static_cast<int>(look.bands);
    ImGui::SetNextItemWidth(-102.0F);
    if (ImGui::SliderInt("##bands", &bands, 1, most_bands, bands < 2 ? "smooth colours" : "%d bands",
                         ImGuiSliderFlags_NoInput)) {
        look.bands = bands < 2 ? 0 : static_cast<std::uint32_t>(bands);
    }
    ImGui::SameLine();
    ImGui::Checkbox("iso-lines", &look.iso_lines);
    if (ImGui::IsItemHovered()) {
        ImGui::SetTooltip("Lines of equal values: where bands end, or else at round values.");
    }
}

/// @param field  what is shown now
void range_choice(const Field& field, Look& look) {
    bool own = look.range.has_value();
    if (ImGui::Checkbox("range", &own)) {
        look.range = own ? std::optional(std::array{field.scale.low, field.scale.high}) : std::nullopt;
    }
    if (ImGui::IsItemHovered()) {
        ImGui::SetTooltip("Fixes the ends of the scale; drag them. Else the scale ends where the values do.");
    }
    if (look.range) {
        ImGui::SameLine();
        ImGui::SetNextItemWidth(-1.0F);
        std::array<double, 2> ends = *look.range;
        const auto speed = static_cast<float>(0.005 * (ends[1] - ends[0]));
        if (ImGui::DragScalarN("##range", ImGuiDataType_Double, ends.data(), 2, speed, nullptr, nullptr,
                               "%.4g", ImGuiSliderFlags_NoInput) &&
            ends[0] < ends[1]) {
            look.range = ends;
        }
    }
}

void scale_choice(bool& logarithmic) {
    choice("linear", false, logarithmic);
    ImGui::SameLine();
    choice("logarithmic", true, logarithmic);
}

/// @param note  on light of which the picture shows little
void picture_choices(Look& look, const std::string& note) {
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
    if (!note.empty()) {
        faint(note);
    }
}

void show_section(const PanelContent& content, Choices& choices) {
    if (!heading("Show")) {
        return;
    }
    Look& look = choices.look;
    shown_combo(content, choices);
    switch (look.shown.view) {
    case View::picture:
        picture_choices(look, content.document.light_note());
        break;
    case View::quantity:
        if (is_of_heat(look.shown.quantity)) {
            if (look.shown.quantity == Quantity::temperature) {
                celsius_choice(look);
            }
        } else {
            channel_choice(content.document.input(), look);
        }
        map_choice(look);
        bands_choice(look);
        scale_choice(look.logarithmic);
        if (content.field) {
            range_choice(*content.field, look);
        }
        break;
    case View::row:
    case View::column:
        map_choice(look);
        bands_choice(look);
        scale_choice(look.logarithmic_factors);
        break;
    case View::outlines:
    case View::items:
        break;
    }
    if (look.shown.view != View::outlines) {
        ImGui::Checkbox("patch outlines", &look.outlines);
        ImGui::SameLine();
    }
    ImGui::Checkbox("back faces", &look.backs);
    if (ImGui::IsItemHovered()) {
        ImGui::SetTooltip("Backs of one-sided surfaces, striped; else one looks through them.");
    }
    ImGui::Checkbox("axes and scale", &choices.gauges);
    ImGui::SameLine();
    ImGui::Checkbox("measure a line", &choices.measuring);
    if (ImGui::IsItemHovered()) {
        ImGui::SetTooltip(
            "Two clicks on the scene: their distance, and what is shown along the line between.");
    }
}

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
    line("patch", std::to_string(i) + (mesh.is_back(i) ? " (back)" : ""));
    line("group", mesh.groups()[mesh.group(i)]);
    line("material", input.scene->materials[mesh.material(i)].name);
    line("area", number(mesh.areas()[i]));
    line("centre", fmt::format("{:.4g} {:.4g} {:.4g}", centre.x, centre.y, centre.z));
    line("reflectance", channels_text(light.reflectance, input.channels(), i));
    line(("exitance " + unit).c_str(), channels_text(light.exitance, input.channels(), i));
    line(("radiosity " + unit).c_str(),
         light.knows(i) ? channels_text(light.radiosity, input.channels(), i) : "not known yet");
    if (const Heat* heat = content.document.heat(); heat != nullptr && heat->problem.empty()) {
        const std::uint32_t channels = input.channels();
        line("T", temperature_text(heat->solution.temperature[i]));
        line("net flux W/m²", number(heat->solution.net_flux[i]));
        line("heat G W/m²", channels_text(heat->solution.irradiance, channels, i, 4));
        line("heat J W/m²", channels_text(heat->solution.radiosity, channels, i, 4));
    }
    if (!solution.row_sum.empty()) {
        const double defect =
            solution.row_sum[i] + solution.environment_share[i] + solution.back_face_share[i] - 1.0;
        line("row sum", fmt::format("{:.6f}  ({:+.1e})", solution.row_sum[i], defect));
        line("environment", number(solution.environment_share[i]));
        line("back faces", number(solution.back_face_share[i]));
    }
    if (input.solution.error) {
        line(("est. error " + unit).c_str(),
             channels_text(input.solution.error->patches, input.channels(), i, 1));
    }
}

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
        ImGui::SetNextItemWidth(-120.0F);
        if (ImGui::SliderFloat(names[c].c_str(), &shown, 0.0F, most, "%.0f K", ImGuiSliderFlags_NoInput)) {
            kelvin = static_cast<double>(shown);
        }
        ImGui::PopID();
    }
    if (choices.conditions != input.heat->conditions && ImGui::Button("Temperatures as in the scene")) {
        choices.conditions = input.heat->conditions;
    }
}

/// Temperatures and net powers of groups.
void heat_section(const PanelContent& content, Choices& choices) {
    if (content.document.input().heat == nullptr || !heading("Heat")) {
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
    ImGui::TableHeadersRow();
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

void heat_map_choice(Look& look) {
    const auto button = [&look](const char* name, View view) {
        const bool active = look.shown.view == view;
        if (active) {
            ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
        }
        if (ImGui::Button(name)) {
            look.shown = {active ? View::picture : view};
        }
        if (active) {
            ImGui::PopStyleColor();
        }
    };
    ImGui::AlignTextToFramePadding();
    text("Heat map of F:");
    ImGui::SameLine();
    button("row", View::row);
    ImGui::SameLine();
    button("column", View::column);
}

void partner_list(const PanelContent& content, Choices& choices) {
    const bool column = choices.look.shown.view == View::column;
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
    const PatchMesh& mesh = *content.document.input().mesh;
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
        text(fmt::format("{:4.1f} % ", 100.0 * partner.share));
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
    const ViewerInput& input = content.document.input();
    if (input.factors == nullptr) {
        faint(fmt::format("No row of F: {}.", why_not({View::row}, input, choices.picked)));
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
    for (std::size_t m = 0; m < choices.materials.size(); ++m) {
        Material& material = choices.materials[m];
        ImGui::PushID(static_cast<int>(m));
        const bool lamp = *std::max_element(material.exitance.begin(), material.exitance.end()) > 0.0;
        if (ImGui::TreeNodeEx(material.name.empty() ? "(no name)" : material.name.c_str(),
                              ImGuiTreeNodeFlags_SpanAvailWidth | ImGuiTreeNodeFlags_NoTreePushOnOpen |
                                  (lamp ? ImGuiTreeNodeFlags_DefaultOpen : 0))) {
            channel_sliders("reflectance", material.reflectance, most_reflectance, "%.2f");
            channel_sliders("exitance", material.exitance, most_exitance, "%.3g");
            if (material != input.scene->materials[m] && ImGui::SmallButton("as in the scene")) {
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
                    "%.3g");
    const bool changed = choices.materials != input.scene->materials || choices.environment != environment;
    if (changed && ImGui::Button("All as in the scene")) {
        choices.materials = input.scene->materials;
        choices.environment = environment;
    }
}

constexpr float plot_height = 54.0F;

/// The residual after every sweep, on a logarithmic scale.
void residual_plot(const std::vector<double>& residuals) {
    std::vector<float> decades;
    decades.reserve(residuals.size());
    for (const double residual : residuals) {
        decades.push_back(static_cast<float>(std::log10(std::max(residual, 1e-16))));
    }
    const auto [least, most] = std::minmax_element(decades.begin(), decades.end());
    const float low = std::floor(*least);
    const float high = std::max(std::ceil(*most), low + 1.0F);
    const std::string words =
        fmt::format("residual, 1e{} to 1e{}", static_cast<int>(high), static_cast<int>(low));
    ImGui::PlotLines("##residuals", decades.data(), static_cast<int>(decades.size()), 0, words.c_str(), low,
                     high, {ImGui::GetContentRegionAvail().x, plot_height});
}

void solution_section(const PanelContent& content, Choices& choices) {
    if (!heading("Solution")) {
        return;
    }
    const Work& work = content.document.work();
    if (content.document.input().factors == nullptr) {
        faint(content.document.input().factor_settings
                  ? work.light.empty() ? "the light of the lamps alone" : work.light
                  : "as it is stored");
        return;
    }
    faint(work.light.empty() ? "solving" : work.light);
    if (work.residuals.empty()) {
        ImGui::Dummy({0.0F, plot_height}); // buttons stay where they are
    } else {
        residual_plot(work.residuals);
    }
    if (ImGui::Button("Start over")) {
        choices.wishes.start_over = true;
    }
    ImGui::SameLine();
    if (ImGui::Button("One sweep")) {
        choices.wishes.step = true;
    }
    if (work.waits) {
        ImGui::SameLine();
        if (ImGui::Button("All sweeps")) {
            choices.wishes.run_on = true;
        }
    }
}

void camera_section(const PanelContent& content, Choices& choices) {
    if (!ImGui::CollapsingHeader("Camera")) {
        return;
    }
    auto fov = static_cast<float>(content.camera.fov);
    ImGui::SetNextItemWidth(-102.0F);
    if (ImGui::SliderFloat("field of view", &fov, static_cast<float>(OrbitCamera::smallest_fov),
                           static_cast<float>(OrbitCamera::largest_fov), "%.0f degrees",
                           ImGuiSliderFlags_NoInput)) {
        choices.wishes.fov = static_cast<double>(fov);
    }
    bool orthographic = content.camera.orthographic;
    if (ImGui::Checkbox("orthographic", &orthographic)) {
        choices.wishes.orthographic = orthographic;
    }
    ImGui::SameLine();
    ImGui::Checkbox("walk by W, A, S, D", &choices.walking);
    constexpr std::array<std::pair<const char*, char>, 5> views{
        {{"All", 'F'}, {"Scene's", 'R'}, {"Front", '1'}, {"Right", '3'}, {"Top", '7'}}};
    for (const auto& [name, key] : views) {
        if (ImGui::Button(name)) {
            choices.wishes.camera_key = key;
        }
        ImGui::SameLine();
    }
    ImGui::NewLine();
    if (ImGui::Button("Save into the scene")) {
        choices.wishes.save_camera = true;
    }
    bool any = false;
    for (int number = 1; number <= Bookmarks::count; ++number) {
        if (content.bookmarks.camera(number)) {
            if (any) {
                ImGui::SameLine();
            }
            any = true;
            if (ImGui::SmallButton(std::to_string(number).c_str())) {
                choices.wishes.bookmark = number;
            }
        }
    }
    faint(any ? "ctrl + 1 ... 9 keeps this camera, alt + 1 ... 9 goes to it"
              : "ctrl + 1 ... 9 keeps this camera beside the scene");
}

void file_section(Choices& choices) {
    if (!ImGui::CollapsingHeader("Files")) {
        return;
    }
    Wishes& wishes = choices.wishes;
    ImGui::SetNextItemWidth(120.0F);
    const auto sizes = picture_sizes();
    if (ImGui::BeginCombo("##size", sizes[choices.picture_size].name)) {
        for (std::size_t k = 0; k < sizes.size(); ++k) {
            if (ImGui::Selectable(sizes[k].name, k == choices.picture_size)) {
                choices.picture_size = k;
            }
        }
        ImGui::EndCombo();
    }
    ImGui::SameLine();
    auto samples = static_cast<int>(choices.samples);
    ImGui::SetNextItemWidth(-1.0F);
    if (ImGui::SliderInt("##samples", &samples, 1, 8, fmt::format("{0} x {0} samples", samples).c_str(),
                         ImGuiSliderFlags_NoInput)) {
        choices.samples = static_cast<std::uint32_t>(samples);
    }
    wishes.screenshot = ImGui::Button("Screenshot") || wishes.screenshot;
    ImGui::SameLine();
    wishes.copy_command = ImGui::Button("Copy command line") || wishes.copy_command;
    if (ImGui::IsItemHovered()) {
        ImGui::SetTooltip("A command that draws this picture without a window, onto the clipboard");
    }
    wishes.save_result = ImGui::Button("Save result") || wishes.save_result;
    ImGui::SameLine();
    wishes.reload = ImGui::Button("Read again") || wishes.reload;
    faint("Drop a scene or a .hres on the window to open it, or a .hff with the rows of this scene.");
}

} // namespace

std::span<const PictureSize> picture_sizes() {
    static constexpr std::array<PictureSize, 5> sizes{{{"as shown", 0, 0, 1},
                                                       {"as shown, x 2", 0, 0, 2},
                                                       {"1280 x 720", 1280, 720, 1},
                                                       {"1920 x 1080", 1920, 1080, 1},
                                                       {"3840 x 2160", 3840, 2160, 1}}};
    return sizes;
}

std::uint32_t panel_width(std::array<std::uint32_t, 2> window, bool wanted) {
    return wanted && window[0] >= smallest_width && window[1] >= smallest_height ? side_width : 0;
}

void side_panel(const PanelContent& content, std::array<std::uint32_t, 2> window, Choices& choices) {
    choices.pointed_at.reset();
    const auto width = static_cast<float>(side_width);
    ImGui::SetNextWindowPos({static_cast<float>(window[0]) - width, 0.0F});
    ImGui::SetNextWindowSize({width, static_cast<float>(window[1])});
    ImGui::Begin("panel", nullptr, fixed_window);
    const float foot = ImGui::GetTextLineHeightWithSpacing() * 3.0F + 6.0F;
    const Work& work = content.document.work();
    if (!work.doing.empty()) {
        ImGui::ProgressBar(static_cast<float>(work.share), {-1.0F, 0.0F});
        faint(work.doing);
        ImGui::SameLine(width - 74.0F);
        choices.wishes.cancel = ImGui::SmallButton("Cancel") || choices.wishes.cancel;
        ImGui::Separator();
    }
    ImGui::BeginChild("sections", {0.0F, -foot});
    show_section(content, choices);
    groups_section(content, choices);
    dots_section(content.document.input(), choices);
    heat_section(content, choices);
    patch_section(content, choices);
    clip_section(content, choices);
    solution_section(content, choices);
    material_section(content, choices);
    camera_section(content, choices);
    file_section(choices);
    ImGui::EndChild();
    ImGui::Separator();
    text(content.note.empty() ? work.light : content.note);
    const bool pointed = !content.under_cursor[0].empty();
    faint(pointed ? content.under_cursor[0] : content.status);
    faint(pointed ? content.under_cursor[1] : "F1 help   Tab panel");
    ImGui::End();
}

} // namespace hemi::viewer
