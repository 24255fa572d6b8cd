#pragma once

#include "hemi/core/error.hpp"

#include <exception>

namespace hemi::cli {

/// What the program tells the shell.
enum class ExitStatus : int {
    ok = 0,
    failure = 1,
    usage = 2,
    bad_input = 3,
    no_device = 4,
    out_of_tolerance = 5,
    interrupted = 130,
};

/// Exit status for an exception that reached main().
[[nodiscard]] ExitStatus exit_status_for(const std::exception& error) noexcept;

} // namespace hemi::cli
