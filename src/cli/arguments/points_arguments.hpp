#pragma once

#include <CLI/CLI.hpp>

/// What the command line says of points.
namespace hemi::cli {

struct PointsArguments;

/// `--points`, `--grid`, `--person`, `--facing`, `--factors` and outputs.
void add_point_options(CLI::App& app, PointsArguments& a);

} // namespace hemi::cli
