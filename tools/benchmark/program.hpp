#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hemi::bench {

/// The file that this program was started from.
[[nodiscard]] std::filesystem::path this_program();

/// Runs a program to its end, its output thrown away, and tells the wall time in seconds.
/// @throws Error if it cannot be started or fails.
double run_timed(const std::filesystem::path& program, const std::vector<std::string>& arguments);

} // namespace hemi::bench
