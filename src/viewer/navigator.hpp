#pragma once

#include "display/orbit_camera.hpp"
#include "display/visible_point.hpp"
#include "viewer/events.hpp"
#include "viewer/viewer.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

namespace hemi::viewer {

/// The mouse on the scene: orbits, pans and zooms about the point under the cursor, and tells clicks.
class Navigator {
public:
    Navigator(Controls controls, std::shared_ptr<const PatchMesh> mesh, const Camera& home);

    /// Another scene; the camera stays where it is.
    void exchange(std::shared_ptr<const PatchMesh> mesh, const Camera& home);

    [[nodiscard]] const OrbitCamera& orbit() const { return orbit_; }
    [[nodiscard]] OrbitCamera& orbit() { return orbit_; }
    [[nodiscard]] const Camera& camera() const { return orbit_.camera(); }

    /// Pixels of the window that show the scene, from its upper left.
    void set_view(std::array<std::uint32_t, 2> size) { view_ = size; }
    [[nodiscard]] std::array<std::uint32_t, 2> view() const { return view_; }
    [[nodiscard]] double aspect() const;
    /// Whether drags look around from where the eye is, instead of orbiting.
    void set_walking(bool walking) { walking_ = walking; }
    /// What the picture leaves out.
    void set_cut(const PictureCut& cut) { cut_ = cut; }

    /// @return whether the camera moved
    bool on_cursor(const CursorEvent& event);
    /// @return the pixel that was clicked, where this ends a click with the left button
    std::optional<std::array<double, 2>> on_button(const ButtonEvent& event);
    /// @return whether the camera moved
    bool on_scroll(const ScrollEvent& event);
    /// Ends what the buttons that are pressed do.
    void let_go() { button_.reset(); }

    /// Whether a button was pressed on the scene and not released.
    [[nodiscard]] bool holds() const { return button_.has_value(); }
    [[nodiscard]] bool dragging() const { return button_ && dragging_; }
    /// What the picture shows under the cursor.
    /// @param backs  whether it shows backs
    [[nodiscard]] std::optional<VisiblePoint> surface_under_cursor(bool backs = false) const;
    /// From the eye through the cursor.
    [[nodiscard]] ViewRay ray_under_cursor() const;
    /// Pixels from the upper left.
    [[nodiscard]] std::array<double, 2> cursor() const { return {cursor_.x, cursor_.y}; }
    /// Whether the cursor is on the picture.
    [[nodiscard]] bool on_picture() const {
        return cursor_.x >= 0.0 && cursor_.x < view_[0] && cursor_.y >= 0.0 && cursor_.y < view_[1];
    }

private:
    enum class Motion { none, orbit, pan, zoom };
    struct Point {
        double x;
        double y;
    };

    [[nodiscard]] Motion motion_of(const ButtonEvent& event) const;
    /// On the screen as OrbitCamera wants it: heights of the picture, from its centre, y upwards.
    [[nodiscard]] Point on_screen(Point pixel) const;
    /// The surface point under the cursor; where there is none, the target's depth there.
    [[nodiscard]] Vec3 point_under_cursor() const;

    Controls controls_;
    std::shared_ptr<const PatchMesh> mesh_;
    OrbitCamera orbit_;
    std::array<std::uint32_t, 2> view_{1, 1};
    PictureCut cut_;
    Point cursor_{0.0, 0.0};
    Point pressed_at_{0.0, 0.0};
    std::optional<Button> button_;
    Motion motion_ = Motion::none;
    bool dragging_ = false;
    bool walking_ = false;
};

} // namespace hemi::viewer
