#pragma once

#include "display/orbit_camera.hpp"
#include "hemi/scene/scene.hpp"

#include <array>
#include <cstdint>
#include <string>

/// Where the scene's axes point, and how large things are. Between Gui::begin() and Gui::end().
namespace hemi::viewer {

/// A length with its unit: "1.5 m", "20 mm".
/// @param scene  says how many metres a scene unit is
/// @param length  scene units
[[nodiscard]] std::string length_text(const Scene& scene, double length);

/// The axes and a scale bar, in the lower right of the view. In a perspective the bar is that long at the
/// depth of the camera's target.
/// @param legend  whether there is one, which they stand above where the view is narrow
void gauges(const Scene& scene, const OrbitCamera& orbit, std::array<std::uint32_t, 2> view, bool legend);

} // namespace hemi::viewer
