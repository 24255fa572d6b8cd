#pragma once

#include "hemi/scene/scene.hpp"

#include <filesystem>

namespace hemi::io {

/// Writes a camera into a JSON scene, in place of the one that is there or behind all else. Every other byte
/// of the file stays as it is.
/// @throws InvalidArgument for other scenes, which hold none; InputError where the file is no JSON scene;
///   IoError
void write_scene_camera(const std::filesystem::path& path, const Camera& camera);

} // namespace hemi::io
