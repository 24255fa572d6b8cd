#include "viewer/opener.hpp"

#include <exception>
#include <utility>

namespace hemi::viewer {

Opener::Opener(decltype(ViewerSettings::open) open, std::function<void()> done)
    : open_(std::move(open)), done_(std::move(done)) {}

void Opener::open(const FilesToOpen& files, const std::filesystem::path& named) {
    if (thread_.joinable()) {
        thread_.join();
    }
    working_ = true;
    opened_.reset();
    thread_ = std::jthread([this, files, named] {
        Opened opened{named, {}, {}};
        try {
            opened.input = open_(files);
        } catch (const std::exception& error) {
            opened.problem = error.what();
        }
        {
            const std::lock_guard lock(mutex_);
            opened_ = std::move(opened);
            working_ = false;
        }
        done_();
    });
}

bool Opener::busy() const {
    const std::lock_guard lock(mutex_);
    return working_ || opened_;
}

std::optional<Opened> Opener::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(opened_, std::nullopt);
}

} // namespace hemi::viewer
