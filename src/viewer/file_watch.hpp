#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <thread>

namespace hemi::viewer {

/// Notices when a file was written or replaced, on a thread that sleeps meanwhile. A file system that does
/// not tell of changes goes unnoticed.
class FileWatch {
public:
    /// @param changed  called on the other thread
    FileWatch(const std::filesystem::path& file, std::function<void()> changed);
    ~FileWatch();
    FileWatch(const FileWatch&) = delete;
    FileWatch& operator=(const FileWatch&) = delete;

    /// Whether it changed since the last call.
    [[nodiscard]] bool take() { return noticed_.exchange(false); }

private:
    void watch();

    std::string name_;
    std::function<void()> changed_;
    std::atomic<bool> noticed_{false};
    int notices_ = -1; ///< of inotify
    int stop_ = -1;    ///< becomes readable at the end
    std::thread thread_;
};

} // namespace hemi::viewer
