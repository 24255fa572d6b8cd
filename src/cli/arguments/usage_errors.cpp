#include "cli/arguments/usage_errors.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace hemi::cli {

std::vector<std::string> option_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames()) {
            names.push_back("--" + name);
        }
    }
    return names;
}

void refuse_no_command(const CLI::App& app) {
    std::string message = "a command is missing (see `hemi --help`):";
    for (const CLI::App* command : app.get_subcommands({})) {
        message += fmt::format("\n  {:<9} {}", command->get_name(), command->get_description());
    }
    throw InvalidArgument(message);
}

void refuse_command(const CLI::App& app, const std::string& word) {
#ifndef HEMI_WITH_VIEWER
    if (word == "view") {
        throw InvalidArgument("there is no command 'view': this hemi was built without a window");
    }
#endif
    std::vector<std::string> names;
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
    std::vector<std::string> others;
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

void check_method(const RowOptions& rows, const std::vector<std::string>& given) {
    const std::map<std::string, std::vector<std::string>> methods_of{
        {"--rays", {"montecarlo"}},
        {"--resolution", {"hemicube", "hemisphere"}},
        {"--seed", {"hemicube", "montecarlo", "hemisphere"}},
        {"--preset", {"hemicube"}},
        {"--eye-points", {"hemicube"}},
        {"--shadow-rays", {"hemicube"}},
        {"--no-merge", {"hemicube"}},
        {"--jobs", {"hemicube"}},
        {"--error-target", {"hemicube"}},
    };
    const std::string method(to_word(rows.factors.method));
    for (const std::string& option : given) {
        const auto found = methods_of.find(option);
        if (found != methods_of.end() &&
            std::find(found->second.begin(), found->second.end(), method) == found->second.end()) {
            throw InvalidArgument(fmt::format("{} does not apply to --method {}; it belongs to {}", option,
                                              method, fmt::join(found->second, ", ")));
        }
    }
    if (rows.factors.shadow_rays && rows.factors.preset == Preset::plain) {
        throw InvalidArgument("--shadow-rays does not apply to --preset plain, which has no visibilities; it "
                              "belongs to fast, default, exact");
    }
}

} // namespace hemi::cli
