#pragma once

namespace hemi::cli {

/// All that the program does.
/// @return its exit status
[[nodiscard]] int run_program(int argc, const char* const* argv);

} // namespace hemi::cli
