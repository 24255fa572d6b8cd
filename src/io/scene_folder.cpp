#include "io/scene_folder.hpp"

#include "io/text_scan.hpp"

#include <algorithm>
#include <system_error>

namespace hemi::io {

namespace fs = std::filesystem;

bool SceneFolder::allows(const fs::path& path) const {
    if (allow_outside_) {
        return true;
    }
    std::error_code problem;
    const fs::path from = fs::weakly_canonical(folder_.empty() ? fs::path(".") : folder_, problem);
    const fs::path to = problem ? fs::path() : fs::weakly_canonical(path, problem);
    return !problem && std::mismatch(from.begin(), from.end(), to.begin(), to.end()).first == from.end();
}

std::string SceneFolder::refusal(const std::string& name) {
    return in_quotes(name) + "; must be in the scene's folder or below it (--allow-outside opens others)";
}

} // namespace hemi::io
