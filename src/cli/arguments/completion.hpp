#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hemi::cli {

/// What stands as the type of an option or argument that names a file; its extensions are those that its help
/// mentions. The type of an option with fixed values is these, with | between them.
inline constexpr const char* file_type = "FILE";

/// A script by which bash completes the program's commands, options, fixed values and file names, made from
/// what the parser knows of them.
[[nodiscard]] std::string bash_completion(const CLI::App& app);

} // namespace hemi::cli
