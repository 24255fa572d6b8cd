#include "cli/arguments/completion.hpp"

#include "cli/arguments/usage_errors.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <vector>

namespace hemi::cli {

namespace {

using Words = std::vector<std::string>;

/// Goes before and after what is known of the commands. bash makes words of their own of = and :, so that
/// `--device=egl` is three.
constexpr const char* head =
    R"(# bash completion of hemi, made by `hemi completion bash`

_hemi_files() {
    local file extension
    compopt -o filenames 2>/dev/null
    while IFS= read -r file; do
        if [[ $# -eq 0 || -d ${file/#\~\//$HOME/} ]]; then
            COMPREPLY+=("$file")
            continue
        fi
        for extension; do
            [[ ${file,,} != *"$extension" ]] || COMPREPLY+=("$file")
        done
    done < <(compgen -f -- "$word")
}

_hemi() {
    local word=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD - 1]}
    local options='' with_value='' values='' arguments=() given=0 i
    COMPREPLY=()
    if [[ $word == = ]]; then
        word=''
    elif [[ $option == = ]]; then
        option=${COMP_WORDS[COMP_CWORD - 2]}
    fi
    if ((COMP_CWORD == 1)); then
)";
constexpr const char* tail =
    R"(    esac
    for ((i = 2; i < COMP_CWORD; ++i)); do
        case ${COMP_WORDS[i]} in
        =) ((++i)) ;;
        -*) [[ $with_value != *" ${COMP_WORDS[i]} "* || ${COMP_WORDS[i + 1]} == = ]] || ((++i)) ;;
        *) ((++given)) ;;
        esac
    done
    if [[ $with_value == *" $option "* ]]; then
        [[ ! $values ]] || COMPREPLY=($(compgen -W "$values" -- "$word"))
    elif [[ $word == -* ]] || ((given >= ${#arguments[@]})); then
        COMPREPLY=($(compgen -W "$options" -- "$word"))
    else
        _hemi_files ${arguments[given]}
    fi
}

complete -F _hemi hemi
)";

/// Extensions such as ".json" in a text, each once.
Words extensions_in(const std::string& text) {
    const auto is_letter = [](char c) { return std::islower(static_cast<unsigned char>(c)) != 0; };
    const auto continues = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
    Words found;
    for (auto dot = std::find(text.begin(), text.end(), '.'); dot != text.end();
         dot = std::find(dot + 1, text.end(), '.')) {
        if (dot + 1 != text.end() && is_letter(dot[1])) {
            const std::string extension(dot, std::find_if_not(dot + 1, text.end(), continues));
            if (std::find(found.begin(), found.end(), extension) == found.end()) {
                found.push_back(extension);
            }
        }
    }
    return found;
}

Words extensions_of(const CLI::Option& option) {
    return extensions_in(option.get_option_text() + " " + option.get_description());
}

/// The part of the script that knows one command.
std::string part_of(const CLI::App& command) {
    Words with_value;
    std::string arguments;
    std::string values;
    for (const CLI::Option* option : command.get_options()) {
        const std::string type = option->get_type_name();
        if (option->get_positional()) {
            arguments +=
                fmt::format("{}'{}'", arguments.empty() ? "" : " ", fmt::join(extensions_of(*option), " "));
            continue;
        }
        if (option->get_expected_max() == 0) {
            continue;
        }
        Words names;
        for (const std::string& name : option->get_snames()) {
            names.push_back("-" + name);
        }
        for (const std::string& name : option->get_lnames()) {
            names.push_back("--" + name);
        }
        with_value.insert(with_value.end(), names.begin(), names.end());
        if (type == file_type) {
            values +=
                fmt::format("        {})\n            _hemi_files {}\n            return\n            ;;\n",
                            fmt::join(names, " | "), fmt::join(extensions_of(*option), " "));
        } else if (type.find('|') != std::string::npos) {
            std::string choices = type;
            std::replace(choices.begin(), choices.end(), '|', ' ');
            values += fmt::format("        {}) values='{}' ;;\n", fmt::join(names, " | "), choices);
        }
    }
    std::string part = fmt::format("    {})\n"
                                   "        options='{}'\n"
                                   "        with_value=' {} '\n"
                                   "        arguments=({})\n",
                                   command.get_name(), fmt::join(option_names(command), " "),
                                   fmt::join(with_value, " "), arguments);
    if (!values.empty()) {
        part += "        case $option in\n" + values + "        esac\n";
    }
    return part + "        ;;\n";
}

} // namespace

std::string bash_completion(const CLI::App& app) {
    Words names;
    std::string parts;
    for (const CLI::App* command : app.get_subcommands({})) {
        names.push_back(command->get_name());
        parts += part_of(*command);
    }
    return head +
           fmt::format("        COMPREPLY=($(compgen -W '{0} help {1}' -- \"$word\"))\n"
                       "        return\n"
                       "    fi\n"
                       "    case ${{COMP_WORDS[1]}} in\n"
                       "{2}"
                       "    help)\n"
                       "        ((COMP_CWORD != 2)) || COMPREPLY=($(compgen -W '{0}' -- \"$word\"))\n"
                       "        return\n"
                       "        ;;\n"
                       "    *) return ;;\n",
                       fmt::join(names, " "), fmt::join(option_names(app), " "), parts) +
           tail;
}

} // namespace hemi::cli
