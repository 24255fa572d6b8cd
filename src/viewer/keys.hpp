#pragma once

#include "display/orbit_camera.hpp"
#include "viewer/events.hpp"
#include "viewer/panels.hpp"

#include <vector>

namespace hemi::viewer {

/// Keys that move the camera. @return whether it was one
bool apply_camera_key(const KeyEvent& event, double aspect, OrbitCamera& orbit);
/// Keys that walk. @return whether it was one
/// @param step  scene units
bool apply_walk_key(const KeyEvent& event, double step, OrbitCamera& orbit);
/// Keys that change how the scene is shown. @return whether it was one
bool apply_look_key(const KeyEvent& event, const ViewerInput& input, Choices& choices);

/// One line on mouse or keys.
struct GuideLine {
    const char* keys;
    const char* meaning;
};
/// What mouse and keys do, for F1; README says the same.
[[nodiscard]] std::vector<GuideLine> guide(Controls controls);

} // namespace hemi::viewer
