#include "viewer/widgets.hpp"

#include <algorithm>

namespace hemi::viewer {

namespace {

/// While it lives, a double click on the next slider opens a field as ctrl and a click do.
class DoubleClickTypes {
public:
    explicit DoubleClickTypes(float width) : control_(ImGui::GetIO().KeyCtrl) {
        const ImVec2 corner = ImGui::GetCursorScreenPos();
        const float room = ImGui::GetContentRegionAvail().x;
        const ImVec2 end{corner.x + (width > 0.0F ? width : std::max(room + width, 1.0F)),
                         corner.y + ImGui::GetFrameHeight()};
        if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left) && ImGui::IsWindowHovered() &&
            ImGui::IsMouseHoveringRect(corner, end)) {
            ImGui::GetIO().KeyCtrl = true;
        }
    }
    ~DoubleClickTypes() { ImGui::GetIO().KeyCtrl = control_; }
    DoubleClickTypes(const DoubleClickTypes&) = delete;
    DoubleClickTypes& operator=(const DoubleClickTypes&) = delete;

private:
    bool control_;
};

bool any_slider(const char* name, ImGuiDataType type, void* value, const void* least, const void* most,
                const char* format, float width, const std::string& words) {
    bool changed = false;
    {
        const DoubleClickTypes types(width);
        ImGui::SetNextItemWidth(width);
        changed = ImGui::SliderScalar(name, type, value, least, most, format, ImGuiSliderFlags_AlwaysClamp);
    }
    tip(words + "\nDouble click: type a number.");
    return changed;
}

} // namespace

void faint(const std::string& words) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::PushTextWrapPos(0.0F);
    text(words);
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

bool heading(const char* name, const char* words, bool open) {
    const bool is_open = ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    tip(words);
    return is_open;
}

void show_tip(const std::string& words) {
    constexpr float letters = 24.0F; // heights of a line
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(letters * ImGui::GetFontSize());
    text(words);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void tip(const std::string& words) {
    if (!words.empty() && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled) &&
        !ImGui::IsItemActive()) {
        show_tip(words);
    }
}

void line(const char* name, const std::string& value, const std::string& words) {
    constexpr float value_at = 130.0F;
    ImGui::BeginGroup();
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextUnformatted(name);
    ImGui::PopStyleColor();
    ImGui::SameLine(value_at);
    text(value);
    ImGui::EndGroup();
    tip(words);
}

bool button(const char* name, const std::string& words) {
    const bool pressed = ImGui::Button(name);
    tip(words);
    return pressed;
}

bool small_button(const char* name, const std::string& words) {
    const bool pressed = ImGui::SmallButton(name);
    tip(words);
    return pressed;
}

bool checkbox(const char* name, bool& value, const std::string& words) {
    const bool changed = ImGui::Checkbox(name, &value);
    tip(words);
    return changed;
}

bool radio_button(const char* name, bool chosen, const std::string& words) {
    const bool pressed = ImGui::RadioButton(name, chosen);
    tip(words);
    return pressed;
}

bool begin_list(const char* name, const std::string& chosen, float width, const std::string& words,
                ImGuiComboFlags flags) {
    ImGui::SetNextItemWidth(width);
    const bool open = ImGui::BeginCombo(name, chosen.c_str(), flags);
    if (!open) {
        tip(words);
    }
    return open;
}

bool list_line(const std::string& name, bool chosen, const std::string& words, ImGuiSelectableFlags flags) {
    const bool pressed = ImGui::Selectable(name.c_str(), chosen, flags);
    tip(words);
    return pressed;
}

bool slider(const char* name, float& value, float least, float most, const char* format, float width,
            const std::string& words) {
    return any_slider(name, ImGuiDataType_Float, &value, &least, &most, format, width, words);
}

bool slider(const char* name, int& value, int least, int most, const char* format, float width,
            const std::string& words) {
    return any_slider(name, ImGuiDataType_S32, &value, &least, &most, format, width, words);
}

bool slider(const char* name, double& value, double least, double most, const char* format, float width,
            const std::string& words) {
    return any_slider(name, ImGuiDataType_Double, &value, &least, &most, format, width, words);
}

bool sliders(const char* name, float* values, int count, float most, bool beyond, const char* format,
             float width, const std::string& words) {
    bool changed = false;
    {
        const DoubleClickTypes types(width);
        const float least = 0.0F;
        ImGui::SetNextItemWidth(width);
        changed = ImGui::SliderScalarN(name, ImGuiDataType_Float, values, count, &least, &most, format,
                                       beyond ? 0 : ImGuiSliderFlags_AlwaysClamp);
    }
    for (int k = 0; k < count && beyond; ++k) {
        constexpr float largest = 1e30F;
        values[k] = std::clamp(values[k], 0.0F, largest);
    }
    tip(words + "\nDouble click: type a number.");
    return changed;
}

bool drag_two(const char* name, double* values, float speed, const char* format, float width,
              const std::string& words) {
    ImGui::SetNextItemWidth(width);
    const bool changed =
        ImGui::DragScalarN(name, ImGuiDataType_Double, values, 2, speed, nullptr, nullptr, format);
    tip(words + "\nDouble click: type a number.");
    return changed;
}

void moving_area(const char* name, const ImVec2& size, std::array<std::uint32_t, 2> view,
                 std::array<float, 2>& moved) {
    ImGui::InvisibleButton(name, size);
    if (!ImGui::IsItemActive()) {
        return;
    }
    const ImVec2 low = ImGui::GetWindowPos();
    const ImVec2 room{static_cast<float>(view[0]) - ImGui::GetWindowWidth() - low.x,
                      static_cast<float>(view[1]) - ImGui::GetWindowHeight() - low.y};
    const ImVec2 wanted = ImGui::GetIO().MouseDelta;
    moved[0] += std::clamp(wanted.x, std::min(-low.x, 0.0F), std::max(room.x, 0.0F));
    moved[1] += std::clamp(wanted.y, std::min(-low.y, 0.0F), std::max(room.y, 0.0F));
}

void header_cell(const char* name, const std::string& words) {
    ImGui::TableNextColumn();
    ImGui::TableHeader(name);
    tip(words);
}

} // namespace hemi::viewer
