#pragma once

#include "viewer/factor_cache.hpp"
#include "viewer/viewer.hpp"
#include "viewer/work_progress.hpp"

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

/// Light of some patches, each by its own row. Provisional: the solution is found when all rows are there.
struct GatheredLight {
    std::vector<std::uint32_t> patches;
    std::vector<double> radiosity; ///< one value a channel for each of them
    std::vector<double> blocked;   ///< b_i of each
};

/// Computes the form factors of a scene on a thread of its own: first a coarse preview of the light, then the
/// rows, each of which gives its own patch the light that is shown meanwhile.
class RowFinder {
public:
    /// @param input    scene, mesh and settings are read
    /// @param cache    asked first, and given what is found
    /// @param changed  called on the other thread when something new is to be had
    RowFinder(const ViewerInput& input, std::shared_ptr<FactorCache> cache, std::function<void()> changed);
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
    /// The result, prepared, once; afterwards, and where there is none, null.
    /// @throws what the search threw, but Cancelled
    [[nodiscard]] std::shared_ptr<const FormFactors> take();
    [[nodiscard]] bool finished() const;

private:
    class Listener;

    void work(const std::stop_token& stop);

    [[nodiscard]] std::shared_ptr<const FormFactors> find(Listener& listener);

    std::shared_ptr<const Scene> scene_;
    std::shared_ptr<const PatchMesh> mesh_;
    FactorSettings settings_;
    SolverSettings solver_;
    std::shared_ptr<Observer> observer_;
    std::shared_ptr<FactorCache> cache_;
    std::function<void()> changed_;
    WorkProgress progress_;
    mutable std::mutex mutex_;
    std::optional<std::vector<double>> preview_;
    GatheredLight gathered_;
    std::shared_ptr<const FormFactors> result_;
    std::exception_ptr problem_;
    bool finished_ = false;
    std::jthread thread_; ///< last: it uses all of the above
};

} // namespace hemi::viewer
