#pragma once

#include "viewer/viewer.hpp"
#include "viewer/work_progress.hpp"

#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace hemi::viewer {

/// Solves a scene on patches that are cut where it tells (solve_refined), on a thread of its own. Every mesh
/// on the way is to be had with its light.
class MeshRefiner {
public:
    /// @param coarse   with a goal; what is found are inputs like it
    /// @param changed  called on the other thread when something new is to be had
    MeshRefiner(const ViewerInput& coarse, std::function<void()> changed);
    /// Stops what is under way, and waits until it has.
    ~MeshRefiner();
    MeshRefiner(const MeshRefiner&) = delete;
    MeshRefiner& operator=(const MeshRefiner&) = delete;

    /// What is being done, and how fast.
    /// @param share  becomes the part of it that is done
    [[nodiscard]] std::string status(double& share) const;
    void cancel();
    /// Whether no more meshes will come than what take() still has.
    [[nodiscard]] bool finished() const;
    /// Whether take() has something, or will have.
    [[nodiscard]] bool busy() const;

    /// The newest mesh with its light, once. The last one has form factors and no goal any more.
    /// @throws what ended the work, but Cancelled
    [[nodiscard]] std::optional<ViewerInput> take();

private:
    class Listener;

    void work(const std::stop_token& stop);
    void publish(ViewerInput input);

    const ViewerInput coarse_;
    std::function<void()> changed_;
    WorkProgress progress_;
    mutable std::mutex mutex_;
    std::optional<ViewerInput> newest_;
    std::exception_ptr problem_;
    bool finished_ = false;
    std::jthread thread_; ///< last: it uses all of the above
};

} // namespace hemi::viewer
