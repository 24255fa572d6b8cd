#pragma once

#include "hemi/scene/scene.hpp"

#include <array>
#include <filesystem>
#include <optional>

namespace hemi::viewer {

/// Cameras 1 to 9 of a scene, kept beside it in SCENE.cameras: {"schema": "hemi/cameras/1", "cameras": {"1":
/// {"eye", "target", "up", "fov", "orthographic"} …}}.
class Bookmarks {
public:
    static constexpr int count = 9;

    Bookmarks() = default;
    /// Reads those of a scene; none where there is no file.
    /// @throws InputError where the file is none of these
    explicit Bookmarks(const std::filesystem::path& scene);

    /// @param number  1 to 9
    [[nodiscard]] const std::optional<Camera>& camera(int number) const {
        return cameras_[static_cast<std::size_t>(number - 1)];
    }
    /// Keeps a camera beside those that are in the file, and writes it.
    /// @throws IoError; InputError where the file is no longer one of cameras
    void store(int number, const Camera& camera);
    /// Where they are kept.
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }

private:
    using Cameras = std::array<std::optional<Camera>, count>;
    static Cameras read(const std::filesystem::path& file);

    std::filesystem::path file_;
    Cameras cameras_;
};

} // namespace hemi::viewer
