#pragma once

#include "cli/arguments/arguments.hpp"
#include "hemi/pipeline/points.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <filesystem>
#include <vector>

/// Where `points` has its points from.
namespace hemi::cli {

/// Points of a table with columns x, y, z, and nx, ny, nz where there are normals, in any order; cells of a
/// normal may all be empty.
/// @throws InputError, ParseError with the place
[[nodiscard]] std::vector<Receiver> read_points(const std::filesystem::path& path);

/// Those of `--grid`. @throws InvalidArgument for an unknown group, with the nearest, and for no points
[[nodiscard]] PointGrid points_of_grid(const PatchMesh& mesh, const PointsArguments::Grid& grid);

} // namespace hemi::cli
