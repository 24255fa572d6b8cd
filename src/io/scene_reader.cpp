#include "hemi/io/scene_reader.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::io {

namespace {

std::string lower_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return extension;
}

} // namespace

bool is_scene_file(const std::filesystem::path& path) {
    const std::string extension = lower_extension(path);
    return extension == ".json" || extension == ".obj";
}

Scene read_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                 Diagnostics& diagnostics) {
    const std::string extension = lower_extension(path);
    if (!is_scene_file(path)) {
        throw InputError(fmt::format("{}: {}; scenes are read from .json and .obj files", path.string(),
                                     extension.empty() ? std::string("no extension")
                                                       : fmt::format("unknown extension \"{}\"", extension)));
    }
    Scene scene = extension == ".json" ? read_json_scene(path, options, diagnostics)
                                       : read_obj_scene(path, options, diagnostics);
    try {
        validate(scene);
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", path.string(), error.what()));
    }
    return scene;
}

} // namespace hemi::io
