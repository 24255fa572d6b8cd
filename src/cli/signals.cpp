#include "cli/signals.hpp"

#include "cli/exit_status.hpp"
#include "hemi/core/interrupt.hpp"

#include <atomic>
#include <csignal>
#include <unistd.h>

namespace hemi::cli {

namespace {

std::atomic<int> arrived{0};
static_assert(std::atomic<int>::is_always_lock_free, "used in a signal handler");

extern "C" {
static void on_signal(int) {
    if (arrived.fetch_add(1) > 0) {
        _exit(static_cast<int>(ExitStatus::interrupted));
    }
}
}

} // namespace

void install_signal_handlers() {
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    set_interrupt_check(interrupted);
}

bool interrupted() noexcept {
    return arrived.load() > 0;
}

} // namespace hemi::cli
