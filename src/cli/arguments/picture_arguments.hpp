#pragma once

#include "hemi/pipeline/vertex_gather.hpp"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

/// What the command line says of pictures.
namespace hemi::cli {

struct HeatPicture;
struct PictureOptions;

/// Channels, shading and exposure of a solution that is shown. @return all of them
std::vector<CLI::Option*> add_shown(CLI::App& app, PictureOptions& picture);
/// `--gather`.
void add_gather(CLI::App& app, Gather& gather);
/// All of a picture of light.
/// @param output  the option without which these make no sense; may be none.
void add_picture(CLI::App& app, PictureOptions& picture, CLI::Option* output);
/// All of a picture of heat.
/// @param output  the option without which these make no sense
/// @return their names
std::vector<std::string> add_heat_picture(CLI::App& app, HeatPicture& picture, CLI::Option* output);

} // namespace hemi::cli
