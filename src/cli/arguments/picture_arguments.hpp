#pragma once

#include "hemi/pipeline/vertex_gather.hpp"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

/// What the command line says of pictures.
namespace hemi::cli {

struct DotOptions;
struct HeatPicture;
struct PictureOptions;
struct SceneOptions;

/// Channels, shading and exposure of a solution that is shown. @return all of them
/// @param quantities  whether a quantity may be shown instead
/// @param heat        whether that may be one of heat
std::vector<CLI::Option*> add_shown(CLI::App& app, PictureOptions& picture, bool quantities = false,
                                    bool heat = false);
/// `--points` and `--column`.
void add_dots(CLI::App& app, DotOptions& dots);
/// `--gather`.
void add_gather(CLI::App& app, Gather& gather);
/// All of a picture of light.
/// @param output      the option without which these make no sense; may be none.
/// @param quantities  whether quantities can be shown in false colours instead
/// @param scene       that is read for it, none: a stored result
void add_picture(CLI::App& app, PictureOptions& picture, CLI::Option* output, bool quantities,
                 SceneOptions* scene);
/// The quantity that is compared, and all of a picture of its difference.
/// @param output  the option without which a picture's make no sense
void add_difference_picture(CLI::App& app, PictureOptions& picture, CLI::Option* output);
/// All of a picture of heat.
/// @param output  the option without which these make no sense
/// @param scene   that is read for it
/// @return their names, but for `--up`
std::vector<std::string> add_heat_picture(CLI::App& app, HeatPicture& picture, CLI::Option* output,
                                          SceneOptions& scene);

} // namespace hemi::cli
