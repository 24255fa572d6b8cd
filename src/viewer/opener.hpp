#pragma once

#include "viewer/viewer.hpp"

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace hemi::viewer {

/// A file that was read, or why it could not be.
struct Opened {
    std::filesystem::path file;
    std::optional<ViewerInput> input;
    std::string problem;
};

/// Reads files beside the window, on a thread of its own, one after the other.
class Opener {
public:
    /// @param open  @see ViewerSettings::open; @param done  called on the other thread when take() has
    /// something
    Opener(decltype(ViewerSettings::open) open, std::function<void()> done);

    /// Waits for the file before, where one is under way.
    /// @param named  of the files, the one that is told of
    void open(const FilesToOpen& files, const std::filesystem::path& named);
    [[nodiscard]] bool busy() const;
    [[nodiscard]] std::optional<Opened> take();

private:
    decltype(ViewerSettings::open) open_;
    std::function<void()> done_;
    mutable std::mutex mutex_;
    bool working_ = false;
    std::optional<Opened> opened_;
    std::jthread thread_; ///< last: it uses all of the above
};

} // namespace hemi::viewer
