#include "cli/exit_status.hpp"

#include "hemi/pipeline/accuracy.hpp"

#include "hemi/core/error.hpp"

namespace hemi::cli {

ExitStatus exit_status_for(const std::exception& error) noexcept {
    if (dynamic_cast<const InvalidArgument*>(&error) != nullptr) {
        return ExitStatus::usage;
    }
    if (dynamic_cast<const InputError*>(&error) != nullptr) {
        return ExitStatus::bad_input;
    }
    if (dynamic_cast<const NoDevice*>(&error) != nullptr) {
        return ExitStatus::no_device;
    }
    if (dynamic_cast<const TargetMissed*>(&error) != nullptr) {
        return ExitStatus::out_of_tolerance;
    }
    if (dynamic_cast<const Cancelled*>(&error) != nullptr) {
        return ExitStatus::interrupted;
    }
    return ExitStatus::failure;
}

} // namespace hemi::cli
