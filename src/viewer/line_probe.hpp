#pragma once

#include "display/orbit_camera.hpp"
#include "hemi/display/picture_cut.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "viewer/shown_values.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace hemi::viewer {

/// A point of a line between two others.
struct ProbePoint {
    double length;                      ///< from the line's first end, scene units
    Vec3 position;                      ///< of what is seen there; of the line, where nothing is
    std::optional<std::uint32_t> patch; ///< that is seen there
};

/// The line between two points of the scene, straight, and what is seen behind it.
struct LineProbe {
    std::array<Vec3, 2> ends;
    std::vector<ProbePoint> points; ///< in equal steps, ends included
};

/// Looks along the line.
/// @param orbit  from where
/// @param backs  whether backs are seen
/// @param cut    what is not
[[nodiscard]] LineProbe probe_line(const PatchMesh& mesh, const OrbitCamera& orbit,
                                   const std::array<Vec3, 2>& ends, bool backs, const PictureCut& cut);

/// Writes length,x,y,z,patch and a column of the values; the last two are empty where there is none.
/// @throws IoError
void write_probe(const std::filesystem::path& path, const LineProbe& probe, const ShownValues& values);

} // namespace hemi::viewer
