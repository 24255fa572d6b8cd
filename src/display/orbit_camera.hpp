#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/scene/scene.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace hemi {

/// A half-line from the eye through a point of the picture; of an orthographic camera, from before the scene.
struct ViewRay {
    Vec3 origin;
    Vec3 direction; ///< not of unit length: one length along it adds 1 to the depth
};

/// A camera that a hand moves: orbit, pan and zoom about a pivot that stays where it is on the screen. Knows
/// nothing of windows; lengths on the screen are in heights of the picture, x to the right and y upwards,
/// from its centre.
///
/// Orbiting is a turntable: sideways about the scene's upward axis, up and down about the camera's right. It
/// stops looking straight up or down and never rolls over.
/// A gesture goes from grab() to the next grab(); its moves are measured from where it began, so that a hand
/// that comes back to its start brings back the same camera, bit for bit.
class OrbitCamera {
public:
    enum class Axis { front, right, top };

    /// @param home  where reset() goes; its upward direction is the axis of the turntable.
    OrbitCamera(const Camera& home, const Bounds& bounds);

    [[nodiscard]] const Camera& camera() const noexcept { return camera_; }
    [[nodiscard]] ViewRay ray(double x, double y) const;
    /// Where a line from `a` to `b` is seen: the ends of what lies in front of the eye, {x, y} each.
    [[nodiscard]] std::optional<std::array<std::array<double, 2>, 2>> line(const Vec3& a,
                                                                           const Vec3& b) const;

    /// Begins a gesture about `pivot`.
    void grab(const Vec3& pivot);
    /// Turns by angles in radians since grab(): `across` to the right about the upward axis, `up` so that the
    /// scene tips towards the eye from above. The pivot keeps its place on the screen.
    void orbit(double across, double up);
    /// Moves along the picture, so that the pivot follows the hand by (x, y) since grab().
    void pan(double x, double y);
    /// Multiplies the distance to the pivot by `factor` (> 0) since grab(). The pivot keeps its place.
    void zoom(double factor);

    /// Walks by lengths in scene units: `ahead` where one looks, but level, and `right`; eye and target move
    /// alike.
    void walk(double ahead, double right);

    /// Goes back or forth along the view until the whole scene is in the picture, and looks at its centre.
    /// @param aspect  width by height of the picture.
    void frame_all(double aspect);
    void reset();
    /// Looks along an axis of the scene at all of it.
    /// @param opposite  from the other side: from behind, from the left, from below
    void look_along(Axis axis, bool opposite, double aspect);

    /// The picture keeps its size at the target's depth.
    void set_orthographic(bool orthographic);
    /// Brought into the range that can be chosen. The eye stays where it is.
    void set_fov(double degrees);
    static constexpr double smallest_fov = 5.0;
    static constexpr double largest_fov = 120.0;
    void place(const Camera& camera);

private:
    Camera home_;
    Bounds bounds_;
    Vec3 upward_;
    Camera camera_;
    Camera grabbed_; ///< at the gesture's beginning, with `up` perpendicular to the view
    Camera start_;   ///< the same as it was given
    Vec3 pivot_{0.0};
};

} // namespace hemi
