#pragma once

#include "hemi/scene/scene.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// Writes a camera into a JSON scene, in place of the one that is there or behind all else. Every other byte
/// of the file stays as it is.
/// @throws InvalidArgument for other scenes, which hold none; InputError where the file is no JSON scene;
///   IoError
void write_scene_camera(const std::filesystem::path& path, const Camera& camera);

/// What a material reflects or emits, one value a channel; empty: as it is.
struct MaterialValues {
    std::string name;                ///< of the material
    std::vector<double> reflectance; ///< one value a channel
    std::vector<double> exitance;    ///< likewise, W/m² or lm/m²
};
/// Writes values of materials, and of the environment, into a JSON scene, in place of those that are there or
/// behind them. Every other byte of the file stays as it is.
/// @param path         file of the scene
/// @param materials    those that are written
/// @param environment  exitance of it, one value a channel; empty: as it is
/// @throws InvalidArgument for other scenes, for materials that the file does not have or that have an
///   emissivity there; InputError where the file is no JSON scene; IoError
void write_scene_materials(const std::filesystem::path& path, std::span<const MaterialValues> materials,
                           std::span<const double> environment);

} // namespace hemi::io
