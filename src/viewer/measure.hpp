#pragma once

#include "display/orbit_camera.hpp"
#include "hemi/scene/scene.hpp"
#include "viewer/line_probe.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace hemi::viewer {

struct Choices;

/// The line that is measured, in front of everything. Between Gui::begin() and Gui::end().
/// @param points  its ends, as far as they are set
void mark_line(std::span<const Vec3> points, const OrbitCamera& orbit, std::array<std::uint32_t, 2> view);

/// How long the line is, and what is shown along it, in the upper left of the view; likewise.
/// @param probe   none: ends are not set yet
/// @param values  of what is shown
void measure_window(const Scene& scene, const std::optional<LineProbe>& probe, const ShownValues& values,
                    std::array<std::uint32_t, 2> view, Choices& choices);

} // namespace hemi::viewer
