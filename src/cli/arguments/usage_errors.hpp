#pragma once

#include "cli/arguments/arguments.hpp"

#include <string>
#include <vector>

namespace CLI {
class App;
}

/// What stands on the command line and cannot be understood. All throw InvalidArgument that names the word,
/// and the nearest right one where there is one.
namespace hemi::cli {

/// Long names of a command's own options, "--" included, in the order of its help.
[[nodiscard]] std::vector<std::string> option_names(const CLI::App& app);

/// No word at all: lists the commands.
[[noreturn]] void refuse_no_command(const CLI::App& app);

/// A word that is no command.
[[noreturn]] void refuse_command(const CLI::App& app, const std::string& word);

/// A word that no option of `command` takes: does another command have it, or is it mistyped?
[[noreturn]] void refuse_word(const CLI::App& app, const CLI::App& command, const std::string& word);

/// Options of RowOptions that say nothing to the method are refused, not ignored.
void check_method(const RowOptions& rows, const std::vector<std::string>& given);

} // namespace hemi::cli
