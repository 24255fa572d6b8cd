#pragma once

namespace hemi::cli {

/// From now on the first SIGINT or SIGTERM only sets a flag, so that the work can stop cleanly; the second
/// ends the process at once with status 130.
void install_signal_handlers();

/// Whether SIGINT or SIGTERM has arrived.
[[nodiscard]] bool interrupted() noexcept;

/// @throws Cancelled if interrupted().
void stop_if_interrupted();

} // namespace hemi::cli
