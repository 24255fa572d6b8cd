#pragma once

#include "display/orbit_camera.hpp"
#include "viewer/events.hpp"
#include "viewer/panels.hpp"

namespace hemi::viewer {

/// Keys that move the camera. @return whether it was one
bool apply_camera_key(char key, double aspect, OrbitCamera& orbit);
/// Keys that change how the scene is shown. @return whether it was one
bool apply_look_key(const KeyEvent& event, const ViewerInput& input, Choices& choices);

} // namespace hemi::viewer
