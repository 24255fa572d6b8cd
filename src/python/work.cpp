#include "python/work.hpp"

#include "hemi/core/interrupt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

namespace hemi::python {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto between_interrupt_checks = std::chrono::milliseconds(100);
constexpr auto between_progress_calls = std::chrono::milliseconds(50);

std::mutex one_at_a_time;
thread_local bool at_work = false;
thread_local std::exception_ptr kept;
thread_local Clock::time_point next_check;

/// Calls Python from within the work. An exception is kept.
/// @return false if there was one
template <class Function>
bool call_python(Function function) {
    const py::gil_scoped_acquire acquire;
    try {
        function();
        return true;
    } catch (...) {
        Work::keep_exception(std::current_exception());
        return false;
    }
}

bool check_signals() {
    return call_python([] {
        if (PyErr_CheckSignals() != 0) {
            throw py::error_already_set();
        }
    });
}

} // namespace

Work::Work() : lock_(one_at_a_time, std::defer_lock) {
    if (at_work) {
        throw Error("hemi was called by a callback of its own work; let that return first");
    }
    lock_.lock(); // without the GIL, which the work that is waited for needs now and then
    at_work = true;
    kept = nullptr;
}

Work::~Work() {
    at_work = false;
}

void Work::keep_exception(std::exception_ptr exception) noexcept {
    if (!kept) {
        kept = std::move(exception);
    }
}

std::exception_ptr Work::take_exception() noexcept {
    return std::exchange(kept, nullptr);
}

bool Work::interrupted() {
    if (!at_work) {
        return false;
    }
    if (kept) {
        return true;
    }
    const Clock::time_point now = Clock::now();
    if (now < next_check) {
        return false;
    }
    next_check = now + between_interrupt_checks;
    return !check_signals();
}

void warn(std::string_view message) {
    const py::object category = py::module_::import("hemi").attr("HemiWarning");
    if (PyErr_WarnEx(category.ptr(), std::string(message).c_str(), 1) != 0) {
        throw py::error_already_set();
    }
}

void warn(const Diagnostics& diagnostics) {
    for (const std::string& message : diagnostics.warnings()) {
        warn(message);
    }
}

PythonObserver::PythonObserver(const py::object& progress) : call_(progress) {
    if (progress.is(py::bool_(true))) {
        call_ = py::module_::import("hemi._progress").attr("Bar")();
    } else if (progress.is_none() || progress.is(py::bool_(false))) {
        call_ = py::none();
    } else if (PyCallable_Check(progress.ptr()) == 0) {
        throw py::type_error("progress: must be None, True or a function of (phase, done, total)");
    }
}

bool PythonObserver::progress(Phase phase, std::size_t done, std::size_t total) {
    const Clock::time_point now = Clock::now();
    if (phase_ == phase && done < total && now < next_) {
        return true;
    }
    phase_ = phase;
    next_ = now + between_progress_calls;
    bool go_on = check_signals();
    if (go_on && !call_.is_none()) {
        go_on = call_python([&] {
            if (call_(std::string(to_word(phase)), done, total).is(py::bool_(false))) {
                throw Cancelled();
            }
        });
    }
    return go_on;
}

void PythonObserver::warning(std::string_view message, std::string_view setting) {
    std::string text(message);
    if (!setting.empty()) {
        std::string name(setting);
        std::replace(name.begin(), name.end(), '-', '_');
        text += fmt::format(" (see {})", name);
    }
    if (!call_python([&] { warn(text); })) {
        throw Cancelled();
    }
}

void PythonObserver::note(std::string_view message) {
    log("info", message);
}

void PythonObserver::detail(std::string_view message) {
    log("debug", message);
}

void PythonObserver::log(const char* level, std::string_view message) {
    const bool logged = call_python([&] {
        const py::object logger = py::module_::import("logging").attr("getLogger")("hemi");
        logger.attr(level)("%s", std::string(message));
    });
    if (!logged) {
        throw Cancelled();
    }
}

void install_interrupt_check() {
    set_interrupt_check(Work::interrupted);
}

} // namespace hemi::python
