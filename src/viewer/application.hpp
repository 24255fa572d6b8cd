#pragma once

#include "viewer/bookmarks.hpp"
#include "viewer/document.hpp"
#include "viewer/file_watch.hpp"
#include "viewer/gui.hpp"
#include "viewer/hemicube_inset.hpp"
#include "viewer/line_probe.hpp"
#include "viewer/material_history.hpp"
#include "viewer/navigator.hpp"
#include "viewer/opener.hpp"
#include "viewer/panels.hpp"
#include "viewer/report.hpp"
#include "viewer/scene_target.hpp"
#include "viewer/scene_view.hpp"
#include "viewer/window.hpp"

#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hemi::viewer {

/// The window, what it shows and what the user does to it. Real input and scripts come in by the same door,
/// handle(). Draws only what has changed.
class Application {
public:
    Application(ViewerInput input, const ViewerSettings& settings);

    /// Until the window is closed.
    void run();

    // For scripts.

    void handle(const Event& event);
    void draw();
    /// Takes in what was done beside the window.
    void update();
    /// Waits at most `seconds` for something to happen. Of the events, only those count that a watcher of a
    /// script may cause.
    void watch(double seconds);
    /// Until nothing goes on by itself, or `enough` says so; empty: never.
    void wait_for_work(const std::function<bool()>& enough = {});
    /// Reads a file, beside the window; the one that is open where it is the same.
    void open(const std::filesystem::path& file);
    /// Whether the open file has changed on the disk since the last call.
    [[nodiscard]] bool file_changed() { return watch_->take(); }
    [[nodiscard]] bool closing() const { return closing_; }
    /// Ends, whatever is not saved.
    void close() { closing_ = true; }
    [[nodiscard]] Document& document() { return *document_; }
    [[nodiscard]] Choices& choices() { return choices_; }
    [[nodiscard]] Window& window() { return window_; }
    [[nodiscard]] Navigator& navigator() { return navigator_; }
    /// Brings what is shown in line with the choices.
    void settle();
    /// The picture is to be drawn again.
    void refresh() { picture_changed_ = lost_ = true; }
    void screenshot(const std::filesystem::path& path, std::array<std::uint32_t, 2> size,
                    std::uint32_t samples);
    /// The window in full quality, panels included.
    void windowshot(const std::filesystem::path& path);
    /// What is shown, as JSON.
    void report(const std::filesystem::path& path) const;
    /// Writes the camera into the scene's file. @throws InvalidArgument where that holds none; IoError
    void save_camera();
    /// Writes what materials and the environment were changed to into the scene's file. @throws
    /// InvalidArgument where nothing was changed, and where the file cannot take it; IoError
    void save_materials();
    void save_result(const std::filesystem::path& path);
    /// Writes what is shown along the line that is measured. @throws InvalidArgument where there is none
    void save_probe(const std::filesystem::path& path);
    /// Command line that draws the picture. @throws InvalidArgument where none does
    [[nodiscard]] std::string command_line() const;
    /// Pixels of the window that show the scene, from its upper left.
    [[nodiscard]] std::array<std::uint32_t, 2> view_size() const;
    /// Work that took longer is not thrown away without a word.
    void set_long_work(std::chrono::duration<double> time) {
        long_work_ = std::chrono::duration_cast<std::chrono::steady_clock::duration>(time);
    }
    /// Picks a patch and looks at it.
    void go_to_patch(std::uint32_t patch);
    /// What the window says of the last thing that went wrong.
    [[nodiscard]] const std::string& message() const { return message_; }

private:
    void act_on(const Event& event);
    void on_key(const KeyEvent& event);
    void other_key(const KeyEvent& event);
    void undo_or_redo(bool redo);
    /// Beside the scene. @param number  1 to 9
    void keep_camera(int number);
    void go_to_camera(int number);
    /// Looks along the line that is measured, where its ends have changed.
    void settle_probe();
    /// Ends, unless something would be lost: then it asks first.
    void ask_to_close();
    /// What would be lost, in words; empty: nothing.
    [[nodiscard]] std::string unsaved() const;
    void look_under_cursor();
    /// Takes over what the choices leave out of the picture, and which group is selected.
    void settle_cut();
    void on_group_key(char key);
    /// @param turn  shows the other side; else cuts through the picked patch, or no longer
    void clip_by_key(bool turn);
    [[nodiscard]] std::array<std::string, 2> words_under_cursor() const;
    void pick(std::array<double, 2> pixel);
    void moved();
    void grant_wishes();
    void take_opened();
    void exchange(ViewerInput input);
    void compare_with(const ViewerInput& input, bool again);
    /// Opens a stored solution that is compared with nothing.
    void open_alone(const std::filesystem::path& file);
    /// Does it, and shows what went wrong in the window.
    void attempt(const std::function<void()>& action);
    void numbered_screenshot(bool of_window);

    [[nodiscard]] std::uint32_t panel_pixels() const;
    void draw_hemicube();
    void update_title();
    void pace_gathering();
    void describe_panels();
    void draw_picture(SceneTarget& target, std::array<std::uint32_t, 2> size, bool preview);

    const ViewerSettings& settings_;
    Window window_; // before everything that lives in its context
    SceneView view_;
    SceneTarget target_;
    Gui gui_;
    std::optional<HemicubeInset> inset_; ///< made when it is first needed
    Navigator navigator_;
    Choices choices_;

    // What the screen shows: follows the choices, see settle().
    std::optional<Look> shown_look_;
    std::optional<std::uint32_t> shown_pick_;
    bool shown_by_light_ = false;
    HemicubeChoice shown_hemicube_;
    std::optional<PickedPatch> picked_;
    std::string status_;
    std::string note_;
    std::string message_;
    std::string title_;
    std::optional<UnderCursor> under_cursor_;
    std::optional<std::size_t> dot_under_cursor_;
    PictureCut shown_cut_;
    ShownValues values_;            ///< of what is shown
    GroupTable groups_;             ///< likewise
    std::vector<double> histogram_; ///< of the field
    std::optional<LineProbe> probe_;
    bool hides_backs_ = false; ///< in an orthographic picture, which says so
    Bookmarks bookmarks_;
    std::optional<std::uint32_t> shown_group_; ///< that edges are of
    std::vector<std::array<Vec3, 2>> group_edges_;
    std::optional<MaterialHistory> history_; ///< always there once a scene is
    std::filesystem::path saved_result_;     ///< of the light as it is; empty: it was not saved

    using Clock = std::chrono::steady_clock;
    bool moving_ = false;                         ///< the picture will change again at once
    bool rough_ = false;                          ///< it was drawn with one sample a pixel
    Clock::time_point rests_at_;                  ///< and is drawn in full quality then
    std::optional<Clock::time_point> took_light_; ///< when light came in that is not drawn yet
    Clock::time_point gathers_at_;                ///< light of single rows is not taken in before
    bool picture_changed_ = true;
    bool lost_ = true; ///< what the window holds is not what was drawn last
    bool closing_ = false;
    bool asks_to_close_ = false;
    Clock::duration long_work_ = std::chrono::minutes{1};
    Clock::duration worked_{0};                    ///< on the scene that is open
    std::optional<Clock::time_point> works_since_; ///< while it does

    std::shared_ptr<FactorCache> factor_cache_ = std::make_shared<FactorCache>();
    std::unique_ptr<Document> document_;
    Opener opener_;
    std::optional<FileWatch> watch_;
};

} // namespace hemi::viewer
