#include "hemi/core/interrupt.hpp"

#include "hemi/core/error.hpp"

#include <atomic>

namespace hemi {

namespace {
std::atomic<InterruptCheck> installed{nullptr};
}

void set_interrupt_check(InterruptCheck check) noexcept {
    installed.store(check);
}

void stop_if_interrupted() {
    if (const InterruptCheck check = installed.load(); check != nullptr && check()) {
        throw Cancelled();
    }
}

} // namespace hemi
