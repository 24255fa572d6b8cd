#include "cli/arguments/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/exit_status.hpp"
#include "cli/report/text.hpp"
#include "cli/signals.hpp"
#include "cli/terminal.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <exception>
#include <new>
#include <variant>

namespace {

using namespace hemi::cli;

Terminal terminal_for(const Arguments& arguments) {
    return std::visit(
        [](const auto& command) {
            return Terminal(command.common.quiet, command.common.verbose, command.common.colour);
        },
        arguments);
}

/// The message, with the options by which the settings that it names are spelled.
std::string with_options(const std::exception& error) {
    const auto* const ours = dynamic_cast<const hemi::Error*>(&error);
    if (ours == nullptr || ours->settings().empty()) {
        return error.what();
    }
    return fmt::format("{} (--{})", error.what(), fmt::join(ours->settings(), ", --"));
}

/// Whatever went wrong, once the user has interrupted that was the cause: for example workers that ended by
/// the same Ctrl-C.
ExitStatus report(const std::exception& error, const Terminal& terminal) {
    const ExitStatus status = interrupted() ? ExitStatus::interrupted : exit_status_for(error);
    if (status == ExitStatus::interrupted) {
        terminal.error("interrupted");
    } else if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
        terminal.error("out of memory; larger patches or a lower --resolution need less");
    } else {
        terminal.error(with_options(error));
    }
    return status;
}

ExitStatus run_program(int argc, const char* const* argv) {
    Terminal terminal;
    try {
        const auto parsed = parse_arguments(argc, argv);
        if (const auto* answer = std::get_if<Answer>(&parsed)) {
            print(answer->text);
            return ExitStatus::ok;
        }
        const Arguments& arguments = std::get<Arguments>(parsed);
        terminal = terminal_for(arguments);
        return std::visit([&terminal](const auto& command) { return run(command, terminal); }, arguments);
    } catch (const std::exception& error) {
        return report(error, terminal);
    }
}

} // namespace

int main(int argc, char** argv) {
    install_signal_handlers();
    return static_cast<int>(run_program(argc, argv));
}
