#include "hemi/io/paths.hpp"

#include <algorithm>
#include <cctype>
#include <system_error>

namespace hemi::io {

std::string extension_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return extension;
}

bool is_standard_output(const std::filesystem::path& path) {
    return path == "-";
}

std::filesystem::path whole_path(const std::filesystem::path& path) {
    std::error_code problem;
    const std::filesystem::path absolute = std::filesystem::absolute(path, problem); // else what is not there
    return problem ? std::filesystem::path()                                         // would stay relative
                   : std::filesystem::weakly_canonical(absolute, problem);
}

} // namespace hemi::io
