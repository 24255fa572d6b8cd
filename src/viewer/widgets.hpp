#pragma once

#include <imgui.h>

#include <array>
#include <cstdint>
#include <string>

/// Small pieces that panels are made of. Every control has a tip: what it is, its unit and its symbol.
namespace hemi::viewer {

inline constexpr ImGuiWindowFlags fixed_window = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                                 ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                                                 ImGuiWindowFlags_NoSavedSettings;

inline void text(const std::string& words) {
    ImGui::TextUnformatted(words.c_str());
}

/// Words of less importance, in as many lines as they take.
void faint(const std::string& words);

/// A heading that opens and closes what stands below it. @return whether that is open
bool heading(const char* name, const char* words, bool open = true);

/// Words beside the cursor, in as many lines as they take.
void show_tip(const std::string& words);
/// The same while the cursor is on the item before, also where that is disabled.
void tip(const std::string& words);

/// A name on the left, a value in a column of its own, and what they are.
void line(const char* name, const std::string& value, const std::string& words);

/// @return whether it was pressed
bool button(const char* name, const std::string& words);
bool small_button(const char* name, const std::string& words);

/// @return whether it was changed
bool checkbox(const char* name, bool& value, const std::string& words);

/// One of several words of which one is chosen. @return whether it was clicked
bool radio_button(const char* name, bool chosen, const std::string& words);

/// Two or three words of which one is chosen.
template <typename Value>
void choice(const char* name, Value value, Value& chosen, const std::string& words) {
    if (radio_button(name, chosen == value, words)) {
        chosen = value;
    }
}

/// A list that opens; ImGui::EndCombo() ends it where it is open, and begin_list() returned true.
/// @param width  negative: up to so far from the right
bool begin_list(const char* name, const std::string& chosen, float width, const std::string& words,
                ImGuiComboFlags flags = 0);
/// One line of a list. @return whether it was chosen
bool list_line(const std::string& name, bool chosen, const std::string& words = {},
               ImGuiSelectableFlags flags = 0);

/// Sliders; a double click takes a number that is typed, kept between the ends.
/// @param width  as that of begin_list()
/// @return whether it was changed
bool slider(const char* name, float& value, float least, float most, const char* format, float width,
            const std::string& words);
bool slider(const char* name, int& value, int least, int most, const char* format, float width,
            const std::string& words);
bool slider(const char* name, double& value, double least, double most, const char* format, float width,
            const std::string& words);
/// Several values side by side, from 0 on.
/// @param beyond  whether a number that is typed may be above `most`
bool sliders(const char* name, float* values, int count, float most, bool beyond, const char* format,
             float width, const std::string& words);
/// Two numbers that are dragged, or typed after a double click. @param speed  of a drag, a pixel
bool drag_two(const char* name, double* values, float speed, const char* format, float width,
              const std::string& words);

/// An area that moves what it is in while it is dragged.
/// @param view   that it stays in
/// @param moved  how far it was by now
void moving_area(const char* name, const ImVec2& size, std::array<std::uint32_t, 2> view,
                 std::array<float, 2>& moved);

/// The head of a column of a table, in a row of heads.
void header_cell(const char* name, const std::string& words);

} // namespace hemi::viewer
