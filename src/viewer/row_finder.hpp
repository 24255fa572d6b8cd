#pragma once

#include "viewer/viewer.hpp"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace hemi::viewer {

/// Light of some patches, each by its own row: RowListener::gathered.
struct GatheredLight {
    std::vector<std::uint32_t> patches;
    std::vector<double> radiosity; ///< one value a channel for each of them
    std::vector<double> blocked;   ///< b_i of each
};

/// Runs ViewerInput::find_rows on a thread of its own, and tells how far it is.
class RowFinder {
public:
    /// @param changed  called on the other thread when something new is to be had
    RowFinder(std::function<FoundRows(const RowListener&)> find, std::function<void()> changed);
    /// Stops what is under way, and waits until it has.
    ~RowFinder();
    RowFinder(const RowFinder&) = delete;
    RowFinder& operator=(const RowFinder&) = delete;

    /// What is being done, and how fast.
    /// @param share  becomes the part of it that is done
    [[nodiscard]] std::string status(double& share) const;
    void cancel();

    /// What the light will be about, once it is known; once.
    [[nodiscard]] std::optional<std::vector<double>> take_preview();
    /// What was gathered since the last call.
    [[nodiscard]] GatheredLight take_gathered();
    /// The result, once; afterwards, and where there is none, nothing.
    /// @throws what the search threw, but Cancelled
    [[nodiscard]] std::optional<FoundRows> take();
    [[nodiscard]] bool finished() const;

private:
    struct Progress {
        std::string title;
        std::string unit;
        std::size_t done = 0;
        std::size_t total = 0;
        double seconds = 0.0; ///< since this title began
    };

    void work(const std::stop_token& stop);

    std::function<FoundRows(const RowListener&)> find_;
    std::function<void()> changed_;
    mutable std::mutex mutex_;
    Progress progress_;
    std::optional<std::vector<double>> preview_;
    GatheredLight gathered_;
    std::optional<FoundRows> result_;
    std::exception_ptr problem_;
    bool finished_ = false;
    std::jthread thread_; ///< last: it uses all of the above
};

} // namespace hemi::viewer
