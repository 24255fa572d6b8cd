#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hemi::cli {

/// The first word names no command. @throws InvalidArgument with the nearest one
[[noreturn]] void refuse_command(const CLI::App& app, const std::string& word);

/// A word on the command line that no option of `command` takes: does another command have it, or is it
/// mistyped? @throws InvalidArgument
[[noreturn]] void refuse_word(const CLI::App& app, const CLI::App& command, const std::string& word);

} // namespace hemi::cli
