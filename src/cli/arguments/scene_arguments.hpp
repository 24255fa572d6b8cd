#pragma once

#include <CLI/CLI.hpp>

#include <string>

/// How the command line says that a scene is read and cut into patches.
namespace hemi::cli {

struct SceneOptions;

/// Subdivision, what is done to faces as people have them, and which way they look.
void add_scene_options(CLI::App& app, SceneOptions& scene);

/// `--up`, of scenes without a picture.
void add_up(CLI::App& app, SceneOptions& scene, const std::string& help);

/// `--unit`
void add_unit(CLI::App& app, SceneOptions& scene);

/// Several files make up one scene, of meshes alone.
/// @param two_results  whether two stored solutions may be named as well, which are compared
/// @throws InvalidArgument for others among them
void check_files(const SceneOptions& scene, bool two_results);

} // namespace hemi::cli
