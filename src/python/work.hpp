#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/core/error.hpp"
#include "hemi/pipeline/observer.hpp"

#include <pybind11/pybind11.h>

#include <chrono>
#include <cstddef>
#include <exception>
#include <mutex>
#include <optional>
#include <string_view>
#include <type_traits>

namespace hemi::python {

namespace py = pybind11;

/// Long work of the library on this thread: the GIL is released while it is there, and other threads wait
/// for their turn, since the OpenGL functions are the process's and the library uses all cores anyway.
/// @see run()
class Work {
public:
    /// @throws Error if this thread is at work already: a callback calls hemi
    Work();
    ~Work();
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

    /// Keeps the Python exception that is on its way, to be raised when the library has stopped. With the
    /// GIL.
    static void keep_exception(std::exception_ptr exception) noexcept;
    /// What was kept, once.
    [[nodiscard]] static std::exception_ptr take_exception() noexcept;
    /// Looks for Ctrl-C, ten times a second at most. True: stop, an exception was kept.
    [[nodiscard]] static bool interrupted();

private:
    py::gil_scoped_release release_;
    std::unique_lock<std::mutex> lock_;
};

/// Does long work without the GIL. An exception of a callback or of Ctrl-C is raised as it was.
template <class Function>
auto run(Function work) {
    if constexpr (std::is_void_v<std::invoke_result_t<Function>>) {
        run([&work] {
            work();
            return true;
        });
    } else {
        try {
            std::optional<Work> working(std::in_place);
            auto result = work();
            working.reset();
            if (const std::exception_ptr kept = Work::take_exception()) {
                std::rethrow_exception(kept);
            }
            return result;
        } catch (const Error&) {
            if (const std::exception_ptr kept = Work::take_exception()) {
                std::rethrow_exception(kept);
            }
            throw;
        }
    }
}

/// Shows the library's warnings as Python's, by warnings.warn(). With the GIL.
void warn(std::string_view message);
/// All of them.
void warn(const Diagnostics& diagnostics);

/// Calls progress(phase, done, total) of Python, twenty times a second at most and at the end of every phase;
/// warnings become Python's, notes and details go to the logger "hemi".
class PythonObserver : public Observer {
public:
    /// @param progress  None, True (tqdm) or something to call, which stops the work by returning False
    explicit PythonObserver(const py::object& progress);

    bool progress(Phase phase, std::size_t done, std::size_t total) override;
    void warning(std::string_view message, std::string_view setting) override;
    void note(std::string_view message) override;
    void detail(std::string_view message) override;

private:
    void log(const char* level, std::string_view message);

    py::object call_; ///< or None
    std::optional<Phase> phase_;
    std::chrono::steady_clock::time_point next_;
};

/// Makes long work without an observer look for Ctrl-C, too.
void install_interrupt_check();

} // namespace hemi::python
