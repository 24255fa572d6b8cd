#pragma once

#include <CLI/CLI.hpp>

#include <string>

/// How the command line says which rows are computed, and how.
namespace hemi::cli {

struct RowOptions;
struct RowSelection;

/// `--device`.
/// @param rows  whether rows are computed on it, which `cpu` can do; pictures are drawn by OpenGL
void add_device(CLI::App& app, std::string& device, bool rows);
/// How hemicubes are drawn, whatever their settings: `--seed`, `--no-merge`, `--device`, `--jobs`.
void add_drawing(CLI::App& app, RowOptions& rows);
/// Preset, method and their settings; add_drawing().
void add_rows(CLI::App& app, RowOptions& rows);
/// A:B or K/N of `--rows`.
/// @throws InvalidArgument for anything else
[[nodiscard]] RowSelection parse_rows(const std::string& text);

} // namespace hemi::cli
