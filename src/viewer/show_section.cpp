#include "viewer/show_section.hpp"

#include "hemi/core/text.hpp"
#include "viewer/meanings.hpp"
#include "viewer/panels.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <optional>
#include <string>

namespace hemi::viewer {

namespace {

constexpr double most_stops = 10.0;

void shown_combo(const PanelContent& content, Choices& choices) {
    if (!begin_list("##quantity", name_of(choices.look.shown).title, -1.0F,
                    std::string("What the scene shows (V: the next). Now: ") + meaning_of(choices.look.shown),
                    ImGuiComboFlags_HeightLargest)) {
        return;
    }
    for (const ShownName& name : shown_names()) {
        const char* problem = why_not(name.shown, content.document.input(), choices.picked);
        const ImGuiSelectableFlags flags = problem != nullptr ? ImGuiSelectableFlags_Disabled : 0;
        const std::string meaning = meaning_of(name.shown);
        if (list_line(name.title, name.shown == choices.look.shown,
                      problem != nullptr ? meaning + "\nNot to be had: " + problem + "." : meaning, flags)) {
            choices.look.shown = name.shown;
        }
    }
    ImGui::EndCombo();
}

/// Whether a quantity is one value whatever the channel.
bool is_without_channels(Quantity quantity) {
    return quantity == Quantity::environment || quantity == Quantity::blocked ||
           quantity == Quantity::row_error || quantity == Quantity::area;
}

void channel_choice(const ViewerInput& input, Look& look) {
    if (input.channels() == 1 || is_without_channels(look.shown.quantity)) {
        return;
    }
    if (begin_list("##channel", "channel: " + look.channel, -1.0F,
                   "Which channel the quantity is of: one, their mean or sum, or the luminance, 0.2126 red + "
                   "0.7152 green + 0.0722 blue.")) {
        for (const std::string& channel : channel_choices(input.scene->channels)) {
            if (list_line(channel, channel == look.channel)) {
                look.channel = channel;
            }
        }
        ImGui::EndCombo();
    }
}

void celsius_choice(Look& look) {
    bool celsius = look.celsius;
    choice("K", false, celsius, "Temperatures in kelvin.");
    ImGui::SameLine();
    choice("°C", true, celsius, "Temperatures in degrees Celsius.");
    if (celsius != look.celsius) {
        look.celsius = celsius;
        look.range.reset(); // it was of the other unit
    }
}

void map_choice(Look& look) {
    ColourMap& map = map_of(look);
    if (begin_list("##map", "colours: " + std::string(to_word(map)), -1.0F,
                   "Colours of low to high values (M: the next). cool-warm has zero in its middle.")) {
        for (const NamedValue<ColourMap>& known : Names<ColourMap>::table) {
            if (list_line(std::string(known.word), known.value == map)) {
                map = known.value;
            }
        }
        ImGui::EndCombo();
    }
}

void bands_choice(Look& look) {
    constexpr int most_bands = 32;
    auto bands = static_cast<int>(look.bands);
    if (slider("##bands", bands, 1, most_bands, bands < 2 ? "smooth colours" : "%d bands", -102.0F,
               "Into how many bands of one colour each the scale is divided; 1: into none.")) {
        look.bands = bands < 2 ? 0 : static_cast<std::uint32_t>(bands);
    }
    ImGui::SameLine();
    checkbox("iso-lines", look.iso_lines, "Lines of equal values: where bands end, or else at round values.");
}

/// @param field  what is shown now
void range_choice(const Field& field, Look& look) {
    bool own = look.range.has_value();
    if (checkbox(
            "range", own,
            "Fixes the ends of the scale, in the unit of the legend. Else the scale ends where the values "
            "do.")) {
        look.range = own ? std::optional(std::array{field.scale.low, field.scale.high}) : std::nullopt;
    }
    if (look.range) {
        ImGui::SameLine();
        std::array<double, 2> ends = *look.range;
        const auto speed = static_cast<float>(0.005 * (ends[1] - ends[0]));
        if (drag_two("##range", ends.data(), speed, "%.4g", -1.0F,
                     "Low and high end of the scale, in the unit of the legend. Drag them.") &&
            ends[0] < ends[1]) {
            look.range = ends;
        }
    }
}

void scale_choice(bool& logarithmic) {
    choice("linear", false, logarithmic, "Equal steps of colour are equal differences (L).");
    ImGui::SameLine();
    choice("logarithmic", true, logarithmic,
           "Equal steps of colour are equal ratios (L); values of 0 and below are at the low end.");
}

/// What is compared with, and whether the difference is shown.
void compared_choice(const PanelContent& content, Choices& choices) {
    const ViewerInput& input = content.document.input();
    if (!input.compared) {
        return;
    }
    const std::string name = input.compared->file.filename().string();
    const char* problem = why_no_difference(choices.look.shown, input);
    bool difference = shows_difference(choices.look);
    ImGui::BeginDisabled(problem != nullptr);
    if (checkbox("difference", difference,
                 problem != nullptr
                     ? std::string(problem)
                     : fmt::format("The quantity in {} less that in {}, as `hemi diff` has it.", name,
                                   input.file.filename().string()))) {
        choices.look.difference = difference;
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    choices.wishes.open_compared = small_button("open it", "Opens " + name + " in place of what is open.") ||
                                   choices.wishes.open_compared;
    ImGui::SameLine();
    choices.wishes.leave_compared =
        small_button("leave it", "Compares with " + name + " no more.") || choices.wishes.leave_compared;
    const PatchPairs& pairs = input.compared->pairs;
    faint(pairs.off == 0 ? "compared with " + name
                         : fmt::format("compared with {}; {} lie on none of it", name,
                                       plural(pairs.off, "patch", "patches")));
}

/// @param note  on light of which the picture shows little
void picture_choices(Look& look, const std::string& note) {
    choice("Gouraud", Shading::gouraud, look.shading,
           "Light is interpolated between the corners of patches (S).");
    ImGui::SameLine();
    choice("flat", Shading::flat, look.shading, "Every patch has the one value that was solved for (S).");
    auto stops = static_cast<float>(look.stops);
    if (slider("Exposure", stops, static_cast<float>(-most_stops), static_cast<float>(most_stops),
               "%+.1f stops", -72.0F,
               "Brightness of the picture over the one at the start, in powers of two (E). The factor itself "
               "stands in the window's title.")) {
        look.stops = static_cast<double>(stops);
    }
    choice("filmic", ToneMapping::filmic, look.tone_mapping,
           "What is bright runs out softly to white, as on film (T).");
    ImGui::SameLine();
    choice("linear tone mapping", ToneMapping::linear, look.tone_mapping,
           "Twice the light is twice as bright, up to white (T).");
    if (!note.empty()) {
        faint(note);
    }
}

} // namespace

void show_section(const PanelContent& content, Choices& choices) {
    if (!heading("Show", "What the scene shows, and how.")) {
        return;
    }
    Look& look = choices.look;
    shown_combo(content, choices);
    compared_choice(content, choices);
    switch (look.shown.view) {
    case View::picture:
        picture_choices(look, content.document.light_note());
        break;
    case View::quantity:
        if (is_of_heat(look.shown.quantity)) {
            if (look.shown.quantity == Quantity::temperature && !shows_difference(look)) {
                celsius_choice(look);
            }
        } else {
            channel_choice(content.document.input(), look);
        }
        map_choice(look);
        bands_choice(look);
        if (!shows_difference(look)) {
            scale_choice(look.logarithmic);
        }
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
    case View::groups:
    case View::findings:
        break;
    }
    if (look.shown.view != View::outlines) {
        checkbox("patch outlines", look.outlines, "Edges of the patches (W).");
        ImGui::SameLine();
    }
    checkbox("back faces", look.backs,
             "Backs of one-sided surfaces, striped; else one looks through them (B).");
    checkbox("axes and scale", choices.gauges,
             "The scene's axes, and a bar of known length in the lower right (U).");
    ImGui::SameLine();
    checkbox("measure a line", choices.measuring,
             "Two clicks on the scene: their distance, and what is shown along the line between (D).");
}

} // namespace hemi::viewer
