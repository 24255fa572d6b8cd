#include "io/scenes/scene_folder.hpp"
#include "hemi/io/paths.hpp"

#include "io/formats/text_scan.hpp"

#include <algorithm>

namespace hemi::io {

namespace fs = std::filesystem;

bool SceneFolder::allows(const fs::path& path) const {
    if (allow_outside_) {
        return true;
    }
    const fs::path from = whole_path(folder_.empty() ? fs::path(".") : folder_);
    const fs::path to = whole_path(path);
    return !from.empty() && !to.empty() &&
           std::mismatch(from.begin(), from.end(), to.begin(), to.end()).first == from.end();
}

std::string SceneFolder::refusal(const std::string& name) {
    return in_quotes(name) +
           "; must be in the scene's folder or below it, unless files outside it are allowed (allow-outside)";
}

} // namespace hemi::io
