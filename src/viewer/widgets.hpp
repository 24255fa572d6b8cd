#pragma once

#include <imgui.h>

#include <string>

/// Small pieces that panels are made of.
namespace hemi::viewer {

inline constexpr ImGuiWindowFlags fixed_window = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                                 ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                                                 ImGuiWindowFlags_NoSavedSettings;

inline void text(const std::string& words) {
    ImGui::TextUnformatted(words.c_str());
}

/// Two or three words of which one is chosen.
template <typename Value>
void choice(const char* name, Value value, Value& chosen) {
    if (ImGui::RadioButton(name, chosen == value)) {
        chosen = value;
    }
}

} // namespace hemi::viewer
