#include "cli/terminal.hpp"

#include "hemi/core/text.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <unistd.h>

namespace hemi::cli {

namespace {

bool is_set(const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr && *value != '\0';
}

bool is_dumb_terminal() {
    const char* value = std::getenv("TERM");
    return value != nullptr && std::string_view(value) == "dumb";
}

bool wants_colours(ColourChoice choice, bool is_terminal) {
    if (choice != ColourChoice::automatic) {
        return choice == ColourChoice::always;
    }
    if (is_set("NO_COLOR") || is_dumb_terminal()) {
        return false;
    }
    if (is_set("CLICOLOR_FORCE") && std::string_view(std::getenv("CLICOLOR_FORCE")) != "0") {
        return true;
    }
    return is_terminal;
}

} // namespace

Terminal::Terminal(bool quiet, bool verbose, ColourChoice colour)
    : quiet_(quiet), verbose_(verbose && !quiet) {
    const bool is_terminal = isatty(STDERR_FILENO) == 1;
    colours_ = wants_colours(colour, is_terminal);
    can_redraw_ = is_terminal && !is_dumb_terminal() && !quiet;
}

void Terminal::write(std::string_view label, std::string_view colour, std::string_view message) const {
    std::string text = "hemi: ";
    if (!label.empty()) {
        text += colours_ ? fmt::format("\x1b[{}m{}\x1b[0m: ", colour, label) : fmt::format("{}: ", label);
    }
    text += printable(message, true);
    text += '\n';
    std::fwrite(text.data(), 1, text.size(), stderr);
}

void Terminal::error(std::string_view message) const {
    write("error", "1;31", message);
}

void Terminal::warn(std::string_view message) const {
    if (!quiet_) {
        write("warning", "1;33", message);
    }
}

void Terminal::warn(const Diagnostics& diagnostics) const {
    for (const std::string& warning : diagnostics.warnings()) {
        warn(warning);
    }
    for (const std::string& told : diagnostics.notes()) {
        note(told);
    }
}

void Terminal::note(std::string_view message) const {
    if (!quiet_) {
        write("", "", message);
    }
}

void Terminal::detail(std::string_view message) const {
    if (verbose_) {
        write("", "", message);
    }
}

} // namespace hemi::cli
