#include "viewer/file_watch.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>
#include <utility>

namespace hemi::viewer {

FileWatch::FileWatch(const std::filesystem::path& file, std::function<void()> changed)
    : name_(file.filename().string()), changed_(std::move(changed)),
      notices_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)), stop_(eventfd(0, EFD_CLOEXEC)) {
    // The folder, since editors write a new file and rename it.
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (notices_ >= 0 && stop_ >= 0 &&
        inotify_add_watch(notices_, folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO) >= 0) {
        thread_ = std::thread([this] { watch(); });
    }
}

FileWatch::~FileWatch() {
    if (thread_.joinable()) {
        const std::uint64_t one = 1;
        (void)!write(stop_, &one, sizeof one);
        thread_.join();
    }
    for (const int descriptor : {notices_, stop_}) {
        if (descriptor >= 0) {
            close(descriptor);
        }
    }
}

void FileWatch::watch() {
    alignas(inotify_event) std::array<char, 8192> buffer{};
    std::array<pollfd, 2> waiting{{{notices_, POLLIN, 0}, {stop_, POLLIN, 0}}};
    while (poll(waiting.data(), waiting.size(), -1) >= 0 || errno == EINTR) {
        if ((waiting[1].revents & POLLIN) != 0) {
            return;
        }
        bool noticed = false;
        const ssize_t length = read(notices_, buffer.data(), buffer.size());
        for (ssize_t at = 0; at < length;) {
            inotify_event event{};
            std::memcpy(&event, buffer.data() + at, sizeof event);
            const char* name = buffer.data() + at + sizeof event;
            noticed = noticed || (event.len > 0 && name_ == name);
            at += static_cast<ssize_t>(sizeof event + event.len);
        }
        if (noticed) {
            noticed_ = true;
            changed_();
        }
    }
}

} // namespace hemi::viewer
