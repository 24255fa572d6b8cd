#include "viewer/gui.hpp"

#include "hemi/core/error.hpp"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h> // closes popups from outside them

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <utility>
#include <variant>

namespace hemi::viewer {

namespace {

constexpr std::array<float, 2> far_away{-1e6F, -1e6F};

/// Keys that edit a field.
constexpr std::array<std::pair<char, ImGuiKey_>, 4> edit_keys{{{escape_key, ImGuiKey_Escape},
                                                               {enter_key, ImGuiKey_Enter},
                                                               {backspace_key, ImGuiKey_Backspace},
                                                               {home_key, ImGuiKey_Home}}};

void set_style() {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 0.0F;
    style.WindowBorderSize = 0.0F;
    style.FrameRounding = 2.0F;
    style.GrabRounding = 2.0F;
    style.ItemSpacing = {6.0F, 4.0F};
    style.Colors[ImGuiCol_WindowBg] = {0.11F, 0.12F, 0.13F, 1.0F};
    style.Colors[ImGuiCol_PopupBg] = {0.14F, 0.15F, 0.16F, 0.98F};
    style.Colors[ImGuiCol_TextDisabled] = {0.66F, 0.68F, 0.70F, 1.0F};
}

/// Of Debian's fonts-dejavu-core, and where other systems have it.
constexpr std::array<const char*, 3> font_files{"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                                "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                                                "/usr/share/fonts/TTF/DejaVuSans.ttf"};

/// A font that is sharp at that scale; where there is none, the one that is built in.
void set_font(float scale) {
    constexpr float text_height = 15.0F; // pixels of the layout
    // Latin, Greek, Cyrillic, raised and lowered digits: names of groups may have any of them.
    static constexpr std::array<ImWchar, 9> letters{0x20,   0x24F,  0x370,  0x52F, 0x2010,
                                                    0x205E, 0x2070, 0x209F, 0};
    ImGuiIO& io = ImGui::GetIO();
    io.FontGlobalScale = 1.0F / scale;
    for (const char* file : font_files) {
        std::error_code error;
        if (std::filesystem::is_regular_file(file, error) &&
            io.Fonts->AddFontFromFileTTF(file, text_height * scale, nullptr, letters.data()) != nullptr) {
            return;
        }
    }
    ImFontConfig built_in;
    built_in.SizePixels = text_height * scale;
    io.Fonts->AddFontDefault(&built_in);
}

} // namespace

Gui::Gui(double scale, bool clock)
    : scale_(static_cast<float>(std::max(scale, 1.0))), clock_(clock),
      last_frame_(std::chrono::steady_clock::now()) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.LogFilename = nullptr;
    io.MousePos = {far_away[0], far_away[1]};
    for (const auto& [key, of_gui] : edit_keys) {
        io.KeyMap[of_gui] = static_cast<unsigned char>(key);
    }
    io.ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
    set_style();
    set_font(scale_);
    if (!ImGui_ImplOpenGL3_Init("#version 450 core") || !ImGui_ImplOpenGL3_CreateDeviceObjects()) {
        ImGui::DestroyContext();
        throw GlError("the panels cannot be drawn with this OpenGL");
    }
}

Gui::~Gui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
}

void Gui::feed(const Event& event) {
    ImGuiIO& io = ImGui::GetIO();
    if (const auto* cursor = std::get_if<CursorEvent>(&event)) {
        io.MousePos = {static_cast<float>(cursor->x) / scale_, static_cast<float>(cursor->y) / scale_};
    } else if (const auto* button = std::get_if<ButtonEvent>(&event)) {
        const int index = button->button == Button::left ? 0 : (button->button == Button::right ? 1 : 2);
        io.MouseDown[index] = button->pressed;
    } else if (const auto* scroll = std::get_if<ScrollEvent>(&event)) {
        io.MouseWheel += static_cast<float>(scroll->amount);
    } else if (const auto* text = std::get_if<TextEvent>(&event); text != nullptr && has_keyboard()) {
        io.AddInputCharacter(static_cast<unsigned int>(text->letter));
    } else if (const auto* key = std::get_if<KeyEvent>(&event); key != nullptr && has_keyboard()) {
        io.KeysDown[static_cast<unsigned char>(key->key)] = true;
    }
}

bool Gui::has_mouse() const {
    return ImGui::GetIO().WantCaptureMouse;
}

bool Gui::has_keyboard() const {
    return ImGui::GetIO().WantTextInput;
}

bool Gui::holds() const {
    return ImGui::IsAnyItemActive();
}

bool Gui::close_list() {
    const bool open = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    if (open) {
        ImGui::ClosePopupToLevel(0, true);
    }
    return open;
}

std::array<std::uint32_t, 2> Gui::layout(std::array<std::uint32_t, 2> window) const {
    return {static_cast<std::uint32_t>(static_cast<float>(window[0]) / scale_),
            static_cast<std::uint32_t>(static_cast<float>(window[1]) / scale_)};
}

std::uint32_t Gui::pixels(std::uint32_t of_layout) const {
    return static_cast<std::uint32_t>(std::lround(static_cast<float>(of_layout) * scale_));
}

void Gui::begin(std::array<std::uint32_t, 2> size) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(size[0]) / scale_, static_cast<float>(size[1]) / scale_};
    io.DisplayFramebufferScale = {scale_, scale_};
    io.DeltaTime = 1.0F / 60.0F;
    if (clock_) {
        constexpr float least = 1e-4F; // what is 0 is no frame
        const auto now = std::chrono::steady_clock::now();
        io.DeltaTime = std::max(std::chrono::duration<float>(now - last_frame_).count(), least);
        last_frame_ = now;
    }
    ImGui::NewFrame();
}

void Gui::end() {
    ImGui::Render();
    // Keys tell that they were pressed, not for how long.
    std::fill(std::begin(ImGui::GetIO().KeysDown), std::end(ImGui::GetIO().KeysDown), false);
}

std::vector<unsigned char> Gui::content() {
    std::vector<unsigned char> bytes;
    const auto append = [&bytes](const void* data, std::size_t size) {
        const auto* first = static_cast<const unsigned char*>(data);
        bytes.insert(bytes.end(), first, first + size);
    };
    const ImDrawData* data = ImGui::GetDrawData();
    for (int i = 0; i < data->CmdListsCount; ++i) {
        const ImDrawList* list = data->CmdLists[i];
        append(list->VtxBuffer.Data, static_cast<std::size_t>(list->VtxBuffer.size_in_bytes()));
        append(list->IdxBuffer.Data, static_cast<std::size_t>(list->IdxBuffer.size_in_bytes()));
    }
    return bytes;
}

bool Gui::changed() const {
    return content() != drawn_;
}

void Gui::draw() {
    drawn_ = content();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

} // namespace hemi::viewer
