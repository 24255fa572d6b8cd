#include "cli/run_program.hpp"

#include "cli/arguments/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/exit_status.hpp"
#include "cli/report/text.hpp"
#include "cli/several_ranks.hpp"
#include "cli/signals.hpp"
#include "cli/terminal.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/ranks.hpp"
#include "hemi/core/row_memory.hpp"

#include <fmt/format.h>

#include <exception>
#include <new>
#include <string>
#include <variant>

namespace hemi::cli {

namespace {

Terminal terminal_for(const Arguments& arguments) {
    return std::visit(
        [](const auto& command) {
            const bool quiet = command.common.quiet || ranks().rank() > 0;
            return Terminal(quiet, command.common.verbose, command.common.colour);
        },
        arguments);
}

/// The message, with the options by which the settings that it names are spelled.
std::string with_options(const std::exception& error) {
    const auto* const ours = dynamic_cast<const Error*>(&error);
    if (ours == nullptr || ours->settings().empty()) {
        return error.what();
    }
    return fmt::format("{} (--{})", error.what(), fmt::join(ours->settings(), ", --"));
}

/// Whatever went wrong, once the user has interrupted that was the cause: for example workers that ended by
/// the same Ctrl-C. What all ranks say is said once.
ExitStatus report(const std::exception& error, const Terminal& terminal) {
    const ExitStatus status = interrupted() ? ExitStatus::interrupted : exit_status_for(error);
    const bool common = ranks().meet();
    if (common && ranks().rank() > 0) {
        return status;
    }
    const std::string rank = common ? "" : fmt::format("rank {} of {}: ", ranks().rank() + 1, ranks().size());
    if (status == ExitStatus::interrupted) {
        terminal.error(rank + "interrupted");
    } else if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
        terminal.error(rank + "out of memory; larger patches or a lower --resolution need less");
    } else {
        terminal.error(rank + with_options(error));
    }
    return status;
}

ExitStatus run_command(int argc, const char* const* argv) {
    Terminal terminal;
    try {
        auto parsed = parse_arguments(argc, argv);
        if (const auto* answer = std::get_if<Answer>(&parsed)) {
            print(answer->text);
            return ExitStatus::ok;
        }
        Arguments& arguments = std::get<Arguments>(parsed);
        prepare_for_ranks(arguments);
        terminal = terminal_for(arguments);
        return std::visit(
            [&terminal](const auto& command) {
                if constexpr (requires { command.rows.scratch; }) {
                    if (command.rows.scratch) {
                        keep_rows_in(*command.rows.scratch);
                    }
                }
                return run(command, terminal);
            },
            arguments);
    } catch (const std::exception& error) {
        return report(error, terminal);
    }
}

} // namespace

int run_program(int argc, const char* const* argv) {
    install_signal_handlers();
    return static_cast<int>(run_command(argc, argv));
}

} // namespace hemi::cli
