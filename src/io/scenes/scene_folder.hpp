#pragma once

#include <filesystem>
#include <string>

namespace hemi::io {

/// Where files that a scene names may be: a scene from somewhere else must not open what it likes.
class SceneFolder {
public:
    /// @param scene  the scene's own file
    /// @param allow_outside  whether everything may be opened
    SceneFolder(const std::filesystem::path& scene, bool allow_outside)
        : folder_(scene.parent_path()), allow_outside_(allow_outside) {}

    /// Whether `path` may be opened: in the folder or below it, links followed.
    [[nodiscard]] bool allows(const std::filesystem::path& path) const;

    /// What is wrong with a name that is not allowed, for a message.
    [[nodiscard]] static std::string refusal(const std::string& name);

private:
    std::filesystem::path folder_;
    bool allow_outside_;
};

} // namespace hemi::io
