#pragma once

#include "cli/arguments/arguments.hpp"
#include "hemi/display/dots.hpp"
#include "hemi/pipeline/points.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Where `points` has its points from.
namespace hemi::cli {

/// Points of a table with columns x, y, z, and nx, ny, nz where there are normals, in any order; cells of a
/// normal may all be empty.
/// @throws InputError, ParseError with the place
[[nodiscard]] std::vector<Receiver> read_points(const std::filesystem::path& path);

/// Points of a table with columns x, y, z, and its other columns of numbers but nx, ny, nz as values: what
/// `points` reads and what it writes. Cells of values may be empty.
/// @param column  one that is asked for, which must be of numbers
/// @throws InputError, ParseError with the place
[[nodiscard]] PointTable read_point_table(const std::filesystem::path& path, std::string_view column);

/// Dots in the colours of the column that is asked for.
/// @throws InvalidArgument for a column that is not there, with the nearest; as read_point_table()
[[nodiscard]] Dots read_dots(const DotOptions& options, const Bounds& scene);
/// Index of the column that is asked for; nothing where there is none, and none is asked for.
/// @throws InvalidArgument for a column that is not there, with the nearest
[[nodiscard]] std::optional<std::size_t> dots_column(const DotOptions& options, const PointTable& table);

/// Unit of a column of points, as far as its name tells it: K, or %.
[[nodiscard]] std::string unit_of_column(std::string_view name);

/// Those of `--grid`. @throws InvalidArgument for an unknown group, with the nearest, and for no points
[[nodiscard]] PointGrid points_of_grid(const PatchMesh& mesh, const PointsArguments::Grid& grid);

} // namespace hemi::cli
