#pragma once

#include <filesystem>
#include <string>

namespace hemi::io {

/// Extension of a file's name with its dot, in lower case: ".png"; empty for a lone hyphen.
[[nodiscard]] std::string extension_of(const std::filesystem::path& path);

/// Whether the path is a lone hyphen, which stands for standard output.
[[nodiscard]] bool is_standard_output(const std::filesystem::path& path);

/// `path` from the root and without links and dots, whether it is there or not, so that equal ones name
/// the same file; empty if that cannot be found out.
[[nodiscard]] std::filesystem::path whole_path(const std::filesystem::path& path);

} // namespace hemi::io
