#pragma once

namespace hemi::cli {

/// From now on the first SIGINT or SIGTERM only sets a flag, which hemi::stop_if_interrupted() heeds, so that
/// the work can stop cleanly; the second ends the process at once with status 130.
void install_signal_handlers();

/// Whether SIGINT or SIGTERM has arrived.
[[nodiscard]] bool interrupted() noexcept;

} // namespace hemi::cli
