#pragma once

#include "cli/arguments/completion.hpp"
#include "cli/arguments/option_values.hpp"
#include "hemi/core/error.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hemi::cli {

/// Options of one command. Values are read by our own functions, so that all messages have one form.
class Options {
public:
    Options(CLI::App& app, std::string group) : app_(app), group_(std::move(group)) {}

    void flag(const std::string& name, bool& target, const std::string& help, bool value = true) {
        app_.add_flag_callback(
                name, [&target, value] { target = value; }, help)
            ->option_text(" ")
            ->group(group_);
    }

    /// Names of groups, one each time the option is given.
    void groups(const std::string& name, std::vector<std::string>& target, const std::string& help) {
        app_.add_option(name, target, help)->allow_extra_args(false)->option_text("GROUP")->group(group_);
    }

    CLI::Option* value(const std::string& name, const std::string& form, const std::string& help,
                       const std::function<void(const std::string&)>& read) {
        return app_.add_option_function<std::string>(name, read, help)->option_text(form)->group(group_);
    }

    /// One of the words of an enumeration. @param read  takes the enumerator
    template <class Enum>
    CLI::Option* choice(const std::string& name, const std::string& form, const std::string& help,
                        const std::function<void(Enum)>& read) {
        return value(name, form, help,
                     [name, read](const std::string& text) { read(parse_choice<Enum>(name, text)); })
            ->type_name(fmt::format("{}", fmt::join(words<Enum>(), "|")));
    }
    template <class Enum, class Target>
    CLI::Option* choice(const std::string& name, const std::string& form, const std::string& help,
                        Target& target) {
        return choice<Enum>(name, form, help, [&target](Enum value) { target = value; });
    }

    CLI::Option* path(const std::string& name, const std::string& form,
                      std::optional<std::filesystem::path>& target, const std::string& help) {
        return value(name, form, help,
                     [name, &target](const std::string& text) {
                         if (text.empty()) {
                             throw InvalidArgument(name + " '': a file name is missing");
                         }
                         target = text;
                     })
            ->type_name(file_type);
    }

private:
    CLI::App& app_;
    std::string group_;
};

} // namespace hemi::cli
