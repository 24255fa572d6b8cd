#pragma once

#include "benchmark/report.hpp"

#include <filesystem>
#include <string>

namespace hemi::bench {

/// First argument by which the benchmark is started to draw frames: `hemi_bench --frames DEVICE [MESH]`.
inline constexpr const char* frames_argument = "--frames";
/// Draws frames as the window does, 1280 x 720, offscreen; prints the seconds a frame while the camera moves
/// and at rest, with a blank between, whether the device is software, and the number of patches.
/// @param mesh  file of a scene; empty: a room of 10,000 patches
/// @return exit status for main()
int run_frames(const std::string& device, const std::filesystem::path& mesh);

/// Frames of the window per second, by a process of its own: there the rasteriser has all cores, as in the
/// window, while rows are timed on one.
/// @param bench  this program
/// @throws Error if that process fails
void frame_target(const std::filesystem::path& bench, const std::string& device, Report& report);

} // namespace hemi::bench
