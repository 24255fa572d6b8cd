#include "cli/refusals.hpp"

#include "core/nearest_word.hpp"
#include "hemi/core/error.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace hemi::cli {

namespace {

using Words = std::vector<std::string>;

Words option_names(const CLI::App& app) {
    Words names;
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames()) {
            names.push_back("--" + name);
        }
    }
    return names;
}

} // namespace

void refuse_command(const CLI::App& app, const std::string& word) {
    Words names;
    for (const CLI::App* command : app.get_subcommands({})) {
        names.push_back(command->get_name());
    }
    std::string message = fmt::format("there is no command '{}'", word);
    if (const auto nearest = nearest_word(word, names)) {
        message += fmt::format("; did you mean {}?", *nearest);
    }
    throw InvalidArgument(message + " (see `hemi --help`)");
}

void refuse_word(const CLI::App& app, const CLI::App& command, const std::string& word) {
    const std::string where = fmt::format("`hemi {}`", command.get_name());
    const std::string see = fmt::format(" (see `hemi {} --help`)", command.get_name());
    if (!word.starts_with("-")) {
        throw InvalidArgument(fmt::format("{}: unexpected argument '{}'", where, word) + see);
    }
    const std::string name = word.substr(0, word.find('='));
    Words others;
    for (const CLI::App* other : app.get_subcommands({})) {
        if (other->get_option_no_throw(name) != nullptr) {
            others.push_back(other->get_name());
        }
    }
    if (std::find(others.begin(), others.end(), command.get_name()) != others.end()) {
        throw InvalidArgument(fmt::format("{} belongs behind the command: {} {}", name, where, name) + see);
    }
    if (!others.empty()) {
        throw InvalidArgument(
            fmt::format("{} does not apply to {}; it belongs to {}", name, where, fmt::join(others, ", ")) +
            see);
    }
    const auto nearest = nearest_word(name, option_names(command));
    throw InvalidArgument(fmt::format("{} has no option {}", where, name) +
                          (nearest ? fmt::format("; did you mean {}?", *nearest) : std::string()) + see);
}

} // namespace hemi::cli
