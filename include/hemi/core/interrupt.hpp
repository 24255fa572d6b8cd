#pragma once

namespace hemi {

/// Asked now and then by long work that has no progress callback (writing and reading files, drawing): true
/// stops it. Must be quick; called from the thread that works.
using InterruptCheck = bool (*)();

/// Installs the check for the whole process; null (the default) never stops anything.
void set_interrupt_check(InterruptCheck check) noexcept;

/// Asks the installed check.
/// @throws Cancelled if the installed check says so. What was being written is then taken back.
void stop_if_interrupted();

} // namespace hemi
